"""Every disturbance does what it says, in physics."""

import numpy as np
import pytest

from symskill_pddl.demonstrator.poses import hand_pose
from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose, rotation_distance
from symskill_pddl.kitchen import TASKS, layout, make, parse_disturbance
from symskill_pddl.kitchen.disturbances import KINDS
from symskill_pddl.kitchen.disturbances.around import carried
from symskill_pddl.kitchen.judges import covers
from symskill_pddl.panda import reach
from symskill_pddl.scene import Command

from .servo import servo


@pytest.mark.parametrize(
    ("spec", "time", "step", "chance", "times"),
    [
        ("close-door@t=5", 5.0, None, None, 1),
        ("close-drawer@op=2", None, 2, None, 1),
        ("push:20N,0.5s@t=1.5", 1.5, None, None, 1),
        ("drop@op=0", None, 0, None, 1),
        ("push:20N,0.5s@p=0.01", None, None, 0.01, None),
        ("any@p=.5x3", None, None, 0.5, 3),
    ],
)
def test_moments_are_understood(spec, time, step, chance, times):
    when = parse_disturbance(spec).when
    assert (when.time_s, when.step, when.chance, when.times) == (time, step, chance, times)


def test_arguments_are_understood():
    assert parse_disturbance("push:30N@t=0").arguments.values == {"N": 30.0, "s": 0.5}
    assert parse_disturbance("shift:5cm@t=0").arguments["m"] == pytest.approx(0.05)
    noise = parse_disturbance("noise:5mm,2deg@t=0").arguments
    assert (noise["m"], noise["rad"], noise["s"]) == (pytest.approx(0.005), pytest.approx(np.radians(2)), np.inf)
    freeze = parse_disturbance("freeze:cheese,3s@t=0").arguments
    assert (freeze.about, freeze["s"]) == ("cheese", 3.0)


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("explode@t=1", "there are: any, close-door, close-drawer, close-knob, close-knob-2, close-lever, drop, freeze, "),
        ("drop", "drop@t=SECONDS"),
        ("drop@t=", "drop@t=SECONDS"),
        ("drop@t=soon", "drop@t=SECONDS"),
        ("drop@op=1.5", "drop@op=NUMBER"),
        ("drop@x=1", "drop@t=SECONDS"),
        ("drop@p=1.5", "drop@p=PROBABILITY"),
        ("drop@p=0", "drop@p=PROBABILITY"),
        ("drop@p=0.1x0", "drop@p=PROBABILITY"),
        ("push:20@t=1", "units N, s"),
        ("push:-20N@t=1", "units N, s"),
        ("push:20kg@t=1", "units N, s"),
        ("push:N@t=1", "units N, s"),
        ("freeze:cheese,can@t=1", "'can' is not a number with one of the units s or an object's name"),
    ],
)
def test_errors_say_what_exists(spec, message):
    with pytest.raises(InputError, match=message) as error:
        parse_disturbance(spec)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("spec", ["freeze:plum@t=1", "shift:plum@t=1"])
def test_what_the_scene_does_not_have_is_refused(spec):
    with pytest.raises(InputError, match="the scene has no 'plum'; it has: bread, cabinet, can") as error:
        parse_disturbance(spec).check(layout.KITCHEN.types)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("kind", [name for name in KINDS if name.startswith("close-")])
def test_a_part_is_shut_by_its_name_where_the_scene_has_it(kind):
    scenes = [scene.types for scene in layout.SCENES.values()]
    assert [not KINDS[kind].lacks(types) for types in scenes] == [kind.removeprefix("close-") in types for types in scenes]


def aside(kitchen):
    """The arm out of the way of the door."""
    kitchen.physics.set_arm(reach.solve(kitchen.physics, hand_pose((0.46, 0.43, 0.30), np.radians(-15), np.radians(70))))
    kitchen.physics.forward()


