"""`PositionField`: where the hand goes. LPV-DS with a learned metric (paper, "Learning Stable SE(3) Policy")."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from symskill_pddl.geometry import Array, frozen
from symskill_pddl.skills.config import FitConfig
from symskill_pddl.skills.lpv import Lpv, fit_lpv
from symskill_pddl.skills.trajectory import Trajectory, position_path


@dataclass(frozen=True, eq=False)
class PositionField:
    """`v = sum_k gamma_k(x) A_k (x - x*)`, scaled down to the speed cap.

    Attributes
    ----------
    lpv : Lpv
        The mixture, on the error x - x* [m].
    goal : (3,)
        The attractor x* [m].
    """

    lpv: Lpv
    goal: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "goal", frozen(self.goal))

    def velocity(self, x: ArrayLike) -> Array:
        """Velocity (..., 3) [m/s] at positions x (..., 3) [m], in the axes of the field's frame."""
        return self.lpv.velocity(np.asarray(x, dtype=np.float64) - self.goal)

    @property
    def max_speed(self) -> float:
        """Largest speed [m/s] anywhere."""
        return self.lpv.max_speed


def fit_position(trajectories: Sequence[Trajectory], goal: Array, config: FitConfig) -> tuple[PositionField, Array]:
    """Fit to smoothed trajectories that end near `goal` (3,): the field and its metric P (3, 3).

    Raises
    ------
    CertificateError
        If no stable field can be fitted.
    """
    paths = [path for t in trajectories if (path := position_path(t, goal, config)) is not None]
    lpv, P = fit_lpv(paths, config, least_pace=config.min_speed_m_s, learn_metric=True)
    return PositionField(lpv, goal), P
