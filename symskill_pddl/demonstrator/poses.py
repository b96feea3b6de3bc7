"""Poses of a hand, and how they are moved. The frame of a hand: z along its approach, y along the opening of the fingers."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from symskill_pddl.geometry import Array, Pose, frozen


def hand_pose(p: ArrayLike, yaw: float, pitch: float) -> Pose:
    """A hand at p (3,) that looks `pitch` [rad] below the horizontal, turned left by `yaw` [rad]; the fingers open sideways."""
    from scipy.spatial.transform import Rotation

    # columns x, y, z of the frame at yaw 0 and pitch 0: z forward, y to the left, x down
    base = Rotation.from_matrix([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    x, y, z, w = (Rotation.from_euler("ZY", [yaw, pitch]) * base).as_quat()
    return Pose(frozen(p), frozen([w, x, y, z]))


def facing(yaw: float, pitch: float, roll: float = 0.0) -> Array:
    """Orientation (4,) of a hand that looks `pitch` [rad] below the horizontal, turned by `yaw` about the vertical.

    The fingers open level, or turned by `roll` about the approach direction. The hand is symmetric under a half turn; as with
    people, it is never turned over without need.
    """
    return (hand_pose((0.0, 0.0, 0.0), yaw, pitch) @ Pose.from_rotvec(np.zeros(3), [0.0, 0.0, roll])).q


def offset(p: ArrayLike) -> Pose:
    """A shift without a turn."""
    return Pose(np.asarray(p, dtype=np.float64), np.array([1.0, 0.0, 0.0, 0.0]))


def along(T: Pose, distance_m: float) -> Pose:
    """The pose moved along its own approach direction; negative backs off."""
    return T @ offset([0.0, 0.0, distance_m])


def moved(T: Pose, shift: ArrayLike) -> Pose:
    """The pose shifted in world axes [m]."""
    return Pose(T.p + np.asarray(shift, dtype=np.float64), T.q)
