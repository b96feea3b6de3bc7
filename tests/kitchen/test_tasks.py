"""The judges, on states set by hand, and what is drawn."""

from pathlib import Path

import numpy as np
import pytest
from numpy.random import default_rng

from symskill_pddl.demonstrator.poses import facing, hand_pose
from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import TASKS, layout, make
from symskill_pddl.kitchen.judges import COUNTER_REGION, covers, in_rack, inside
from symskill_pddl.panda import reach
from symskill_pddl.scene import Command

SEEDS = range(30)


KITCHEN_TASKS = [name for name, spec in TASKS.items() if spec.scene is layout.KITCHEN]
PLAY_TASKS = [name for name, spec in TASKS.items() if spec.scene is layout.PLAY]


@pytest.mark.parametrize("task", TASKS)
def test_things_stand_apart_and_within_their_regions(task):
    scene = TASKS[task].scene
    for seed in SEEDS:
        episode = TASKS[task].draw(default_rng(seed))
        assert list(episode.loose) == list(scene.loose)
        poses = {name: episode.T_world(scene, name) for name in scene.of_type("food", "thing")}
        points = np.array([T.p for T in poses.values()])
        gaps = np.linalg.norm(points[:, None] - points[None], axis=-1)[np.triu_indices(len(points), 1)]
        assert gaps.min() > 0.085
        for name, T in poses.items():
            assert episode.loose[name].on != "counter" or COUNTER_REGION.contains(T.p)


def test_the_focus_food_varies_and_starts_where_the_task_says():
    for task, start in [("PnPCabToCounter", "cabinet"), ("PnPStoveToCounter", "pan"), ("PnPCounterToStove", "plate")]:
        drawn = [TASKS[task].draw(default_rng(seed)) for seed in SEEDS]
        assert {episode.focus[0] for episode in drawn} == set(layout.KITCHEN.of_type("food"))
        assert all(episode.loose[episode.focus[0]].on == start for episode in drawn)
    assert all(TASKS["PnPCounterToCab"].draw(default_rng(s)).loose["cheese"].on == "counter" for s in SEEDS)


@pytest.mark.parametrize("task", PLAY_TASKS)
def test_things_of_play_are_in_different_dishes(task):
    starts = set()
    for seed in SEEDS:
        loose = TASKS[task].draw(default_rng(seed)).loose
        dishes = [loose[name].on for name in layout.PLAY.of_type("thing")]
        assert len(set(dishes)) == 2
        assert set(dishes) <= {"pan", "red-plate", "white-plate"}
        starts.add((loose["lid"].on, *dishes))
    # free play begins anywhere, a goal always with the same arrangement
    assert (len(starts) > 8) == (task == "Play")


def test_goals_of_composite_tasks_are_atomic_tasks():
    assert [task for task, _ in TASKS["StoreCheese"].goal_of] == ["PnPCabToCounter", "CloseSingleDoor"]
    for spec in TASKS.values():
        assert spec.composite == (spec.kind in ("composed", "play goal"))
        for task, focus in spec.goal_of:
            assert TASKS[task].kind == "atomic"
            assert set(focus) <= set(spec.scene.types)
        for thing, place in spec.goal_at:
            assert {thing, place} <= set(spec.scene.types)


# --- judges


def put(kitchen, food, p):
    kitchen.physics.set_loose(food, Pose(np.asarray(p, dtype=float), np.array([1.0, 0.0, 0.0, 0.0])))
    kitchen.physics.forward()


def move(kitchen, part, position):
    kitchen.physics.set_part(part, position)
    kitchen.physics.forward()


def turn(kitchen, degrees):
    move(kitchen, "door", np.radians(degrees))


@pytest.mark.simulation
@pytest.mark.parametrize(("task", "angle", "success"), [
    ("OpenSingleDoor", 100, True), ("OpenSingleDoor", 76, True), ("OpenSingleDoor", 70, False), ("OpenSingleDoor", 0, False),
    ("CloseSingleDoor", 0, True), ("CloseSingleDoor", 2, True), ("CloseSingleDoor", 5, False), ("CloseSingleDoor", 90, False),
])  # fmt: skip
def test_door_judges(task, angle, success):
    kitchen = make(task, 0)
    turn(kitchen, angle)
    assert kitchen.succeeded() is success


