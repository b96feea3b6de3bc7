"""Linear parameter-varying systems `v = sum_k gamma_k(e) A_k e` on the error e to a goal: what both fields are made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, frozen
from symskill_pddl.skills.config import FitConfig
from symskill_pddl.skills.mixture import Mixture, fit_mixture
from symskill_pddl.skills.stability import certify
from symskill_pddl.skills.trajectory import Path


@dataclass(frozen=True, eq=False)
class Lpv:
    """A mixture of K linear systems with one common equilibrium, e = 0.

    Attributes
    ----------
    mixture : Mixture
        Gives the weights gamma_k(e).
    matrices : (K, 3, 3)
        A_k [1/s].
    pace : (K,)
        Speed cap of each component; the cap at e is their weighted mean. It scales the velocity and never turns it.
    arrays : tuple of arrays
        All of it, as the compiled evaluation takes it.
    """

    mixture: Mixture
    matrices: Array
    pace: Array
    arrays: tuple[Array, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        K = self.mixture.size
        object.__setattr__(self, "matrices", frozen(self.matrices))
        object.__setattr__(self, "pace", frozen(self.pace))
        if self.matrices.shape != (K, 3, 3) or self.pace.shape != (K,):
            raise InputError(
                f"{K} components need matrices ({K}, 3, 3) and paces ({K},), got {self.matrices.shape}, {self.pace.shape}"
            )
        mixture = self.mixture
        arrays = (mixture.whitening, mixture.offset, mixture.log_scale, self.matrices, self.pace)
        # one memory layout, whatever a fit or a file gave: that is what is compiled
        object.__setattr__(self, "arrays", tuple(frozen(np.ascontiguousarray(a)) for a in arrays))

    def velocity(self, e: Array) -> Array:
        """Velocity (..., 3) at errors e (..., 3); zero exactly at e = 0."""
        from symskill_pddl.skills.kernels import velocities

        out: Array = velocities(np.array(e, order="C").reshape(-1, 3), self.arrays)
        return out.reshape(e.shape)

    @property
    def max_speed(self) -> float:
        """No velocity is larger."""
        return float(self.pace.max())


def attraction(gain_hz: float, pace: float) -> Lpv:
    """The plain pull to the goal, for demonstrations that show no path."""
    return Lpv(Mixture.single(), -gain_hz * np.eye(3)[None], np.array([pace]))


def fit_lpv(
    paths: Sequence[Path],
    config: FitConfig,
    *,
    least_pace: float,
    learn_metric: bool,
) -> tuple[Lpv, Array]:
    """Fit to demonstrated paths: the systems and their metric P (3, 3).

    Parameters
    ----------
    paths : sequence of Path
        May be empty: then there is only the pull to the goal.
    least_pace : float
        Smallest speed cap.
    learn_metric : bool
        Learn P, else P = I.

    Raises
    ------
    CertificateError
        If no stable field can be fitted.
    """
    if not paths:
        return attraction(config.gain_hz, least_pace), np.eye(3)
    from symskill_pddl.skills.convex import fit_matrices, fit_metric  # CVXPY is slow to import, and only fitting needs it

    x = np.concatenate([path.points for path in paths])
    extent = float(np.sqrt((x * x).sum(1).mean()))
    x = x / extent
    remaining = np.concatenate([path.remaining for path in paths])[:, None] / extent
    v = config.gain_hz * remaining * np.concatenate([path.directions for path in paths])
    # Residuals count relative to the speed, so that directions matter alike along the whole way except for the last bit.
    importance = 1.0 / np.maximum(remaining[:, 0], 0.1 * remaining.max()) ** 2
    importance /= importance.sum()
    progress = np.concatenate([path.progress for path in paths])
    speeds = np.concatenate([path.speeds for path in paths])
    P = fit_metric(*_slice_means(x, v, progress), config.max_condition) if learn_metric else np.eye(3)

    beside_x, beside_v = _beside(x, v, remaining, config)
    all_x, all_v = np.concatenate([x, beside_x]), np.concatenate([v, beside_v])
    all_importance = np.concatenate([importance, np.tile(0.25 * config.funnel * importance, 4)])
    mixture = fit_mixture(x, progress, config.components, config.spread)
    matrices = fit_matrices(
        all_x,
        all_v,
        mixture.weights(all_x),
        all_importance,
        P,
        gain_hz=config.gain_hz,
        rate_hz=config.rate_hz,
        period_s=config.period_s,
        ridge=config.ridge,
    )
    certify(matrices, P).demand(config.rate_hz, config.period_s)
    return Lpv(_rescaled(mixture, extent), matrices, _paces(mixture.weights(x), speeds, config.pace, least_pace)), P


def _beside(x: Array, v: Array, remaining: Array, config: FitConfig) -> tuple[Array, Array]:
    """Four points beside each sample (4n, 3), and velocities there along the path and back to it: a funnel."""
    speed = np.maximum(np.linalg.norm(v, axis=1, keepdims=True), 1e-12)
    t = v / speed
    least = np.eye(3)[np.abs(t).argmin(1)]
    a = np.cross(t, least)
    a /= np.maximum(np.linalg.norm(a, axis=1, keepdims=True), 1e-12)
    b = np.cross(t, a)
    offsets = np.concatenate([side * 0.3 * remaining for side in (a, -a, b, -b)])
    return np.tile(x, (4, 1)) + offsets, np.tile(v, (4, 1)) - config.funnel_gain * config.gain_hz * offsets


def _slice_means(x: Array, v: Array, progress: Array, count: int = 16) -> tuple[Array, Array]:
    """Unit mean positions and velocities of slices of the path."""
    index = np.minimum((progress * count).astype(int), count - 1)
    member = np.eye(count)[index].T  # (count, n)
    member = member[member.sum(1) > 0]
    xs, vs = member @ x, member @ v
    xs /= np.maximum(np.linalg.norm(xs, axis=1, keepdims=True), 1e-12)
    vs /= np.maximum(np.linalg.norm(vs, axis=1, keepdims=True), 1e-12)
    return xs, vs


def _paces(weights: Array, speeds: Array, factor: float, least: float) -> Array:
    """Median speed of each component's samples times the factor, and no less than half the overall median."""
    overall = float(np.median(speeds))
    owner = weights.argmax(1)
    medians = [np.median(speeds[owner == k]) if np.any(owner == k) else overall for k in range(weights.shape[1])]
    return np.maximum(factor * np.maximum(medians, 0.5 * overall), least)


def _rescaled(mixture: Mixture, extent: float) -> Mixture:
    """The mixture of the data divided by `extent`, for the data itself. The common change of log det drops out of the weights."""
    return Mixture(mixture.whitening / extent, mixture.offset, mixture.log_scale)
