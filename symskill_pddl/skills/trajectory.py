"""`Trajectory`: a recorded end-effector motion in one frame, and `Path`: its geometry without its timing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation, Slerp

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, Pose, frozen, quat_conjugate, quat_exp, quat_log, quat_multiply
from symskill_pddl.skills.config import FitConfig


@dataclass(frozen=True, eq=False)
class Trajectory:
    """End-effector poses over time, in a fixed frame.

    Attributes
    ----------
    times : (n,) array
        Seconds, strictly increasing, n >= 1.
    T_frame_ee : Pose
        Poses (n,) of the end effector.

    Raises
    ------
    InputError
        If the times do not increase, or their number differs from that of the poses.
    """

    times: Array
    T_frame_ee: Pose

    def __post_init__(self) -> None:
        times = frozen(self.times)
        if times.ndim != 1 or len(times) == 0:
            raise InputError(f"a trajectory needs at least one sample and times (n,), got times {times.shape}")
        if self.T_frame_ee.shape != times.shape:
            raise InputError(f"a trajectory of {len(times)} times needs as many poses, got {self.T_frame_ee.shape}")
        if not np.all(np.isfinite(times)):
            raise InputError("a trajectory's times have to be finite")
        if np.any(np.diff(times) <= 0):
            i = int(np.argmax(np.diff(times) <= 0))
            raise InputError(
                f"a trajectory's times have to increase strictly: sample {i + 1} is at {times[i + 1]} s after {times[i]} s"
            )
        object.__setattr__(self, "times", times)

    def __len__(self) -> int:
        return len(self.times)

    @property
    def duration_s(self) -> float:
        return float(self.times[-1] - self.times[0])

    @property
    def end(self) -> Pose:
        return self.T_frame_ee[-1]

    def cut(self, start: int, stop: int) -> Trajectory:
        """Samples start..stop, both included."""
        return Trajectory(self.times[start : stop + 1], self.T_frame_ee[start : stop + 1])


def continuous_signs(q: Array) -> Array:
    """Quaternions (n, 4) with the signs chosen so that neighbours are on the same side."""
    flips = np.where(np.sum(q[1:] * q[:-1], axis=-1) < 0, -1.0, 1.0)
    return np.asarray(q * np.concatenate([[1.0], np.cumprod(flips)])[:, None])


def smooth(trajectory: Trajectory, sigma_s: float) -> Trajectory:
    """Gaussian smoothing on an even time grid of as many samples; first and last pose stay."""
    n = len(trajectory)
    if n < 4:
        return trajectory
    t = np.linspace(trajectory.times[0], trajectory.times[-1], n)
    q = continuous_signs(trajectory.T_frame_ee.q)
    x = np.concatenate([trajectory.T_frame_ee.p, q], axis=1)
    even = np.stack([np.interp(t, trajectory.times, column) for column in x.T], axis=1)
    # The point reflection about the ends keeps them where they are and does not slow the motion there.
    pad = min(n - 1, int(np.ceil(4 * sigma_s / (t[1] - t[0]))) + 1)
    wide = np.concatenate([2 * even[0] - even[pad:0:-1], even, 2 * even[-1] - even[-2 : -pad - 2 : -1]])
    even = gaussian_filter1d(wide, sigma_s / (t[1] - t[0]), axis=0)[pad : pad + n]
    return Trajectory(t, Pose(even[:, :3], even[:, 3:]))


@dataclass(frozen=True, eq=False)
class Path:
    """The geometry of one demonstration relative to its goal, evenly spaced along its way.

    The same type serves positions, with `points = x - x*` [m], and orientations, with `points = log(q q*^-1)` [rad].

    Attributes
    ----------
    points : (n, 3)
        Errors to the goal. The demonstration is bent smoothly so that it ends in the goal.
    directions : (n, 3)
        Unit tangents.
    remaining : (n,)
        Length of the way that is left, in the unit of `points`.
    speeds : (n,)
        Demonstrated speed, pauses left out.
    progress : (n,)
        Fraction of the way that is behind, 0 to 1.
    """

    points: Array
    directions: Array
    remaining: Array
    speeds: Array
    progress: Array


def position_path(trajectory: Trajectory, goal: Array, config: FitConfig) -> Path | None:
    """The positions' path to `goal` (3,), or None when the demonstration stays at its goal."""
    x = trajectory.T_frame_ee.p - goal
    kept = _moving(x, config.still_fraction, config.min_motion_m)
    if kept is None:
        return None
    x, t = x[kept], trajectory.times[kept]
    length = _cumulative(np.linalg.norm(np.diff(x, axis=0), axis=-1))
    grid = np.linspace(0.0, length[-1], config.samples)
    u = grid / length[-1]
    points = np.stack([np.interp(grid, length, column) for column in x.T], axis=1)
    points = points - (u**2)[:, None] * points[-1]
    steps = np.diff(points, axis=0)
    return _path(
        points, np.concatenate([steps[:1], steps[1:] + steps[:-1], steps[-1:]]), steps, np.interp(grid, length, t), grid, u
    )


