"""The demonstrator's hand, on a world that simply does what it is told (with some lag)."""

import numpy as np
import pytest

from symskill_pddl.demonstrator.hand import MAX_ANGULAR_RAD_S, MAX_LINEAR_M_S, Hand
from symskill_pddl.demonstrator.human import Faults, Person
from symskill_pddl.demonstrator.poses import along, facing, moved
from symskill_pddl.geometry import Pose, quat_exp, quat_multiply, rotation_distance
from symskill_pddl.scene import Command, Scene


class FreeHand:
    """Follows twists with a first-order lag and remembers the fastest of them."""

    period_s = 0.05

    def __init__(self) -> None:
        self.T, self.time, self.velocity, self.fastest = Pose.identity(), 0.0, np.zeros(6), np.zeros(2)
        self.closed = False

    def observe(self) -> Scene:
        none = Pose(np.zeros((0, 3)), np.zeros((0, 4)))
        return Scene(self.time, self.T, 0.0 if self.closed else 0.08, self.closed, {}, none)

    def step(self, command: Command) -> Scene:
        twist = command.twist
        self.fastest = np.maximum(self.fastest, [np.linalg.norm(twist[:3]), np.linalg.norm(twist[3:])])
        self.velocity = 0.3 * self.velocity + 0.7 * twist
        turn = quat_exp(self.velocity[3:] * self.period_s)
        self.T = Pose(self.T.p + self.velocity[:3] * self.period_s, quat_multiply(turn, self.T.q))
        self.closed, self.time = command.close_gripper, self.time + self.period_s
        return self.observe()


def hand(seed: int = 0) -> Hand:
    return Hand(FreeHand(), Person(), Faults(), np.random.default_rng(seed))


def test_the_hand_arrives_and_keeps_its_limits() -> None:
    h = hand()
    goal = Pose.from_rotvec([0.3, -0.2, 0.1], [0.0, 0.0, 2.0])
    h.go([Pose.from_rotvec([0.3, 0, 0], [0, 0, 0.5]), goal])
    assert np.linalg.norm(h.T.p - goal.p) < 0.005
    assert rotation_distance(h.T, goal) < 0.04
    assert np.all(h.world.fastest <= np.array([MAX_LINEAR_M_S, MAX_ANGULAR_RAD_S]) + 1e-9)  # type: ignore[attr-defined]


def test_everything_seen_is_remembered_in_order() -> None:
    h = hand()
    h.rest(0.5)
    h.fingers(True)
    times = np.array([scene.time for scene in h.scenes])
    assert np.allclose(np.diff(times), 0.05)
    assert not h.scenes[5].gripper_closed
    assert h.scene.gripper_closed


@pytest.mark.parametrize(("yaw", "pitch"), [(0.0, 0.0), (0.7, 0.6), (-2.0, np.pi / 2)])
def test_facing_points_where_it_says_and_opens_level(yaw: float, pitch: float) -> None:
    T = Pose(np.zeros(3), facing(yaw, pitch))
    z, y = T.rotate([0, 0, 1.0]), T.rotate([0, 1.0, 0])
    assert np.allclose(z, [np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), -np.sin(pitch)])
    assert abs(y[2]) < 1e-12
    rolled = Pose(np.zeros(3), facing(yaw, pitch, np.pi / 2))
    assert np.allclose(rolled.rotate([0, 0, 1.0]), z)
    assert np.allclose(rolled.rotate([1.0, 0, 0]), y)


def test_along_and_moved() -> None:
    T = Pose(np.zeros(3), facing(0.0, 0.0))
    assert np.allclose(along(T, 0.1).p, [0.1, 0, 0])
    assert np.allclose(moved(T, [0, 0, 0.1]).p, [0, 0, 0.1])