@pytest.mark.simulation
@pytest.mark.parametrize(("task", "part", "position", "success"), [
    ("OpenDrawer", "drawer", 0.18, True), ("OpenDrawer", "drawer", 0.121, True), ("OpenDrawer", "drawer", 0.10, False),
    ("CloseDrawer", "drawer", 0.0, True), ("CloseDrawer", "drawer", 0.009, True), ("CloseDrawer", "drawer", 0.03, False),
    ("TurnOnStove", "knob", 1.7, True), ("TurnOnStove", "knob", 1.0, False), ("TurnOnStove", "knob", 0.0, False),
    ("TurnOffStove", "knob", 0.1, True), ("TurnOffStove", "knob", 0.4, False), ("TurnOffStove", "knob", 1.7, False),
    ("TurnOnSinkFaucet", "lever", 1.0, True), ("TurnOnSinkFaucet", "lever", 0.7, False),
    ("TurnOffSinkFaucet", "lever", 0.1, True), ("TurnOffSinkFaucet", "lever", 0.3, False),
])  # fmt: skip
def test_judges_of_parts(task, part, position, success):
    kitchen = make(task, 0)
    assert kitchen.focus == (part, layout.PARTS[part].unit)
    move(kitchen, part, position)
    assert kitchen.succeeded() is success


def test_parts_that_a_task_is_not_about_are_shut():
    for name, spec in TASKS.items():
        for seed in SEEDS:
            episode = spec.draw(default_rng(seed))
            assert set(episode.positions) == set(spec.scene.parts)
            assert set(episode.shifts) == set(spec.scene.units)
            others = [p for p in spec.scene.parts if p != "door" and p not in episode.focus]
            assert all(episode.positions[p] == 0.0 for p in others), name


@pytest.mark.simulation
def test_a_hand_on_the_bar_of_a_shut_drawer_is_no_success():
    kitchen = make("CloseDrawer", 0)
    move(kitchen, "drawer", 0.0)
    bar = kitchen.physics.T_world("drawer").apply(layout.PARTS["drawer"].grip)
    kitchen.physics.set_arm(reach.solve(kitchen.physics, Pose(bar, facing(0.0, np.radians(60), -np.pi / 2))))
    kitchen.physics.forward()
    assert not kitchen.succeeded()


@pytest.mark.simulation
def test_a_hand_on_the_handle_is_no_success():
    kitchen = make("CloseSingleDoor", 0)
    turn(kitchen, 0)
    handle = kitchen.physics.T_world("door").apply(layout.HANDLE)
    kitchen.physics.set_arm(reach.solve(kitchen.physics, hand_pose(handle, np.radians(15), np.radians(20))))
    kitchen.physics.forward()
    assert not kitchen.succeeded()


@pytest.mark.simulation
@pytest.mark.parametrize(("p", "success"), [
    ((0.45, 0.30, 0.025), True), ((0.45, 0.30, 0.20), False), ((0.90, 0.30, 0.025), False), ((0.45, 0.70, 0.025), False),
])  # fmt: skip
def test_counter_judge(p, success):
    kitchen = make("PnPCabToCounter", 0)
    put(kitchen, kitchen.focus[0], p)
    assert kitchen.succeeded() is success


@pytest.mark.simulation
@pytest.mark.parametrize(("offset", "success"), [
    ((-0.05, 0.0, -0.21), True), ((-0.05, 0.10, -0.21), True), ((-0.05, 0.0, 0.0), False), ((-0.20, 0.0, -0.21), False),
    ((-0.05, 0.25, -0.21), False),
])  # fmt: skip
def test_cabinet_judge(offset, success):
    kitchen = make("PnPCounterToCab", 0)
    put(kitchen, kitchen.focus[0], kitchen.physics.T_world("cabinet").apply(offset))
    assert kitchen.succeeded() is success


@pytest.mark.simulation
def test_a_food_in_motion_or_in_the_hand_is_no_success():
    kitchen = make("PnPCabToCounter", 0)
    food = kitchen.focus[0]
    put(kitchen, food, (0.45, 0.30, 0.025))
    assert kitchen.succeeded()
    kitchen.physics.data.joint(f"{food}_joint0").qvel[0] = 0.1
    assert not kitchen.succeeded()
    put(kitchen, food, (0.45, 0.30, 0.025))
    kitchen.physics.set_arm(reach.solve(kitchen.physics, hand_pose((0.45, 0.30, 0.04), 0.0, np.radians(50))))
    kitchen.physics.forward()
    assert not kitchen.succeeded()


@pytest.mark.simulation
def test_store_cheese_needs_the_cheese_out_and_the_door_shut():
    kitchen = make("StoreCheese", 0)
    turn(kitchen, 90)
    put(kitchen, "cheese", (0.45, 0.30, 0.02))
    assert not kitchen.succeeded()
    turn(kitchen, 0)
    assert kitchen.succeeded()
    put(kitchen, "cheese", kitchen.physics.T_world("cabinet").apply((-0.05, 0.0, -0.16)))
    assert not kitchen.succeeded()


