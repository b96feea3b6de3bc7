import time

import numpy as np
import pytest

from symskill_pddl.demonstrator.poses import hand_pose
from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose, quat_conjugate, quat_log, quat_multiply, rotation_distance
from symskill_pddl.kitchen import TASKS, layout, make
from symskill_pddl.panda import reach
from symskill_pddl.scene import Command, Timed

from .servo import servo

pytestmark = pytest.mark.simulation


def test_same_seed_same_episode_and_same_motion_bit_for_bit():
    a, b = make("PnPCounterToCab", 3), make("PnPCounterToCab", 3)
    command = Command.of([0.1, -0.05, 0.05], [0.2, 0.0, -0.3], True)
    for _ in range(20):
        s, t = a.step(command), b.step(command)
    assert s.T_world_ee.vector().tobytes() == t.T_world_ee.vector().tobytes()
    assert s.T_world_objects.vector().tobytes() == t.T_world_objects.vector().tobytes()
    assert a.physics.data.qpos.tobytes() == b.physics.data.qpos.tobytes()


def test_other_seeds_are_other_episodes():
    starts = {make("OpenSingleDoor", seed).observe().T_world_ee.p.tobytes() for seed in range(4)}
    assert len(starts) == 4


@pytest.mark.parametrize("task", TASKS)
def test_an_episode_starts_at_rest_and_unsolved(task):
    for seed in range(3):
        kitchen = make(task, seed)
        assert kitchen.task == task
        # free play has no goal but order, which there is at first
        assert kitchen.succeeded() is (task == "Play")
        first = kitchen.observe()
        assert first.time == 0.0
        assert dict(first.objects) == TASKS[task].scene.types
        assert set(kitchen.focus) <= set(first.objects)
        for _ in range(20):
            last = kitchen.step(Command.hold(False))
        np.testing.assert_allclose(last.T_world_objects.p, first.T_world_objects.p, atol=1e-3)
        np.testing.assert_allclose(last.T_world_ee.p, first.T_world_ee.p, atol=1e-3)
        assert last.time == pytest.approx(20 * kitchen.period_s)


def test_frames_of_the_shut_door_and_the_cabinet_agree():
    scene = make("OpenSingleDoor", 0).observe()
    T_cabinet_door = scene.pose("cabinet").inverse() @ scene.pose("door")
    np.testing.assert_allclose(T_cabinet_door.p, layout.DOOR.center, atol=1e-6)
    assert rotation_distance(T_cabinet_door, Pose.identity()) < 1e-6


def test_unknown_task_lists_what_exists():
    with pytest.raises(InputError, match=r"CloseDrawer, CloseSingleDoor, CookDinner, .*OpenDrawer, OpenSingleDoor") as error:
        make("Cook", 0)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("axis", range(6))
def test_twists_are_tracked(axis):
    kitchen = make("OpenSingleDoor", 1)
    twist = np.zeros(6)
    twist[axis] = 0.1 if axis < 3 else 0.4
    start = kitchen.observe().T_world_ee
    for _ in range(20):
        end = kitchen.step(Command(twist, False)).T_world_ee
    moved = np.concatenate([end.p - start.p, quat_log(quat_multiply(end.q, quat_conjugate(start.q)))])
    np.testing.assert_allclose(moved[:3], twist[:3], atol=0.006)
    np.testing.assert_allclose(moved[3:], twist[3:], atol=0.04)


def test_commands_beyond_the_limits_are_scaled_down():
    kitchen = make("OpenSingleDoor", 1)
    start = kitchen.observe().T_world_ee.p
    end = kitchen.step(Command.of([0.0, 50.0, 0.0], [0.0, 0.0, 0.0], False)).T_world_ee.p
    assert np.linalg.norm(end - start) < 0.6 * kitchen.period_s


def test_a_pushed_door_moves_and_stays_where_it_is_left():
    kitchen = make("OpenSingleDoor", 0)
    # out of the way of the door
    kitchen.physics.set_arm(reach.solve(kitchen.physics, hand_pose((0.46, 0.43, 0.10), np.radians(-15.0), np.radians(70.0))))
    kitchen.physics.loads.append(lambda: kitchen.physics.data.qfrc_applied.__setitem__(kitchen.physics.joint_v("door"), 3.0))
    for _ in range(20):
        kitchen.step(Command.hold(False))
    kitchen.physics.loads.clear()
    for _ in range(20):
        kitchen.step(Command.hold(False))
    angle = kitchen.physics.door_angle
    assert angle > 0.5
    for _ in range(40):
        kitchen.step(Command.hold(False))
    assert abs(kitchen.physics.door_angle - angle) < 1e-3


@pytest.mark.parametrize("seed", range(2))
def test_the_hand_picks_lifts_and_holds_a_food_of_200_g(seed):
    kitchen = make("PnPCounterToCab", seed)
    food = kitchen.focus[0]
    body = kitchen.physics.model.body(f"{food}_main")
    body.inertia[:] *= 0.2 / body.mass[0]
    body.mass[0] = 0.2
    T, yaw, pitch = kitchen.observe().pose(food), kitchen.episode.loose[food].yaw, np.radians(78.0)
    grasp = hand_pose(T.p, yaw, pitch)
    servo(kitchen, Pose(grasp.p - grasp.rotate([0.0, 0.0, 0.12]), grasp.q), False, 60)
    position, rotation = servo(kitchen, grasp, False, 50)
    assert position < 3e-3
    assert rotation < np.radians(1.0)
    servo(kitchen, grasp, True, 12)
    up = hand_pose(T.p + np.array([0.0, 0.0, 0.2]), yaw, pitch)
    position, rotation = servo(kitchen, up, True, 60)
    assert position < 3e-3
    assert rotation < np.radians(1.0)
    assert kitchen.observe().pose(food).p[2] > 0.2
    assert kitchen.physics.robot_touches(food)


def test_the_fingers_hold_the_handle_and_the_door_follows():
    kitchen = make("OpenSingleDoor", 0)
    yaw, pitch = np.radians(15.0), np.radians(20.0)
    handle = kitchen.observe().pose("door").apply(layout.HANDLE)
    servo(kitchen, hand_pose(handle - np.array([0.1, 0.0, 0.0]), yaw, pitch), False, 60)
    position, _ = servo(kitchen, hand_pose(handle, yaw, pitch), False, 40)
    assert position < 3e-3
    servo(kitchen, hand_pose(handle, yaw, pitch), True, 12)
    assert kitchen.observe().aperture == pytest.approx(2 * layout.HANDLE_RADIUS, abs=2e-3)
    hinge = kitchen.observe().pose("cabinet").apply(np.add(layout.DOOR.center, layout.DOOR_HINGE))
    for angle in np.radians(np.arange(1.0, 41.0)):
        arm = Pose.from_rotvec(np.zeros(3), [0.0, 0.0, angle]).apply(np.subtract(layout.HANDLE, layout.DOOR_HINGE))
        servo(kitchen, hand_pose(hinge + arm, yaw + 0.6 * angle, pitch), True, 2, gain=6.0)
    assert kitchen.physics.door_angle > np.radians(35.0)


def test_it_says_what_a_step_spent_on_looking_and_controlling():
    kitchen = make("OpenSingleDoor", 0)
    begin = time.perf_counter()
    kitchen.step(Command.hold(False))
    assert isinstance(kitchen, Timed)
    assert set(kitchen.ms) == {"observe", "controller"}
    assert all(0 < ms < 1e3 * (time.perf_counter() - begin) for ms in kitchen.ms.values())
