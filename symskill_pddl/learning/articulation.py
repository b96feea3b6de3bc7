"""Hinges and slides from motion alone: does an object turn about one axis, or run along one line, in another frame?

Least squares on poses; no joint is ever read. What is found serves the choice of the reference, the clustering of rest poses
(one joint coordinate instead of six) and readable names.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symskill_pddl.geometry import Array, Pose, frozen, karcher_mean, quat_conjugate, quat_log, quat_multiply

UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class ArticulationConfig:
    """What still counts as one axis or one line."""

    max_off_axis_m: float = 0.012
    """As `max_off_axis_rad`, for positions."""
    max_off_axis_rad: float = float(np.radians(4.0))
    """Root mean square deviation of poses from the joint."""
    min_turn_rad: float = float(np.radians(15.0))
    """Less of a turn shows no axis: 1 cm of noise at 5 cm of it looks like 10 degrees."""
    min_slide_m: float = 0.03
    """Less of a way shows no line."""
    steep_rad: float = float(np.radians(35.0))
    """A single straight motion nearer to the vertical than this is a lift, not a slide."""
    agree_rad: float = float(np.radians(12.0))
    """Joints of single motions are one joint if their axes lie within this of their mean (trackers are not exact)."""


@dataclass(frozen=True, eq=False)
class Joint:
    """One degree of freedom of an object in its reference's frame.

    Attributes
    ----------
    kind : str
        'hinge' or 'slide'.
    axis : ndarray (3,)
        Unit direction in the reference's frame.
    point : ndarray (3,)
        A point on the hinge's axis, or the origin of a slide's coordinate: the reference's own origin, projected.
    residual_m : float
        Root mean square distance of the poses from the joint [m].
    """

    kind: str
    axis: Array
    point: Array
    residual_m: float

    def coordinate(self, T_ref_obj: Pose) -> Array:
        """Angle [rad] from the reference's orientation, or distance [m] along the line; (...,)."""
        if self.kind == "slide":
            return np.asarray(T_ref_obj.p @ self.axis)
        return np.asarray(2.0 * np.arctan2(T_ref_obj.q[..., 1:] @ self.axis, T_ref_obj.q[..., 0]) + np.pi) % (2 * np.pi) - np.pi


def fit_joint(motions: Sequence[Pose], config: ArticulationConfig | None = None) -> Joint | None:
    """The joint that all motions `T_ref_obj` (n_i,) share, or None.

    A hinge: rotation residuals lie on one line, and ``p = c + R d`` with constant c and d. A slide: the orientation is constant
    and the positions lie on one line.
    """
    config = config or ArticulationConfig()
    poses = Pose(np.concatenate([m.p for m in motions]), np.concatenate([m.q for m in motions]))
    mean = karcher_mean(poses.q)
    turns = quat_log(quat_multiply(poses.q, quat_conjugate(mean)))  # (n, 3) in the reference's axes
    centred = turns - turns.mean(axis=0)
    spread, axes = np.linalg.eigh(centred.T @ centred / len(centred))
    reach = float(np.ptp(turns @ axes[:, -1]))
    if reach >= config.min_turn_rad:
        if np.sqrt(max(spread[0] + spread[1], 0.0)) > config.max_off_axis_rad:
            return None
        return _hinge(poses, _signed(axes[:, -1]), config)
    if np.sqrt(spread.sum()) > config.max_off_axis_rad:
        return None
    return _slide(poses, len(motions), config)


def agreed_joint(motions: Sequence[Pose], config: ArticulationConfig | None = None) -> Joint | None:
    """The joint that all motions share, or else the mean of the joints of single motions, if nearly all agree on its axis.

    Each recording sees an object with a constant error of its own, which shifts the joint and leaves it a joint.
    """
    config = config or ArticulationConfig()
    shared = fit_joint(motions, config)
    if shared is not None:
        return shared
    alone = [joint for motion in motions if (joint := fit_joint([motion], config)) is not None]
    kinds = [joint.kind for joint in alone]
    kind = max(("hinge", "slide"), key=kinds.count)
    alone = [joint for joint in alone if joint.kind == kind]
    if len(alone) < 0.8 * len(motions):
        return None
    axes = np.array([joint.axis * np.sign(joint.axis @ alone[0].axis) for joint in alone])
    axis = axes.mean(axis=0) / np.linalg.norm(axes.mean(axis=0))
    if np.median(np.arccos(np.clip(axes @ axis, -1.0, 1.0))) > config.agree_rad:
        return None
    point = np.median([joint.point for joint in alone], axis=0)
    residual = float(np.sqrt(np.mean([joint.residual_m**2 for joint in alone])))
    return Joint(kind, frozen(_signed(axis)), frozen(point), residual)


def _hinge(poses: Pose, axis: Array, config: ArticulationConfig) -> Joint | None:
    # p_i = c + R_i d: six unknowns, minimum-norm solution where c along the axis and d along it trade off
    R = poses.rotation_matrix()
    A = np.concatenate([np.broadcast_to(np.eye(3), R.shape), R], axis=-1).reshape(-1, 6)
    solution = np.linalg.lstsq(A, poses.p.reshape(-1), rcond=1e-9)[0]
    residual = float(np.sqrt(np.mean(np.sum((A @ solution - poses.p.reshape(-1)).reshape(-1, 3) ** 2, axis=-1))))
    return Joint("hinge", frozen(axis), frozen(solution[:3]), residual) if residual <= config.max_off_axis_m else None


def _slide(poses: Pose, n_motions: int, config: ArticulationConfig) -> Joint | None:
    centre = poses.p.mean(axis=0)
    spread, axes = np.linalg.eigh(np.cov((poses.p - centre).T))
    axis, residual = _signed(axes[:, -1]), float(np.sqrt(max(spread[0] + spread[1], 0.0)))
    if np.ptp(poses.p @ axis) < config.min_slide_m or residual > config.max_off_axis_m:
        return None
    if n_motions == 1 and abs(axis @ UP) > np.cos(config.steep_rad):
        return None
    return Joint("slide", frozen(axis), frozen(centre - axis * (centre @ axis)), residual)


def _signed(axis: Array) -> Array:
    """The direction whose largest component is positive, so that the same data give the same sign."""
    return np.asarray(axis * np.sign(axis[np.argmax(np.abs(axis))]))
