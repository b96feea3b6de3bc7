"""`Pairing`: keeps turning and moving in step, as demonstrated, by slowing down whichever is ahead."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, frozen

_KNOTS = 33
_LEAD_WIDTH_RAD = 0.06
"""A rotation this far ahead of the position waits."""
_LAG_SLACK_RAD, _LAG_WIDTH_RAD = 0.05, 0.15
"""A position waits for a rotation that is behind by more than the first; fully at the sum of both."""
_LEAST = 0.25
"""The position never waits altogether: a hand that cannot turn still arrives. (A rotation can: the position always moves on.)"""


@dataclass(frozen=True, eq=False)
class Pairing:
    """The demonstrated angle to the goal at each distance to the goal.

    Both factors it yields only scale a velocity, so they keep every property of the fields but the time taken.

    Attributes
    ----------
    reach : float
        Distance in the metric P at the last knot.
    angles : (m,)
        Angle [rad] at evenly spaced distances from 0 to `reach`; does not fall.
    """

    reach: float
    angles: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "angles", frozen(self.angles))
        if not (self.reach > 0 and self.angles.ndim == 1 and len(self.angles) >= 2 and np.all(np.diff(self.angles) >= 0)):
            raise InputError("a pairing needs a positive reach and at least two angles that do not fall")

    @classmethod
    def none(cls) -> Pairing:
        """For demonstrations without a path: the position waits for large rotations, no rotation waits."""
        return cls(1.0, np.zeros(2))

    def factors(self, distance: Array, angle: Array) -> tuple[Array, Array]:
        """Speed factors (...) of position and rotation at distances (...) and angles (...) to the goal."""
        ahead = np.interp(distance, np.linspace(0.0, self.reach, len(self.angles)), self.angles) - angle
        position = np.clip(1.0 + (ahead + _LAG_SLACK_RAD) / _LAG_WIDTH_RAD, _LEAST, 1.0)
        return position, np.clip(1.0 - ahead / _LEAD_WIDTH_RAD, 0.0, 1.0)

    def factors_at(self, distance: float, angle: float) -> tuple[float, float]:
        """The same for one pose, on plain floats."""
        last = len(self.angles) - 1
        at = min(distance / self.reach, 1.0) * last
        i = min(int(at), last - 1)
        low, high = self.angles[i].item(), self.angles[i + 1].item()
        ahead = low + (at - i) * (high - low) - angle
        position = min(max(1.0 + (ahead + _LAG_SLACK_RAD) / _LAG_WIDTH_RAD, _LEAST), 1.0)
        return position, min(max(1.0 - ahead / _LEAD_WIDTH_RAD, 0.0), 1.0)


def fit_pairing(distances: Sequence[Array], angles: Sequence[Array]) -> Pairing:
    """From each demonstration's distances (n,) and angles (n,) to the goal, sample by sample."""
    reach = max((float(d.max()) for d in distances), default=0.0)
    if reach <= 0.0:
        return Pairing.none()
    knots = np.linspace(0.0, reach, _KNOTS)
    table = np.full((len(distances), _KNOTS), np.nan)
    for row, d, a in zip(table, distances, angles, strict=True):
        if d.max() <= 0.0:
            continue
        # going back from the end: the last time the demonstration was this near counts
        nearest = np.maximum.accumulate(d[::-1])
        first = np.concatenate([[True], np.diff(nearest) > 1e-12 * reach])
        row[:] = np.interp(knots, nearest[first], (a[::-1] - a[-1])[first], right=np.nan)
    counts = np.isfinite(table).sum(0)
    mean = np.nansum(table, axis=0) / np.maximum(counts, 1)
    mean[counts == 0] = mean[counts > 0][-1] if np.any(counts > 0) else 0.0
    mean[0] = 0.0
    return Pairing(reach, np.maximum.accumulate(np.maximum(mean, 0.0)))
