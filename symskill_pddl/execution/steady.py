"""Steadies poses that jitter. Estimates without noise pass as they are, bit for bit."""

from __future__ import annotations

from collections import deque
from dataclasses import replace

import numpy as np

from symskill_pddl.geometry import Array, Pose, quat_conjugate, quat_exp, quat_log, quat_multiply
from symskill_pddl.scene import Scene

_LEAST_M, _LEAST_RAD = 3e-4, 3e-3
"""Noise below this is left alone."""
_SIGMA = 1.0 / (np.sqrt(6.0) * 0.6745)
"""From the median size of second differences of readings, which even motion leaves out, to the readings' standard deviation."""
_WINDOW = 5
_MOVES = 3.0
"""An object moves when its last readings are, on average, so many of their mean's standard deviations off."""
_MOST = 10
"""Readings that an average goes back over, at most."""


class Steady:
    """Averages the poses of what stands still; what moves is seen as it is.

    How much readings jitter is the median over all objects, axes and the last readings: most things stand still most of the time.
    An object's pose is the average since it last moved.
    """

    def __init__(self, scene: Scene) -> None:
        n = len(scene.objects)
        self._last = scene.T_world_objects
        self._steps: deque[Array] = deque(maxlen=_WINDOW - 1)
        self._off: deque[Array] = deque(maxlen=3)
        self._kept, self._count = scene.T_world_objects, np.ones(n)

    def __call__(self, scene: Scene) -> Scene:
        """The scene as it is to be taken."""
        T = scene.T_world_objects
        self._steps.append(_between(self._last, T))
        self._last = T
        jitter = _median(np.abs(np.diff(self._steps, axis=0)).reshape(-1, 6)) * _SIGMA
        sd_p, sd_r = float(jitter[:3].mean()), float(jitter[3:].mean())
        if sd_p < _LEAST_M and sd_r < _LEAST_RAD:
            self._kept, self._count = T, np.ones(len(self._count))
            self._off.clear()
            return scene
        sd = np.repeat([max(sd_p, _LEAST_M), max(sd_r, _LEAST_RAD)], 3)
        off = _between(self._kept, T)
        self._off.append(off.copy())
        mean = np.mean(self._off, axis=0) * np.sqrt(len(self._off)) / sd
        moves = np.abs(mean).max(axis=1) > _MOVES
        for old in self._off:
            old[moves] = 0.0
        self._count = np.where(moves, 1.0, np.minimum(self._count + 1.0, _MOST))
        part = off / self._count[:, None]
        self._kept = Pose(self._kept.p + part[:, :3], quat_multiply(self._kept.q, quat_exp(part[:, 3:])))
        return replace(scene, T_world_objects=self._kept)


def _median(rows: Array) -> Array:
    """Of rows (n, 6), 0 of none; numpy's own takes five times as long, and this is on the path of every control tick."""
    ordered = np.sort(rows, axis=0)
    return np.asarray(0.5 * (ordered[(len(rows) - 1) // 2] + ordered[len(rows) // 2])) if len(rows) else np.zeros(6)


def _between(a: Pose, b: Pose) -> Array:
    """From poses (n,) to others: translations and rotation vectors (n, 6)."""
    return np.concatenate([b.p - a.p, quat_log(quat_multiply(quat_conjugate(a.q), b.q))], axis=1)
