"""The settings of predicates and operators, and what they come to in metres for a hand of a given size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symskill_pddl.demos import Demo
from symskill_pddl.learning.articulation import ArticulationConfig
from symskill_pddl.learning.hints import AXES, Hints
from symskill_pddl.learning.references import ReferenceConfig
from symskill_pddl.learning.relations import PredicateConfig
from symskill_pddl.learning.shapes import ShapeConfig

USUAL_APERTURE_M = 0.08
"""Of a hand whose fingers are not recorded: that of most parallel grippers."""


@dataclass(frozen=True)
class RelationConfig:
    """When poses count as different, and how wide predicates are. Lengths are in A, the widest opening of the hand."""

    spread: float = 0.25
    """Standard deviation [A] of where people put things, as one demonstration leaves it; with n by 1/n of its square."""
    spread_deg: float = 8.0
    """As `spread`, for turning."""
    precise: float = 0.075
    """As `spread` [A], of what geometry guides: grasps, joints, heights above a support."""
    precise_deg: float = 4.0
    """As `precise`, for turning."""
    quantile: float = 0.99
    """Of the chi-square distribution with 3 degrees of freedom: what counts as the same relation."""
    leave_factor: float = 1.3
    """A predicate that holds is false beyond this many times its entering radii: noise at the rim does not toggle it."""
    gap: float = 1.5
    """Rests nearer than this [A] are one place; a hand's length from wrist to finger tips is about the same."""
    gap_deg: float = 18.0
    """As `gap`, of what is hinged: people open a door a little more or less."""
    ratio: float = 2.5
    """A gap between two places is at least this many times the gaps within one."""
    vertical: float = 4.0
    """Heights count more than places on a support: two shelves are two predicates, two spots on a counter are one."""
    near: float = 4.0
    """An object that nobody moved rests where others do within this [A] of them; also how near supports usually are."""
    odd_of: int = 3
    """What one demonstration alone shows, of a task with at least this many, is left out."""
    absent_from: int = 2
    """Least number of episodes that witness an absence before it becomes a precondition; one may be chance."""

    def scaled(self, aperture_m: float, hints: Hints | None = None) -> PredicateConfig:
        """In metres and radians, for a hand that opens this wide; with what `hints` say of joints, symmetry and references."""
        a, hints = aperture_m, hints or Hints()
        fine_m, fine_rad, rad = self.precise * a, np.radians(self.precise_deg), np.radians(self.spread_deg)
        shape = ShapeConfig(0.5 * fine_m, fine_rad / 6, self.spread * a, rad, fine_m, self.quantile, 1.5, self.leave_factor)
        return PredicateConfig(
            references=ReferenceConfig(gap_m=0.4 * a, side_gap_m=2.0 * a, near_m=self.near * a, hinted=hints.references),
            articulation=ArticulationConfig(
                max_off_axis_m=2.0 * fine_m,
                max_off_axis_rad=fine_rad,
                min_turn_rad=0.8 * np.radians(self.gap_deg),
                min_slide_m=0.4 * a,
                agree_rad=3.0 * fine_rad,
            ),
            free_shape=shape,
            joint_shape=replace(shape, prior_m=fine_m, prior_rad=0.5 * fine_rad),
            contact_shape=replace(shape, floor_m=fine_m, floor_rad=fine_rad, prior_m=fine_m, prior_rad=fine_rad),
            ratio=self.ratio,
            free_gap_m=self.gap * a,
            vertical_weight=self.vertical,
            tilt_m_rad=self.near * a,
            static_gap_m=self.near * self.gap * a,
            hinge_gap_rad=np.radians(self.gap_deg),
            slide_gap_m=0.5 * a,
            contact_gap_m=0.6 * a,
            contact_m_rad=self.gap * a,
            odd_of=self.odd_of,
            joints=hints.joints,
            symmetry={t: AXES[axis] for t, axis in hints.symmetry.items()},
        )


def aperture_of(demos: Sequence[Demo]) -> float:
    """A [m]: how wide the hand opens, over all recordings."""
    widest = max((float(np.quantile(d.aperture, 0.99)) for d in demos), default=0.0)
    return widest if widest > 0.0 else USUAL_APERTURE_M
