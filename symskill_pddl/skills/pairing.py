"""`Pairing`: keeps turning and moving in step, as demonstrated, by slowing down whichever is ahead."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, frozen

_KNOTS = 65
_LEAD_WIDTH_RAD = 0.03
"""A rotation this far ahead of the position waits."""
_LAG_WIDTH_RAD = 0.06
"""A position slows down for a rotation that is behind, the most from this angle on."""
SLOWEST = (0.25, 0.1)
"""Neither position nor rotation waits altogether: both keep this fraction of their certified rate."""
WIDTHS = (_LEAD_WIDTH_RAD, _LAG_WIDTH_RAD, *SLOWEST)


@dataclass(frozen=True, eq=False)
class Pairing:
    """The demonstrated curve of distance and angle to the goal, d and a, both as fractions of their largest.

    It is kept as d - a over d + a. Both fall along a demonstration, so the sum falls strictly and the difference is a function
    of it, also where the hand turns without moving or moves without turning. A pose off the curve has a rotation that is ahead
    (d - a larger than shown) or behind. Both factors made from that only scale a velocity, by no less than `SLOWEST`: a field
    keeps its goal, its step and that fraction of its rate.

    Attributes
    ----------
    reach : float
        Largest distance, in the metric P.
    turn : float
        Largest angle [rad].
    difference : (m,)
        d - a at even steps of d + a from 0 to 2.
    """

    reach: float
    turn: float
    difference: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "difference", frozen(self.difference))
        m = self.difference.shape
        if not (self.reach > 0 and self.turn > 0 and len(m) == 1 and m[0] >= 2 and np.all(np.abs(self.difference) <= 2.0)):
            raise InputError("a pairing needs a positive reach and turn, and at least two differences within -2 and 2")

    @classmethod
    def none(cls) -> Pairing:
        """For demonstrations without a path: no rotation waits, and the position waits for large rotations."""
        return cls(1e9, np.pi, np.zeros(2))

    def factors(self, distance: float, angle: float) -> tuple[float, float]:
        """Speed factors of position and rotation at a distance (in the metric) and an angle [rad] to the goal."""
        from symskill_pddl.skills.kernels import lead

        ahead = lead(distance, angle, self.reach, self.turn, self.difference)
        position, rotation = 1.0 + ahead / _LAG_WIDTH_RAD, 1.0 - ahead / _LEAD_WIDTH_RAD
        return min(max(position, SLOWEST[0]), 1.0), min(max(rotation, SLOWEST[1]), 1.0)


def fit_pairing(ways: Sequence[tuple[Array, Array]], P: Array) -> Pairing:
    """From each demonstration's errors (n, 3), (n, 3) of position and rotation to the goal; they need not end in 0."""
    pairs = [(_to_goal(e_p), _to_goal(e_q)) for e_p, e_q in ways]
    curves = [(np.sqrt(np.maximum((x * (x @ P)).sum(-1), 0.0)), np.linalg.norm(r, axis=-1)) for x, r in pairs]
    reach, turn = (max((float(curve[i].max()) for curve in curves), default=0.0) for i in (0, 1))
    if reach <= 0.0 or turn <= 0.0:
        return Pairing.none()
    knots = np.linspace(0.0, 2.0, _KNOTS)
    table = np.full((len(curves), _KNOTS), np.nan)
    for row, (d, a) in zip(table, curves, strict=True):
        # going back from the end: the last time the demonstration was this near counts
        d, a = (np.maximum.accumulate(values[::-1]) / size for values, size in ((d, reach), (a, turn)))
        first = np.concatenate([[True], np.diff(d + a) > 1e-12])
        row[:] = np.interp(knots, (d + a)[first], (d - a)[first], right=np.nan)
    counts = np.isfinite(table).sum(0)
    known = counts > 0
    mean = np.nansum(table, axis=0) / np.maximum(counts, 1)
    return Pairing(reach, turn, np.interp(knots, knots[known], mean[known]))


def _to_goal(e: Array) -> Array:
    """Errors (n, 3), bent smoothly so that they end in 0."""
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(e, axis=0), axis=-1))])
    return np.asarray(e - (way / max(float(way[-1]), 1e-12))[:, None] ** 2 * e[-1])
