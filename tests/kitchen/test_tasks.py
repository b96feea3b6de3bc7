"""The judges, on states set by hand, and what is drawn."""

import numpy as np
import pytest
from numpy.random import default_rng

from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import TASKS, arm, layout, make
from symskill_pddl.kitchen.demo_hand import facing
from symskill_pddl.kitchen.tasks import COUNTER_REGION, food_pose

SEEDS = range(30)


@pytest.mark.parametrize("task", TASKS)
def test_foods_stand_apart_and_within_their_regions(task):
    for seed in SEEDS:
        episode = TASKS[task].draw(default_rng(seed))
        poses = {name: food_pose(name, place, episode.cabinet_shift) for name, place in episode.foods.items()}
        assert sorted(poses) == sorted(layout.FOODS)
        points = np.array([T.p for T in poses.values()])
        gaps = np.linalg.norm(points[:, None] - points[None], axis=-1)[np.triu_indices(len(points), 1)]
        assert gaps.min() > 0.085
        for name, place in episode.foods.items():
            assert place.on == "cabinet" or COUNTER_REGION.contains(poses[name].p)


def test_the_focus_food_varies_and_starts_where_the_task_says():
    drawn = [TASKS["PnPCabToCounter"].draw(default_rng(seed)) for seed in SEEDS]
    assert {episode.focus[0] for episode in drawn} == set(layout.FOODS)
    assert all(episode.foods[episode.focus[0]].on == "cabinet" for episode in drawn)
    assert all(TASKS["PnPCounterToCab"].draw(default_rng(s)).foods["cheese"].on == "counter" for s in SEEDS)


def test_goals_of_composite_tasks_are_atomic_tasks():
    assert TASKS["StoreCheese"].goal_of == ("PnPCabToCounter", "CloseSingleDoor")
    for spec in TASKS.values():
        assert all(not TASKS[name].composite for name in spec.goal_of)


# --- judges


def put(kitchen, food, p):
    kitchen.physics.set_food(food, Pose(np.asarray(p, dtype=float), np.array([1.0, 0.0, 0.0, 0.0])))
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
            assert set(episode.positions) == set(layout.PARTS)
            assert set(episode.shifts) == set(layout.UNITS)
            others = [p for p in layout.PARTS if p != "door" and p not in episode.focus]
            assert all(episode.positions[p] == 0.0 for p in others), name


@pytest.mark.simulation
def test_a_hand_on_the_bar_of_a_shut_drawer_is_no_success():
    kitchen = make("CloseDrawer", 0)
    move(kitchen, "drawer", 0.0)
    bar = kitchen.physics.T_world("drawer").apply(layout.PARTS["drawer"].grip)
    kitchen.physics.set_arm(arm.solve(kitchen.physics, Pose(bar, facing(0.0, np.radians(60), -np.pi / 2))))
    kitchen.physics.forward()
    assert not kitchen.succeeded()


@pytest.mark.simulation
def test_a_hand_on_the_handle_is_no_success():
    kitchen = make("CloseSingleDoor", 0)
    turn(kitchen, 0)
    handle = kitchen.physics.T_world("door").apply(layout.HANDLE)
    kitchen.physics.set_arm(arm.solve(kitchen.physics, layout.hand_pose(handle, np.radians(15), np.radians(20))))
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
    kitchen.physics.set_arm(arm.solve(kitchen.physics, layout.hand_pose((0.45, 0.30, 0.04), 0.0, np.radians(50))))
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