def orientation_path(trajectory: Trajectory, goal: Array, config: FitConfig) -> Path | None:
    """The orientations' path to the unit quaternion `goal` (4,), or None when the demonstration stays at its goal."""
    q = continuous_signs(trajectory.T_frame_ee.q)
    # twice the chord between quaternions is the angle, near enough for a dead band
    kept = _moving(2.0 * q, config.still_fraction, config.min_rotation_rad)
    if kept is None:
        return None
    q, t = q[kept], trajectory.times[kept]
    length = _cumulative(np.linalg.norm(quat_log(quat_multiply(q[1:], quat_conjugate(q[:-1]))), axis=-1))
    grid = np.linspace(0.0, length[-1], config.samples)
    u = grid / length[-1]
    q = Slerp(length, Rotation.from_quat(q[:, [1, 2, 3, 0]]))(grid).as_quat()[:, [3, 0, 1, 2]]
    bend = quat_log(quat_multiply(goal, quat_conjugate(q[-1])))
    q = quat_multiply(quat_exp((u**2)[:, None] * bend), q)
    steps = quat_log(quat_multiply(q[1:], quat_conjugate(q[:-1])))
    points = quat_log(quat_multiply(q, quat_conjugate(goal)))
    return _path(
        points, np.concatenate([steps[:1], steps[1:] + steps[:-1], steps[-1:]]), steps, np.interp(grid, length, t), grid, u
    )


def evenly(x: Array, fraction: float, least: float, samples: int) -> tuple[Array, NDArray[np.intp]] | None:
    """Points (samples, d) evenly along the way x (n, d), and the sample of x before each; None if x stays in place."""
    kept = _moving(x, fraction, least)
    if kept is None:
        return None
    length = _cumulative(np.linalg.norm(np.diff(x[kept], axis=0), axis=-1))
    grid = np.linspace(0.0, length[-1], samples)
    points = np.stack([np.interp(grid, length, column) for column in x[kept].T], axis=1)
    return points, np.interp(grid, length, kept).astype(np.intp)


def _path(points: Array, tangents: Array, steps: Array, t: Array, grid: Array, u: Array) -> Path:
    norm = np.linalg.norm(tangents, axis=-1, keepdims=True)
    way = _cumulative(np.linalg.norm(steps, axis=-1))
    spacing = grid[1] - grid[0]
    return Path(
        points,
        np.where(norm > 1e-12, tangents / np.maximum(norm, 1e-12), 0.0),
        way[-1] - way,
        spacing / np.maximum(np.gradient(t), 1e-9),
        u,
    )


def _cumulative(steps: Array) -> Array:
    return np.concatenate([[0.0], np.cumsum(steps)])


def _moving(x: Array, fraction: float, least: float) -> list[int] | None:
    """Indices of the samples of x (n, d) that lie apart by a dead band: jitter while standing still adds no way."""
    from symskill_pddl.skills.kernels import moving

    extent = float(np.linalg.norm(x - x[-1], axis=-1).max())
    if extent < least:
        return None
    kept: list[int] = moving(np.array(x, order="C"), fraction * extent).tolist()
    last = len(x) - 1
    if kept[-1] != last:
        # what follows the last kept sample is within the band: the end replaces it, unless it is the start
        kept[-1:] = [last] if len(kept) > 1 else [0, last]
    return kept