@pytest.mark.simulation
@pytest.mark.parametrize(("task", "dish"), [("PnPStoveToCounter", "plate"), ("PnPCounterToStove", "pan")])
def test_dish_judges(task, dish):
    kitchen = make(task, 0)
    food, T = kitchen.focus[0], kitchen.physics.T_world(dish)
    floor = layout.KITCHEN.loose[dish].shape.floor_z
    for offset, success in [((0.0, 0.0), True), ((0.05, -0.03), True), ((0.0, 0.12), False)]:
        put(kitchen, food, T.apply((*offset, floor + 0.025)))
        assert kitchen.succeeded() is success
    put(kitchen, food, T.apply((0.0, 0.0, floor + 0.15)))
    assert not kitchen.succeeded()


@pytest.mark.simulation
def test_a_food_in_a_dish_is_not_on_the_counter():
    kitchen = make("PnPCabToCounter", 0)
    put(kitchen, kitchen.focus[0], kitchen.physics.T_world("plate").apply((0.0, 0.0, 0.02)))
    assert inside(kitchen.physics, kitchen.focus[0], "plate")
    assert not kitchen.succeeded()


@pytest.mark.simulation
@pytest.mark.parametrize(("offset", "tilt", "seated"), [
    ((0.0, 0.0, 0.0), 0.0, True), ((0.004, 0.0, 0.001), 0.0, True), ((0.0, 0.0, 0.005), 0.0, False),
    ((0.0, 0.0, 0.002), 3.5, False), ((0.03, 0.0, 0.0), 0.0, False),
])  # fmt: skip
def test_a_lid_covers_when_it_lies_in_its_seat(offset, tilt, seated):
    kitchen = make("PlayServe", 0)
    pan, lid = layout.PLAY.loose["pan"].shape, layout.PLAY.loose["lid"].shape
    seat = kitchen.physics.T_world("pan").apply(np.add(offset, (0.0, 0.0, pan.rim_z - lid.seat_z)))
    kitchen.physics.set_loose("lid", Pose.from_rotvec(seat, [np.radians(tilt), 0.0, 0.0]))
    kitchen.physics.forward()
    assert covers(kitchen.physics, "lid", "pan") is seated


@pytest.mark.simulation
@pytest.mark.parametrize("where", ["pan", "dish-rack"])
def test_a_dropped_lid_finds_its_seat(where):
    kitchen = make("Play", 0)
    physics = kitchen.physics
    T = physics.T_world(where)
    physics.set_loose("lid", Pose(T.p + np.array([0.004, -0.004, 0.07]), T.q))
    for _ in range(30):
        kitchen.step(Command.hold(False))
    assert covers(physics, "lid", "pan") is (where == "pan")
    assert in_rack(physics, "lid", "dish-rack") is (where == "dish-rack")
    assert physics.speed("lid") < 1e-3


@pytest.mark.simulation
def test_questions_about_what_is_no_dish_are_refused():
    physics = make("Play", 0).physics
    with pytest.raises(InputError, match="'lid' is no vessel; the play scene has: pan, red-plate, white-plate"):
        inside(physics, "block", "lid")
    with pytest.raises(InputError, match="'pan' is no lid; the play scene has: lid"):
        covers(physics, "pan", "pan")


@pytest.mark.simulation
def test_a_goal_of_play_is_judged_by_what_lies_where():
    kitchen = make("PlayServe", 0)
    assert not kitchen.succeeded()
    put(kitchen, "block", kitchen.physics.T_world("white-plate").apply((0.01, 0.0, 0.02)))
    assert kitchen.succeeded()


@pytest.mark.simulation
@pytest.mark.parametrize(("task", "foods", "parts", "spoilt"), [
    ("MakeBreakfast", {"cheese": None, "bread": "pan"}, {"knob": 1.7, "drawer": 0.18}, ("knob", 0.0)),
    (
        "CookDinner",
        {"cheese": None, "bread": "pan-2", "can": "plate", "butter": "pan"},
        {"knob": 1.7, "knob-2": 1.7, "lever": 1.2, "drawer": 0.18, "door": 0.0},
        ("door", 0.5),
    ),
])  # fmt: skip
def test_a_long_goal_needs_all_of_it(task, foods, parts, spoilt):
    kitchen = make(task, 0)
    for food, where in foods.items():
        floor = {"pan": 0.012, "pan-2": 0.012, "plate": 0.022}.get(where, 0.0)
        at = (0.55, 0.10, 0.022) if where is None else kitchen.physics.T_world(where).apply((0.0, 0.0, floor))
        assert not kitchen.succeeded()
        put(kitchen, food, at)
    for part, position in parts.items():
        move(kitchen, part, position)
    assert kitchen.succeeded()
    move(kitchen, *spoilt)
    assert not kitchen.succeeded()


def test_every_task_stands_in_the_document_with_a_picture():
    docs = Path(__file__).parents[2] / "docs"
    text = (docs / "kitchen.md").read_text()
    for name in TASKS:
        assert f"| {name} |" in text
        if TASKS[name].kind != "play":
            assert f"(kitchen/{name}.jpg)" in text
            assert (docs / "kitchen" / f"{name}.jpg").stat().st_size > 2000
