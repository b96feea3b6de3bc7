"""`Field`: a certified twist field over SE(3), in one frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import sqrt

import numpy as np

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, Pose, karcher_mean
from symskill_pddl.skills.config import FitConfig
from symskill_pddl.skills.orientation import OrientationField, fit_orientation
from symskill_pddl.skills.pairing import Pairing, fit_pairing
from symskill_pddl.skills.position import PositionField, fit_position
from symskill_pddl.skills.stability import Certificate
from symskill_pddl.skills.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Field:
    """A position field and an orientation field with their certificates.

    Attributes
    ----------
    position, orientation
        The two fields.
    certificates : (Certificate, Certificate)
        Of the position and of the orientation field.
    pairing : Pairing
        Keeps the two in step.
    """

    position: PositionField
    orientation: OrientationField
    certificates: tuple[Certificate, Certificate]
    pairing: Pairing

    def twist(self, T_frame_ee: Pose) -> Array:
        """Twist (..., 6) at poses (...): linear [m/s], angular [rad/s], in the axes of the field's frame."""
        return self.twist_at(T_frame_ee.p, T_frame_ee.q)

    def twist_at(self, p: Array, q: Array) -> Array:
        """The same for positions (..., 3) and unit quaternions (..., 4)."""
        e_p, e_q = p - self.position.goal, self.orientation.error(q)
        v, omega = self.position.lpv.velocity(e_p), self.orientation.lpv.velocity(e_q)
        P = self.certificates[0].P
        if p.ndim == 1:
            s_v, s_omega = self.pairing.factors_at(sqrt(e_p @ P @ e_p), sqrt(e_q @ e_q))
            return np.concatenate((s_v * v, s_omega * omega))
        s_p, s_q = self.pairing.factors(np.sqrt((e_p @ P * e_p).sum(-1)), np.sqrt((e_q * e_q).sum(-1)))
        return np.concatenate((s_p[..., None] * v, s_q[..., None] * omega), axis=-1)

    @cached_property
    def T_goal(self) -> Pose:
        """The attractor, in the field's frame."""
        return Pose(self.position.goal, self.orientation.goal)

    @property
    def certificate(self) -> Certificate:
        """The weaker of the two certificates."""
        return min(self.certificates, key=lambda c: c.rate_hz)


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
    position, of_position = fit_position(trajectories, goal_p, config)
    orientation, of_orientation = fit_orientation(trajectories, goal_q, config)
    errors = [(t.T_frame_ee.p - goal_p, orientation.error(t.T_frame_ee.q)) for t in trajectories]
    pairing = Pairing.none()
    # who turns in place is not in step with a position: what wanders a little, and does not move on in a grip that holds it
    if max(float(np.linalg.norm(e_p, axis=-1).max()) for e_p, _ in errors) > config.tolerance_m:
        pairing = fit_pairing(
            [np.sqrt((e_p @ of_position.P * e_p).sum(-1)) for e_p, _ in errors],
            [np.linalg.norm(np.atleast_2d(e_q), axis=-1) for _, e_q in errors],
        )
    return Field(position, orientation, (of_position, of_orientation), pairing)
