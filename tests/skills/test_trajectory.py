import numpy as np
import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose
from symskill_pddl.skills import FitConfig, Trajectory
from symskill_pddl.skills.trajectory import evenly, orientation_path, position_path, smooth


def poses(n: int) -> Pose:
    return Pose(np.zeros((n, 3)), np.tile([1.0, 0, 0, 0], (n, 1)))


@pytest.mark.parametrize(
    ("times", "n", "message"),
    [
        ([], 0, "at least one sample"),
        ([0.0, 1.0], 3, "as many poses"),
        ([0.0, 1.0, 1.0], 3, "sample 2 is at 1.0 s after 1.0 s"),
        ([0.0, np.nan], 2, "finite"),
    ],
)
def test_bad_trajectories_are_refused(times, n, message):
    with pytest.raises(InputError, match=message):
        Trajectory(np.array(times), poses(n))


def test_times_are_copied_and_read_only():
    times = np.arange(3.0)
    t = Trajectory(times, poses(3))
    times[0] = -5.0
    assert t.times[0] == 0.0
    assert t.duration_s == 2.0
    assert len(t.cut(1, 2)) == 2
    with pytest.raises(ValueError, match="read-only"):
        t.times[0] = 1.0


def test_smoothing_keeps_the_ends_and_removes_noise():
    rng = np.random.default_rng(0)
    t = np.linspace(0.0, 4.0, 81)
    x = np.stack([t, 0 * t, 0 * t], 1)
    noisy = x + rng.normal(0, 0.01, x.shape)
    out = smooth(Trajectory(t, Pose(noisy, np.tile([1.0, 0, 0, 0], (81, 1)))), 0.1)
    assert np.allclose(out.T_frame_ee.p[[0, -1]], noisy[[0, -1]], atol=1e-12)
    assert np.std(out.T_frame_ee.p[5:-5] - x[5:-5]) < 0.006


def test_a_pause_adds_no_way_and_no_slow_stretch():
    s = np.concatenate([np.zeros(20), np.linspace(0, 0.5, 30), np.full(40, 0.5), np.linspace(0.5, 1, 30), np.ones(20)])
    rng = np.random.default_rng(1)
    x = np.stack([s - 1, 0 * s, 0 * s], 1) + rng.normal(0, 2e-4, (len(s), 3))
    path = position_path(Trajectory(0.05 * np.arange(len(s)), Pose(x, poses(len(s)).q)), np.zeros(3), FitConfig())
    assert path is not None
    assert path.remaining[0] == pytest.approx(1.0, abs=0.02)
    assert np.all(path.directions[:, 0] > 0.95)
    assert np.median(path.speeds) == pytest.approx(0.5 / 1.5, rel=0.2)
    assert np.allclose(path.points[-1], 0.0)


def test_paths_are_none_where_nothing_moves():
    still = Trajectory(np.arange(5.0), poses(5))
    assert position_path(still, np.zeros(3), FitConfig()) is None
    assert orientation_path(still, np.array([1.0, 0, 0, 0]), FitConfig()) is None
    assert evenly(np.zeros((5, 6)), 0.01, 0.1, 10) is None


def test_flipped_quaternions_make_the_same_path():
    r = np.linspace(0, 1, 30)[:, None] * np.array([0, 0, 1.5])
    T = Pose.from_rotvec(np.zeros((30, 3)), r)
    signs = np.where(np.arange(30) % 3 == 0, -1.0, 1.0)[:, None]
    goal = T.q[-1]
    one = orientation_path(Trajectory(np.arange(30.0), T), goal, FitConfig())
    two = orientation_path(Trajectory(np.arange(30.0), Pose(T.p, signs * T.q)), goal, FitConfig())
    assert one is not None
    assert two is not None
    assert np.allclose(one.points, two.points, atol=1e-12)
    assert one.remaining[0] == pytest.approx(1.5, abs=1e-6)


def test_evenly_spaces_the_way():
    x = np.zeros((50, 2))
    x[:, 0] = np.linspace(0, 1, 50) ** 3
    points, at = evenly(x, 0.01, 1e-6, 11)
    assert np.allclose(np.diff(points[:, 0]), 0.1, atol=1e-9)
    assert np.all(np.diff(at) >= 0)
