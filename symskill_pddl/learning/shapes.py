"""Sets of relative poses: how they fall into clusters, and the pair of Gaussians around one of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.hierarchy import cophenet, fcluster, linkage
from scipy.spatial.distance import squareform
from scipy.stats import chi2

from symskill_pddl.abstraction import Classifier, swing
from symskill_pddl.geometry import Array, Pose, karcher_mean, quat_conjugate, quat_log, quat_multiply
from symskill_pddl.symbols import Predicate


@dataclass(frozen=True)
class ShapeConfig:
    """Floors and thresholds of the Gaussians.

    The standard deviation added to each axis is ``sqrt(floor^2 + prior^2 / n)`` for n independent observations: the floor is what
    sensors and the spread within an observation amount to, the prior is what one would allow after a single demonstration.
    """

    floor_m: float = 0.003
    """Standard deviation that sensors have, however many demonstrations there are."""
    floor_rad: float = float(np.radians(0.7))
    """As `floor_m`, for turning."""
    prior_m: float = 0.02
    """Standard deviation of what people do, as one demonstration leaves it; with n it counts by 1/n of its square."""
    prior_rad: float = float(np.radians(8.0))
    """As `prior_m`, for turning."""
    prior_up_m: float = 0.005
    """In place of `prior_m` along the vertical, where one is given: what rests on something rests at its height."""
    quantile: float = 0.99
    """Of the chi-square distribution with 3 degrees of freedom: the entering radius, times ``1 + 1/n``."""
    stretch: float = 1.5
    """The radius grows up to this factor to take in the observations it is made from."""
    leave_factor: float = 1.3
    """A predicate that holds is false beyond this many times its entering radii: noise at the rim does not toggle it."""
    free_rad: float = float(np.radians(35.0))
    """A turn about the vertical that spreads more than this (standard deviation) does not count."""


@dataclass(frozen=True, eq=False)
class Shape:
    """The geometry of a predicate that has no name yet."""

    T_mean: Pose
    cov_p: Array
    cov_r: Array
    enter_p: float
    enter_r: float
    leave_factor: float
    free_axis: Array | None = None
    least_p: float = 0.0
    least_r: float = 0.0
    """Radii that just take in the observations."""

    def classifier(
        self,
        predicate: Predicate,
        child: str,
        parent: str,
        fingers: tuple[float, float] | None = None,
        precedence: float = 0.0,
    ) -> Classifier:
        return Classifier(
            predicate,
            child,
            parent,
            self.T_mean,
            self.cov_p,
            self.cov_r,
            self.enter_p,
            self.enter_r,
            self.leave_factor,
            self.free_axis,
            fingers,
            precedence,
        )


def fit_shape(
    poses: Pose, n: int, config: ShapeConfig, free_axis: Array | None = None, up_in_parent: Array | None = None
) -> Shape:
    """Two independent Gaussians over poses (m,), which stem from `n` independent observations.

    Rotation residuals are taken in the tangent space at the Karcher mean; the turn about `free_axis` (child's frame) is left out.
    """
    q = poses.q
    if free_axis is not None:
        q = quat_multiply(q[:1], swing(quat_multiply(quat_conjugate(q[:1]), q), free_axis))
    mean = Pose(poses.p.mean(axis=0), karcher_mean(q))
    relative = quat_multiply(quat_conjugate(mean.q), q)
    dp = poses.p - mean.p
    dr = quat_log(relative if free_axis is None else swing(relative, free_axis))
    cov_p = dp.T @ dp / len(dp) * (n / max(n - 1, 1)) + np.eye(3) * (config.floor_m**2 + config.prior_m**2 / n)
    if up_in_parent is not None:
        cov_p += np.outer(up_in_parent, up_in_parent) * (config.prior_up_m**2 - config.prior_m**2) / n
    cov_r = dr.T @ dr / len(dr) * (n / max(n - 1, 1)) + np.eye(3) * (config.floor_rad**2 + config.prior_rad**2 / n)
    radius = float(np.sqrt(chi2.ppf(config.quantile, 3))) * (1.0 + 1.0 / n)
    least_p, least_r = 1.05 * float(_radii(dp, cov_p).max()), 1.05 * float(_radii(dr, cov_r).max())
    enter_p, enter_r = (float(np.clip(least, radius, config.stretch * radius)) for least in (least_p, least_r))
    return Shape(mean, cov_p, cov_r, enter_p, enter_r, config.leave_factor, free_axis, least_p, least_r)


def _radii(residuals: Array, cov: Array) -> Array:
    """Mahalanobis radii (n,) of residuals (n, 3)."""
    return np.asarray(np.sqrt(np.einsum("ni,ij,nj->n", residuals, np.linalg.inv(cov), residuals)))


def narrowed(shape: Shape, T_outside: Pose, share: float = 0.75, least: float = 2.8) -> Shape:
    """The shape with one radius lowered so that a pose lies outside: the position's or the rotation's, where it differs more.

    The radius becomes `share` times the pose's, but not less than what takes in the shape's own observations, nor than `least`
    (95 % of the Gaussian): two ways to hold a thing in the same place may overlap, it is better than to miss either.
    """
    relative = quat_multiply(quat_conjugate(shape.T_mean.q), T_outside.q)
    p = float(_radii((T_outside.p - shape.T_mean.p)[None], shape.cov_p)[0])
    r = float(_radii(quat_log(relative)[None], shape.cov_r)[0])
    if p / shape.enter_p >= r / shape.enter_r:
        return replace(shape, enter_p=min(shape.enter_p, max(share * p, shape.least_p, least)))
    return replace(shape, enter_r=min(shape.enter_r, max(share * r, shape.least_r, least)))


def lifted(shape: Shape, up_in_parent: Array, rise_m: float, aside_m: float) -> Shape:
    """The shape of what has been lifted by `rise_m`: from half as high to half as high again, and at most `aside_m` aside."""
    across = np.eye(3) - np.outer(up_in_parent, up_in_parent)
    cov_p = (aside_m**2 * across + max(0.5 * rise_m, 0.001) ** 2 * np.outer(up_in_parent, up_in_parent)) / shape.enter_p**2
    return replace(shape, cov_p=cov_p)


def free_yaw(poses: Pose, up_in_child: Array, config: ShapeConfig) -> Array | None:
    """The child's vertical axis if its turn about it looks arbitrary: it spreads widely, or there are too few (< 3) to tell."""
    if len(poses) < 3:
        return up_in_child
    relative = quat_multiply(quat_conjugate(poses.q[:1]), poses.q)
    angle = 2.0 * np.arctan2(relative[:, 1:] @ up_in_child, relative[:, 0])
    length = float(np.abs(np.mean(np.exp(1j * angle))))
    spread = np.sqrt(-2.0 * np.log(np.clip(length, 1e-12, 1.0)))  # circular standard deviation
    return up_in_child if spread > config.free_rad else None


def clusters(
    distances: Array, min_gap: float, ratio: float, floor: float, apart: Sequence[tuple[int, int]] = ()
) -> NDArray[np.intp]:
    """Cluster numbers (n,), from 0 in order of first appearance, of points with a distance matrix (n, n).

    Single linkage, cut at the first merge that bridges at least `min_gap` and at least `ratio` times what the merges before it
    did (or `floor`): as many clusters as there are clear gaps, be it one. With few points no gap may be clear; pairs that are
    known to be `apart` (where a motion began and ended) then cut lower, unless one in ten or fewer of them asks for it.
    """
    n = len(distances)
    if n == 1:
        return np.zeros(1, dtype=np.intp)
    condensed = squareform(distances, checks=False)
    tree = linkage(condensed, "single")
    heights, cut = tree[:, 2], np.inf
    for k, height in enumerate(heights):
        before = max(float(heights[k - 1]) if k else 0.0, floor)
        if height >= min_gap and height >= ratio * before:
            cut = 0.5 * (height + (heights[k - 1] if k else 0.0))
            break
    if len(apart):
        i, j = np.transpose(apart)
        # where single linkage joins them; a pair nearer than the least gap is no witness
        joined = np.sort(squareform(cophenet(tree))[i, j][distances[i, j] >= min_gap])
        lowest = joined[len(joined) // 10] if len(joined) else np.inf
        if min_gap <= lowest <= cut:
            cut = np.nextafter(lowest, 0.0)
    labels = fcluster(tree, cut, "distance") if np.isfinite(cut) else np.ones(n, dtype=int)
    order: dict[int, int] = {}
    return np.array([order.setdefault(int(label), len(order)) for label in labels], dtype=np.intp)
