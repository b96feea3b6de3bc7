"""The robot's own view of a kitchen, and its mirror image."""

import numpy as np
import pytest

from symskill_pddl.geometry import Pose, quat_exp, quat_multiply, rotation_distance
from symskill_pddl.robocasa.view import View, mirror

RNG = np.random.default_rng(5)


def a_pose() -> Pose:
    return Pose.from_rotvec(RNG.normal(size=3), RNG.normal(size=3))


def same(a: Pose, b: Pose) -> bool:
    return bool(np.allclose(a.p, b.p, atol=1e-12) and rotation_distance(a, b) < 1e-6)


def test_the_mirror_keeps_what_is_between_two_frames() -> None:
    a, b = a_pose(), a_pose()
    assert same(mirror(mirror(a)), a)
    assert same(mirror(a) @ mirror(b), mirror(a @ b))
    assert same(mirror(a).inverse(), mirror(a.inverse()))


def test_a_left_hinge_is_a_right_hinge_in_the_mirror() -> None:
    left = Pose.from_rotvec([0.4, 0.2, 0.9], [0.0, 0.0, -1.0])
    assert same(mirror(left), Pose.from_rotvec([0.4, -0.2, 0.9], [0.0, 0.0, 1.0]))


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_twist_moves_the_hand_in_the_simulator_as_it_does_in_the_view(mirrored: bool) -> None:
    view = View(Pose.from_rotvec([3.0, -2.0, 0.7], [0.0, 0.0, 2.4]), mirrored)
    T_world_ee, seen, dt = a_pose(), RNG.normal(size=6), 1e-6

    def moved(T: Pose, twist: np.ndarray) -> Pose:
        return Pose(T.p + dt * twist[:3], quat_multiply(quat_exp(dt * twist[3:]), T.q))

    expected = moved(view.pose(T_world_ee), seen)
    got = view.pose(moved(T_world_ee, view.twist(seen)))
    assert np.allclose(got.p, expected.p, atol=1e-12)
    assert rotation_distance(got, expected) < 1e-9


def test_seen_from_the_robot_the_kitchens_place_in_the_world_is_nothing() -> None:
    robot, thing, move = a_pose(), a_pose(), Pose.from_rotvec([4.0, 1.0, 0.0], [0.0, 0.0, np.pi / 2])
    assert same(View(robot).pose(thing), View(move @ robot).pose(move @ thing))