def hold(kitchen, seconds, close=False):
    return [kitchen.step(Command.hold(close)) for _ in range(round(seconds / kitchen.period_s))]


def grasp_food(kitchen, lift=0.2):
    food = kitchen.focus[0]
    yaw, pitch = kitchen.episode.loose[food].yaw, np.radians(78.0)
    at = hand_pose(kitchen.observe().pose(food).p, yaw, pitch)
    servo(kitchen, Pose(at.p - at.rotate([0.0, 0.0, 0.12]), at.q), False, 40, speed=0.4)
    servo(kitchen, at, False, 30)
    servo(kitchen, at, True, 10)
    servo(kitchen, Pose(at.p + np.array([0.0, 0.0, lift]), at.q), True, 30)
    return food


@pytest.mark.simulation
@pytest.mark.parametrize(
    ("task", "part"),
    [("CloseSingleDoor", "door"), ("CloseDrawer", "drawer"), ("TurnOffStove", "knob"), ("TurnOffSinkFaucet", "lever")],
)
def test_an_open_part_is_shut_gently_when_its_step_comes(task, part):
    kitchen = make(task, 0, [f"close-{part}@op=1"])
    aside(kitchen)
    start, fastest = kitchen.physics.position(part), 0.0
    assert start >= layout.PARTS[part].opened
    for k in range(2):
        kitchen.notify_step(k)
        before = kitchen.physics.position(part)
        for _ in range(10):
            hold(kitchen, 0.05)
            fastest = max(fastest, abs(kitchen.physics.data.qvel[kitchen.physics.joint_v(part)]))
        assert (abs(kitchen.physics.position(part) - before) < 1e-3 * start) == (k == 0)
    hold(kitchen, 2.0)
    assert kitchen.physics.position(part) < layout.PARTS[part].shut
    assert fastest < layout.PARTS[part].travel
    assert kitchen.physics.loads == []
    assert [text for _, text in kitchen.events] == [f"close-{part}@op=1"]


@pytest.mark.simulation
def test_what_is_shut_is_closed_as_soon_as_it_has_been_opened():
    kitchen = make("OpenDrawer", 0, ["close-drawer@t=0"])
    hold(kitchen, 0.5)
    assert kitchen.events == []
    kitchen.physics.set_part("drawer", 0.15)
    hold(kitchen, 2.5)
    assert kitchen.physics.position("drawer") < 0.01
    assert kitchen.events == [(0.5, "close-drawer@t=0")]


@pytest.mark.simulation
def test_a_push_moves_the_hand_for_its_time_only():
    kitchen = make("OpenSingleDoor", 0, ["push:20N,0.5s@t=0.2"])
    p = np.array([kitchen.observe().T_world_ee.p, *(scene.T_world_ee.p for scene in hold(kitchen, 2.0))])
    assert np.linalg.norm(p[4] - p[0]) < 1e-3
    assert np.linalg.norm((p[14] - p[4])[:2]) > 0.003
    assert np.linalg.norm(p[-1] - p[30]) < 1e-3
    assert not kitchen.physics.data.xfrc_applied.any()


@pytest.mark.simulation
def test_its_direction_and_its_moments_come_from_the_seed_and_the_text():
    def path(seed, spec):
        kitchen = make("OpenSingleDoor", 0)
        kitchen = type(kitchen)(kitchen.spec, kitchen.episode, kitchen.physics, [parse_disturbance(spec)], seed)
        p = np.array([scene.T_world_ee.p for scene in hold(kitchen, 1.5)])
        return p, kitchen.events

    (a, events), (b, again) = path(0, "push@p=0.2"), path(0, "push@p=0.2")
    assert a.tobytes() == b.tobytes()
    assert events == again
    assert len(events) > 1
    assert path(1, "push@p=0.2")[0].tobytes() != a.tobytes()
    assert len(path(0, "push@p=1x1")[1]) == 1


