import numpy as np
import pytest

from symskill_pddl.geometry import Pose, quat_exp, quat_multiply
from symskill_pddl.learning.articulation import agreed_joint, fit_joint


def noisy(T, rng, m=0.001, rad=0.004):
    n = len(T)
    return Pose(T.p + rng.normal(0, m, (n, 3)), quat_multiply(T.q, quat_exp(rng.normal(0, rad, (n, 3)))))


def hinge(axis, point, lever, angles):
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    turn = Pose.from_rotvec(np.zeros((len(angles), 3)), np.outer(angles, axis))
    return Pose(point + turn.rotate(np.asarray(lever, float)), turn.q)


@pytest.mark.parametrize("axis", [[0, 0, 1], [0, 1, 0], [1, 2, -1]])
@pytest.mark.parametrize("lever", [[0.0, 0.0, 0.0], [0.0, 0.3, 0.0]])
def test_a_hinge_is_found_wherever_the_frame_sits(axis, lever):
    rng = np.random.default_rng(0)
    T = noisy(hinge(axis, np.array([0.3, -0.2, 0.5]), lever, np.linspace(0.1, 1.6, 60)), rng)
    joint = fit_joint([T[:30], T[30:]])
    assert joint is not None
    assert joint.kind == "hinge"
    unit = np.asarray(axis) / np.linalg.norm(axis)
    assert abs(joint.axis @ unit) > 0.999
    found = joint.coordinate(hinge(axis, np.zeros(3), lever, np.array([0.2, 1.2]))) * np.sign(joint.axis @ unit)
    assert np.allclose(found, [0.2, 1.2], atol=0.01)


def test_a_slide():
    rng = np.random.default_rng(1)
    way = np.linspace(0, 0.25, 40)
    joint = fit_joint([noisy(Pose(np.outer(way, [-1.0, 0, 0]) + np.array([0.3, 0.1, 0]), np.tile([1.0, 0, 0, 0], (40, 1))), rng)])
    assert joint is not None
    assert joint.kind == "slide"
    assert abs(joint.axis[0]) > 0.999
    assert np.isclose(
        abs(float(np.ptp(joint.coordinate(Pose(np.outer([0.0, 0.2], joint.axis), np.tile([1.0, 0, 0, 0], (2, 1))))))), 0.2
    )


def test_what_is_carried_is_neither():
    s = np.linspace(0, 1, 50)[:, None]
    arc = Pose(np.hstack([0.4 * s, 0.1 * s, 0.2 * np.sin(np.pi * s)]), np.tile([1.0, 0, 0, 0], (50, 1)))
    assert fit_joint([arc]) is None
    turned = Pose.from_rotvec(arc.p, np.hstack([0.0 * s, 0.0 * s, s]))
    assert fit_joint([turned]) is None


def test_a_single_lift_is_no_slide_and_short_moves_are_nothing():
    up = Pose(np.outer(np.linspace(0, 0.1, 30), [0.0, 0, 1]), np.tile([1.0, 0, 0, 0], (30, 1)))
    assert fit_joint([up]) is None
    short = Pose(np.outer(np.linspace(0, 0.02, 30), [1.0, 0, 0]), np.tile([1.0, 0, 0, 0], (30, 1)))
    assert fit_joint([short]) is None


def test_two_pushes_along_different_lines_are_no_slide():
    one = Pose(np.outer(np.linspace(0, 0.2, 30), [1.0, 0, 0]), np.tile([1.0, 0, 0, 0], (30, 1)))
    other = Pose(one.p + np.array([0.0, 0.1, 0.0]), one.q)
    assert fit_joint([one]) is not None
    assert fit_joint([one, other]) is None


def test_one_hinge_seen_by_trackers_that_are_each_off_by_centimetres():
    """Together the poses lie on no joint; each recording's do, and their axes agree."""
    rng, ways = np.random.default_rng(0), []
    for _ in range(6):
        turn = Pose.from_rotvec(np.zeros((20, 3)), np.linspace(0, 0.9, 20)[:, None] * np.array([0.0, 0.0, 1.0]))
        off = Pose.from_rotvec(rng.normal(0, 0.02, 3), rng.normal(0, 0.03, 3))
        ways.append(off @ turn @ Pose.from_rotvec(np.array([0.0, 0.2, 0.0]), rng.normal(0, 0.03, 3)))
    assert fit_joint(ways) is None
    joint = agreed_joint(ways)
    assert joint.kind == "hinge"
    assert joint.axis[2] > np.cos(np.radians(5))
    crooked = [Pose.from_rotvec(np.zeros(3), np.array([0.9 * k, 0.0, 0.0])) @ way for k, way in enumerate(ways)]
    assert agreed_joint(crooked) is None
