import numpy as np
import pytest

from symskill_pddl.demos import Demo
from symskill_pddl.geometry import Pose
from symskill_pddl.learning.motions import SegmentConfig, intervals, jitters, motions, speeds


def carried(p, hand=None):
    """One box along p (n, 3), under a hand."""
    n, q = len(p), np.tile([1.0, 0, 0, 0], (len(p), 1))
    return Demo(
        name="demo_0",
        source="made",
        task="t",
        times=np.arange(n) * 0.05,
        T_world_ee=Pose(p if hand is None else hand, q),
        aperture=np.full(n, 0.04),
        gripper_closed=np.ones(n, bool),
        objects={"box": "box"},
        T_world_objects=Pose(p[:, None], q[:, None]),
    )


def test_speeds_of_a_constant_twist():
    t = np.arange(50) * 0.05
    T = Pose.from_rotvec(np.outer(t, [0.3, 0.0, 0.4]), np.outer(t, [0.0, 0.6, 0.8]))
    v, w = speeds(T, t, 0.35)
    assert np.allclose(v, 0.5)
    assert np.allclose(w, 1.0, atol=0.003)


def test_speeds_do_not_see_the_sign_of_a_quaternion():
    t = np.arange(50) * 0.05
    T = Pose.from_rotvec(np.zeros((50, 3)), np.outer(t, [0.0, 0.0, 2.0]))
    flipped = Pose(T.p, T.q * np.where(np.arange(50) % 3 == 0, -1, 1)[:, None])
    assert np.allclose(speeds(T, t, 0.35)[1], speeds(flipped, t, 0.35)[1])


def test_speeds_of_a_recording_shorter_than_the_filter():
    t = np.array([0.0, 0.05])
    v, _ = speeds(Pose(np.array([[0.0, 0, 0], [0.01, 0, 0]]), np.tile([1.0, 0, 0, 0], (2, 1))), t, 0.35)
    assert np.allclose(v, 0.2)


def test_hysteresis_keeps_a_run_that_dips():
    enter = np.array([0, 0, 1, 0, 0, 1, 0, 0, 0], bool)
    stay = np.array([0, 1, 1, 1, 1, 1, 0, 1, 0], bool)
    assert intervals(enter, stay) == [(1, 6)]


def test_a_motion_begins_when_the_object_leaves_its_place_and_not_when_a_filter_says_so():
    n, start, stop = 200, 80, 120
    s = np.clip((np.arange(n) - start) / (stop - start), 0.0, 1.0)
    p = np.zeros((n, 3))
    p[:, 0] = 0.3 * s
    demo = carried(p)
    (motion,) = motions(demo, SegmentConfig())
    assert (motion.start, motion.stop) == (start + 1, stop)
    noisy = carried(p + np.random.default_rng(0).normal(0, 0.001, p.shape))
    (motion,) = motions(noisy, SegmentConfig())
    assert abs(motion.start - start) <= 2
    assert abs(motion.stop - stop) <= 2


def test_a_nudge_before_the_push_is_none_of_it():
    p = np.zeros((200, 3))
    p[:, 0] = np.interp(np.arange(200), [40, 43, 60, 90], [0.0, 0.006, 0.006, 0.3])
    (motion,) = motions(carried(p, hand=p + np.array([0.0, 0.01, 0.0])), SegmentConfig())
    assert motion.start >= 60


def test_jitter_is_found_in_spite_of_a_motion():
    rng, p = np.random.default_rng(1), np.zeros((400, 3))
    p[:, 1] = np.interp(np.arange(400), [100, 180], [0.0, 0.4])
    T = Pose.from_rotvec(p + rng.normal(0, 0.002, p.shape), rng.normal(0, 0.01, p.shape))
    metres, radians = jitters(T)
    assert metres == pytest.approx(0.002, rel=0.15)
    assert radians == pytest.approx(0.01, rel=0.15)
    assert jitters(T[:2]) == (0.0, 0.0)
