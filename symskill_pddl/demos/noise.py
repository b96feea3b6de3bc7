"""How much an object's measured poses jitter, and where its tracker stood still without saying so."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from symskill_pddl.demos.demo import BoolArray, Demo
from symskill_pddl.geometry import Array, quat_conjugate, quat_log, quat_multiply

_SIGMA = 1.0 / (np.sqrt(6.0) * 0.6745)
"""From the median size of second differences, which even motion leaves out, to a standard deviation."""
_EVEN = 1.5
"""Second differences are taken over neighbours whose distances in time differ by less than this factor."""
_FEWEST = 20
"""Different poses without which nothing is said of a tracker's noise."""
_LEAST = 1e-5
"""Noise below this [m, rad] is a simulator's or a number format's, not a tracker's."""
_WHITE = -0.25
"""Correlation of successive steps below which they are noise: -0.5 if errors are independent, 1 in even motion."""
_WINDOW = 8
"""Steps within which they are compared: few, so that something rests meanwhile."""
_OUTLIER = 3.0
"""Steps longer than this many median ones are cut to that length."""
_LONGER = 2
"""A tracker stands still where a pose is repeated this many times more often than 95 % of its poses are."""


@dataclass(frozen=True)
class Jitter:
    """Standard deviation per axis of an object's position [m] and orientation [rad] from sample to sample."""

    p_m: float
    r_rad: float


def jitter(demo: Demo, frame: str) -> Jitter:
    """The jitter of an object's seen poses, or of the end effector's under the name 'gripper'; 0 for fewer than three samples."""
    rows = np.flatnonzero(demo.sees(frame))
    if len(rows) < 3:
        return Jitter(0.0, 0.0)
    T, dt = demo.pose(frame)[rows], np.diff(demo.times[rows])
    bend = np.diff(_steps(T.p, T.q), axis=0)
    even = np.maximum(dt[1:], dt[:-1]) < _EVEN * np.minimum(dt[1:], dt[:-1])
    if not even.any():
        return Jitter(0.0, 0.0)
    sigma = _SIGMA * np.median(np.abs(bend[even]), axis=0)
    return Jitter(float(np.sqrt(np.mean(sigma[:3] ** 2))), float(np.sqrt(np.mean(sigma[3:] ** 2))))


def freezes(demo: Demo, obj: str) -> BoolArray:
    """The samples (n,) at which a jittering object's pose is, bit by bit, an earlier one: nobody saw it.

    An object without jitter of its own, as in a simulator, rests; nothing is said of it. A tracker that is slower than the
    recording, or rounds, repeats its poses all the time: what is repeated markedly more often is meant here.
    """
    found = np.zeros(len(demo), bool)
    rows = np.flatnonzero(demo.sees(obj))
    T = demo.pose(obj)[rows]
    new = np.concatenate([[True], (np.diff(T.vector(), axis=0) != 0).any(axis=1)])
    starts = np.flatnonzero(new)
    if len(starts) < _FEWEST or not _jitters(_steps(T.p[starts], T.q[starts])):
        return found
    lengths = np.diff(np.append(starts, len(rows)))
    long = lengths > _LONGER * np.quantile(lengths, 0.95)
    if lengths[long].sum() > 0.5 * len(rows):
        return found
    found[rows[np.repeat(long, lengths) & ~new]] = True
    return found


def without_freezes(demo: Demo) -> Demo:
    """The demonstration with frozen poses unseen. Nothing is lost: the last seen pose is the frozen one."""
    found = [freezes(demo, obj) for obj in demo.objects]
    if not any(f.any() for f in found):
        return demo
    return replace(demo, seen=demo.seen & ~np.stack(found, axis=1))


def _steps(p: Array, q: Array) -> Array:
    """From pose to pose: translations and rotation vectors (n - 1, 6), in world axes."""
    return np.concatenate([np.diff(p, axis=0), quat_log(quat_multiply(q[1:], quat_conjugate(q[:-1])))], axis=1)


def _jitters(steps: Array) -> bool:
    """Whether steps (n, 6) go to and fro, in position or in orientation, where they lead nowhere."""
    for part in (steps[:, :3], steps[:, 3:]):
        # a tracker that errs for one sample goes to and fro as well
        length = np.linalg.norm(part, axis=1, keepdims=True)
        part = part * np.minimum(1.0, _OUTLIER * np.median(length) / np.maximum(length, 1e-12))
        # in windows of some steps; those of the half that leads less far
        far = np.linalg.norm(_sums(part), axis=1)
        size, turned = _sums((part**2).sum(axis=1)), _sums((part[1:] * part[:-1]).sum(axis=1))
        still = far[:-1] <= np.median(far)
        energy = float(size[:-1][still].sum())
        if energy > _WINDOW * int(still.sum()) * 3 * _LEAST**2 and float(turned[still].sum()) < _WHITE * energy:
            return True
    return False


def _sums(rows: Array) -> Array:
    """Of every `_WINDOW` successive rows."""
    return np.asarray(np.lib.stride_tricks.sliding_window_view(rows, _WINDOW, axis=0).sum(axis=-1))
