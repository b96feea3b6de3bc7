"""Which way is up in a recording: what is carried is lifted, and hands come from above."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symskill_pddl.demos.demo import Demo
from symskill_pddl.geometry import Array

AXES = {"+x": (1, 0, 0), "-x": (-1, 0, 0), "+y": (0, 1, 0), "-y": (0, -1, 0), "+z": (0, 0, 1), "-z": (0, 0, -1)}
_LEAST_M = 0.01
"""What rises less than this between two rests was not lifted."""
_SETTLED_S = 0.5
"""What moves before is not moved by the hand."""
_APPROACH = 0.5
"""Weight of where the hand points, against 1 for what is lifted: hands reach forwards into cabinets."""


@dataclass(frozen=True)
class Up:
    """The axis of the world frame that points up, ``+z``, and by how much it leads over the next one (0 to 1)."""

    axis: str
    lead: float

    @property
    def vector(self) -> Array:
        """Unit vector (3,)."""
        return np.array(AXES[self.axis], dtype=np.float64)


def up_axis(demos: Sequence[Demo]) -> Up | None:
    """The axis that points up, among the six of the world frame; None if nothing tells.

    Parameters
    ----------
    demos : sequence of Demo
        All in one world frame.
    """
    directions = np.array(list(AXES.values()), dtype=np.float64)
    lifts, points, closing = np.zeros(6), np.zeros(6), 0
    for demo in demos:
        for obj in demo.objects:
            # things fall into place at first; what the hand holds at last has no second rest
            seen = demo.sees(obj) & (demo.times >= demo.times[0] + _SETTLED_S)
            if not seen.any():
                continue
            height = demo.pose(obj).p[seen] @ directions.T
            rests = height[:1] if demo.gripper_closed[-1] else height[[0, -1]]
            # a single pose that is far off is no way
            rise = np.quantile(height, 0.98, axis=0) - rests.max(axis=0)
            lifts += np.where(rise > _LEAST_M, rise, 0.0)
        grips = np.flatnonzero(np.diff(demo.gripper_closed.astype(int)) > 0)
        z = demo.T_world_ee[grips].rotate(np.array([0.0, 0.0, 1.0])) if len(grips) else np.zeros((0, 3))
        points -= (z @ directions.T).sum(axis=0)
        closing += len(grips)
    # what rises on both sides of an axis was carried to and fro along it
    swing = lifts - lifts[[1, 0, 3, 2, 5, 4]]
    score = swing / max(float(lifts.max()), 1e-12) + _APPROACH * points / max(closing, 1)
    if not closing and not lifts.any():
        return None
    best, second = np.argsort(-score, kind="stable")[:2]
    lead = float(np.clip((score[best] - score[second]) / (1.0 + _APPROACH), 0.0, 1.0))
    return Up(list(AXES)[int(best)], lead)
