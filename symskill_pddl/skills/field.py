"""`Field`: a certified twist field over SE(3), in one frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, Pose, frozen, karcher_mean
from symskill_pddl.skills.config import FitConfig
from symskill_pddl.skills.orientation import OrientationField, fit_orientation
from symskill_pddl.skills.pairing import SLOWEST, WIDTHS, Pairing, fit_pairing
from symskill_pddl.skills.position import PositionField, fit_position
from symskill_pddl.skills.stability import Certificate, certify
from symskill_pddl.skills.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Field:
    """A position field and an orientation field, kept in step; certified from its own numbers whenever one is made.

    Attributes
    ----------
    position, orientation
        The two fields.
    P : (3, 3)
        Metric in which the position's distance to its goal falls; the orientation's is the angle.
    pairing : Pairing
        Keeps the two in step.
    certificates : (Certificate, Certificate)
        Of position and orientation as they run, slowed down by the pairing.

    Raises
    ------
    CertificateError
        If the field is not stable; the message names the condition that fails and by how much.
    arrays : tuple
        All of it, as the compiled evaluation takes it.
    """

    position: PositionField
    orientation: OrientationField
    P: Array
    pairing: Pairing
    certificates: tuple[Certificate, Certificate] = field(init=False, repr=False)
    arrays: tuple[Any, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        p, q, pairing = self.position, self.orientation, self.pairing
        curve = (pairing.reach, pairing.turn, pairing.difference)
        object.__setattr__(self, "P", frozen(np.ascontiguousarray(self.P)))
        of_position, of_orientation = certify(p.lpv.matrices, self.P, SLOWEST[0]), certify(q.lpv.matrices, np.eye(3), SLOWEST[1])
        object.__setattr__(self, "certificates", (of_position, of_orientation))
        parts = (p.lpv.arrays, p.goal, self.P, q.lpv.arrays, q.goal, curve, WIDTHS)
        object.__setattr__(self, "arrays", parts)

    def twist(self, T_frame_ee: Pose) -> Array:
        """Twist (..., 6) at poses (...): linear [m/s], angular [rad/s], in the axes of the field's frame."""
        return self.twist_at(T_frame_ee.p, T_frame_ee.q)

    def twist_at(self, p: Array, q: Array) -> Array:
        """The same for positions (..., 3) and unit quaternions (..., 4)."""
        from symskill_pddl.skills.kernels import twists

        # copies: one memory layout, compiled once
        out: Array = twists(np.array(p, order="C").reshape(-1, 3), np.array(q, order="C").reshape(-1, 4), *self.arrays)
        return out.reshape(*p.shape[:-1], 6)

    @cached_property
    def T_goal(self) -> Pose:
        """The attractor, in the field's frame."""
        return Pose(self.position.goal, self.orientation.goal)

    @property
    def max_period_s(self) -> float:
        """Control periods below this [s] are certified for both fields."""
        return min(c.max_period_s for c in self.certificates)


def fit_field(trajectories: Sequence[Trajectory], config: FitConfig) -> Field:
    """One field to the mean of the (smoothed) trajectories' end poses.

    Raises
    ------
    InputError
        If there are no trajectories.
    CertificateError
        If no stable field can be fitted.
    """
    if not trajectories:
        raise InputError("fitting a field needs at least one trajectory")
    goal_p = np.mean([t.end.p for t in trajectories], axis=0)
    goal_q = karcher_mean(np.stack([t.end.q for t in trajectories]))
    position, P = fit_position(trajectories, goal_p, config)
    orientation = fit_orientation(trajectories, goal_q, config)
    errors = [(t.T_frame_ee.p - goal_p, orientation.error(t.T_frame_ee.q)) for t in trajectories]
    pairing = Pairing.none()
    # who turns in place is not in step with a position: what wanders a little, and does not move on in a grip that holds it
    if max(float(np.linalg.norm(e_p, axis=-1).max()) for e_p, _ in errors) > config.in_place_m:
        pairing = fit_pairing(errors, P)
    return Field(position, orientation, P, pairing)