@pytest.mark.simulation
def test_what_is_carried_drops_and_not_before():
    kitchen = make("PnPCounterToCab", 0, ["drop@t=0"])
    hold(kitchen, 0.3)
    food = grasp_food(kitchen, lift=0.0)
    assert kitchen.events == []
    T = kitchen.observe().T_world_ee
    servo(kitchen, Pose(T.p + np.array([0.0, 0.0, 0.15]), T.q), True, 40)
    assert [text for _, text in kitchen.events] == ["drop@t=0"]
    assert carried(kitchen.physics) == []
    assert kitchen.observe().pose(food).p[2] < 0.06
    assert kitchen.observe().gripper_closed


@pytest.mark.simulation
@pytest.mark.parametrize("task", ["PnPCounterToCab", "PnPCabToCounter"])
def test_the_target_is_slid_aside(task):
    kitchen = make(task, 1, ["shift:5cm@t=0.2"])
    food = kitchen.focus[0]
    scenes = [kitchen.observe(), *hold(kitchen, 3.0)]
    p = np.array([scene.pose(food).p for scene in scenes])
    assert np.linalg.norm(p[3] - p[0]) < 1e-3
    assert np.linalg.norm((p[-1] - p[0])[:2]) == pytest.approx(0.05, abs=0.01)
    assert abs(p[-1, 2] - p[0, 2]) < 0.005
    assert rotation_distance(scenes[-1].pose(food), scenes[0].pose(food)) < 0.1
    assert np.linalg.norm(np.diff(p, axis=0), axis=1).max() / kitchen.period_s < 0.6


@pytest.mark.simulation
@pytest.mark.parametrize("task", ["PnPCounterToStove", "PnPStoveToCounter"])
def test_the_plate_is_slid_with_what_lies_on_it(task):
    kitchen = make(task, 2, ["move-plate:8cm@t=0"])
    food, first = kitchen.focus[0], kitchen.observe()
    last = hold(kitchen, 3.0)[-1]
    moved = last.pose("plate").p - first.pose("plate").p
    assert np.linalg.norm(moved[:2]) == pytest.approx(0.08, abs=0.01)
    assert abs(moved[2]) < 0.003
    along = last.pose(food).p - first.pose(food).p
    assert np.linalg.norm(along - (moved if kitchen.focus[1] == "plate" else 0.0)) < 0.02


@pytest.mark.simulation
@pytest.mark.parametrize("nth", range(3))
def test_the_lid_is_set_on_the_pan_at_a_hands_speed(nth):
    in_rack = [s for s in range(20) if TASKS["Play"].draw(np.random.default_rng(s)).loose["lid"].on == "dish-rack"]
    kitchen = make("Play", in_rack[nth], ["put-lid-back@t=0.1"])
    assert not covers(kitchen.physics, "lid", "pan")
    scenes = hold(kitchen, 7.0)
    assert covers(kitchen.physics, "lid", "pan")
    p = np.array([scene.pose("lid").p for scene in scenes])
    assert np.linalg.norm(np.diff(p, axis=0), axis=1).max() / kitchen.period_s < 0.4
    assert kitchen.physics.loads == []


@pytest.mark.simulation
def test_a_scene_without_a_lid_is_told_so():
    with pytest.raises(InputError, match="'put-lid-back@t=1': the scene has no lid; it has: bread, cabinet") as error:
        make("OpenSingleDoor", 0, ["put-lid-back@t=1"])
    assert "\n" not in str(error.value)


@pytest.mark.simulation
def test_what_is_held_is_not_slid():
    kitchen = make("PnPCounterToCab", 0, ["shift@t=3.9"])
    grasp_food(kitchen)
    assert kitchen.time > 4.0
    hold(kitchen, 1.0, close=True)
    assert kitchen.events == []


