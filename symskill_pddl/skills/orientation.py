"""`OrientationField`: how the hand turns. Linear systems on the rotation error (paper, "Learning Stable SE(3) Policy")."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, frozen
from symskill_pddl.skills.config import FitConfig
from symskill_pddl.skills.lpv import Lpv, fit_lpv
from symskill_pddl.skills.trajectory import Trajectory, orientation_path


@dataclass(frozen=True, eq=False)
class OrientationField:
    """`omega = sum_k gamma_k(e) B_k e` with `e = log(q q*^-1)`, scaled down to the speed cap.

    The sign of q q*^-1 is folded, so q and -q give the same velocity. The Lyapunov function is |e|^2: in the plain metric its
    rate is 2 e . omega, exactly, however large the angle is; in any other it is not. One Euler step on the rotation group
    leaves the angle no larger than the same step in the tangent space would, because the group is curved positively.

    Attributes
    ----------
    lpv : Lpv
        The mixture, on the error e [rad].
    goal : (4,)
        The attractor q*, a unit quaternion (w, x, y, z).
    """

    lpv: Lpv
    goal: Array

    def __post_init__(self) -> None:
        goal = frozen(self.goal)
        if goal.shape != (4,) or not np.isclose(np.linalg.norm(goal), 1.0, atol=1e-9):
            raise InputError(f"an orientation field's goal has to be a unit quaternion (4,), got {np.asarray(self.goal)!r}")
        object.__setattr__(self, "goal", goal)

    def error(self, q: ArrayLike) -> Array:
        """Rotation vector (..., 3) [rad] from the goal to q (..., 4), in the axes of the field's frame."""
        from symskill_pddl.skills.kernels import rotation_errors

        q = np.array(q, dtype=np.float64, order="C")
        out: Array = rotation_errors(q.reshape(-1, 4), self.goal)
        return out.reshape(*q.shape[:-1], 3)

    def angular_velocity(self, q: ArrayLike) -> Array:
        """Angular velocity (..., 3) [rad/s] at unit quaternions q (..., 4), in the axes of the field's frame."""
        return self.lpv.velocity(self.error(q))

    @property
    def max_speed(self) -> float:
        """Largest angular speed [rad/s] anywhere."""
        return self.lpv.max_speed


def fit_orientation(trajectories: Sequence[Trajectory], goal: Array, config: FitConfig) -> OrientationField:
    """Fit to smoothed trajectories that end near the unit quaternion `goal` (4,). P = I.

    Raises
    ------
    CertificateError
        If no stable field can be fitted.
    """
    paths = [path for t in trajectories if (path := orientation_path(t, goal, config)) is not None]
    lpv, _ = fit_lpv(paths, config, least_pace=config.min_speed_rad_s, learn_metric=False)
    return OrientationField(lpv, goal)