@pytest.mark.simulation
def test_an_obstacle_is_put_ahead_of_the_moving_hand_and_taken_away():
    kitchen = make("OpenSingleDoor", 0, ["obstacle:18cm,1s@t=0.5"])
    first = kitchen.observe()
    assert first.objects["obstacle"] == "obstacle"
    assert np.linalg.norm(first.pose("obstacle").p - first.T_world_ee.p) > 2.0
    assert kitchen.extents["obstacle"] == (0.04, 0.04, 0.04)
    hold(kitchen, 0.7)
    assert kitchen.events == []
    target = first.T_world_ee.p + np.array([-0.05, 0.5, 0.0])
    way = (target - first.T_world_ee.p) / np.linalg.norm(target - first.T_world_ee.p)
    while not kitchen.events:
        before = kitchen.observe().T_world_ee.p
        scene = kitchen.step(Command.of(0.2 * way, np.zeros(3), False))
    gap = scene.pose("obstacle").p - before
    assert gap @ way == pytest.approx(0.18, abs=0.02)
    assert np.linalg.norm(gap) < 0.2
    # it is real: the hand cannot pass through it
    for _ in range(15):
        scene = kitchen.step(Command.of(0.3 * way, np.zeros(3), False))
    assert kitchen.physics.robot_touches("obstacle")
    last = hold(kitchen, 0.5)[-1]
    assert last.pose("obstacle").p == pytest.approx(first.pose("obstacle").p)


@pytest.mark.simulation
def test_a_frozen_estimate_stays_and_the_judge_sees_the_truth():
    kitchen = make("CloseSingleDoor", 0, ["freeze:1s@t=0.5", "close-door@t=0.5"])
    aside(kitchen)
    scenes = hold(kitchen, 3.5)
    kept = scenes[9].pose("door").vector().tobytes()
    assert all(scene.pose("door").vector().tobytes() == kept for scene in scenes[9:29])
    assert scenes[30].pose("door").vector().tobytes() != kept
    truth = kitchen.physics.T_world("door").vector()
    assert scenes[-1].pose("door").vector().tobytes() == truth.tobytes()
    assert kitchen.succeeded()


@pytest.mark.simulation
def test_noise_is_as_large_as_told_and_only_in_what_is_seen():
    kitchen = make("OpenSingleDoor", 0, ["noise:5mm,2deg,5s@t=0.5"])
    scenes = hold(kitchen, 6.0)
    p = np.array([scene.T_world_objects.p for scene in scenes])
    still = p[-1]
    np.testing.assert_allclose(p[5], still, atol=2e-4)
    seen = scenes[10:109]
    assert np.std(p[10:109] - still) == pytest.approx(0.005, rel=0.1)
    turns = np.array([rotation_distance(scene.T_world_objects, scenes[-1].T_world_objects) for scene in seen])
    assert np.sqrt(np.mean(turns**2) / 3) == pytest.approx(np.radians(2), rel=0.1)
    # one look is one measurement
    kitchen = make("OpenSingleDoor", 0, ["noise@t=0"])
    scene = hold(kitchen, 0.1)[-1]
    assert kitchen.observe().T_world_objects.p.tobytes() == scene.T_world_objects.p.tobytes()
    door = list(scene.objects).index("door")
    np.testing.assert_allclose(kitchen.physics.T_world("door").p, still[door], atol=1e-6)
    assert np.linalg.norm(scene.T_world_objects.p[door] - still[door]) > 1e-4


@pytest.mark.simulation
def test_any_is_one_of_all():
    kitchen = make("PnPCounterToCab", 0, ["any@p=0.2"])
    hold(kitchen, 20.0)
    names = [text for _, text in kitchen.events if text in KINDS]
    assert len(set(names)) > 2
    assert "any" not in names
    assert "drop" not in names


def test_every_kind_concerns_some_task():
    focus = [task.draw(np.random.default_rng(0)).focus for task in TASKS.values()]
    assert all(any(kind.concerns(f) for f in focus) for kind in KINDS.values())
