"""Rigid transforms, one or many at once.

A `Pose` holds a position `p` (..., 3) in metres and a unit quaternion `q` (..., 4) ordered (w, x, y, z). Leading axes are a
batch and broadcast as in numpy. Tangent vectors are ordered (translation, rotation); rotations are rotation vectors in radians.
`T_a_b` is the pose of frame b in frame a, so `T_a_c = T_a_b @ T_b_c`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from symskill_pddl.errors import InputError

Array = NDArray[np.float64]
_UNIT = 1e-14
"""A quaternion's length is 1 within this."""


def frozen(values: ArrayLike) -> Array:
    """Copy as read-only float64, so that a frozen dataclass is frozen all the way down."""
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


def _components(x: ArrayLike) -> list[Any]:
    """Along the last axis. Those of a single vector are plain floats: numpy takes ten times as long, in every control tick."""
    x = np.asarray(x, dtype=np.float64)
    return x.tolist() if x.ndim == 1 else [x[..., i] for i in range(x.shape[-1])]


def _norm(w: float, x: float, y: float, z: float) -> float:
    return sqrt(w * w + x * x + y * y + z * z)


def _joined(*components: Any) -> Array:
    """The inverse of `_components`."""
    return np.array(components) if isinstance(components[0], float) else np.stack(components, axis=-1)


def quat_multiply(a: ArrayLike, b: ArrayLike) -> Array:
    """Hamilton product of quaternions (..., 4), (w, x, y, z)."""
    (aw, ax, ay, az), (bw, bx, by, bz) = _components(a), _components(b)
    return _joined(
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def quat_conjugate(q: ArrayLike) -> Array:
    """Inverse of unit quaternions (..., 4)."""
    return np.asarray(np.asarray(q, dtype=np.float64) * np.array([1.0, -1.0, -1.0, -1.0]))


def quat_rotate(q: ArrayLike, v: ArrayLike) -> Array:
    """Rotate vectors (..., 3) by unit quaternions (..., 4)."""
    (w, x, y, z), (a, b, c) = _components(q), _components(v)
    tx, ty, tz = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return _joined(a + w * tx + (y * tz - z * ty), b + w * ty + (z * tx - x * tz), c + w * tz + (x * ty - y * tx))


def quat_log(q: ArrayLike) -> Array:
    """Rotation vector (..., 3) [rad] of unit quaternions, angle in [0, pi]; q and -q give the same vector.

    At the angle pi the sign of the axis is arbitrary but deterministic: a function of the rotation alone.
    """
    q = np.asarray(q, dtype=np.float64)
    w, u = q[..., :1], q[..., 1:]
    # The sign is folded by w; where w is 0 the first non-zero component of the axis decides, so that q and -q still agree.
    first = np.take_along_axis(u, np.argmax(np.abs(u) > 0.0, axis=-1, keepdims=True), axis=-1)
    sign = np.where(w != 0.0, np.sign(w), np.where(first < 0.0, -1.0, 1.0))
    w, u = sign * w, sign * u
    norm = np.linalg.norm(u, axis=-1, keepdims=True)
    small = norm < 1e-10
    scale = np.where(small, 2.0, 2.0 * np.arctan2(norm, w) / np.where(small, 1.0, norm))
    return np.asarray(scale * u)


def quat_exp(r: ArrayLike) -> Array:
    """Unit quaternion (..., 4) of rotation vectors (..., 3) [rad]."""
    r = np.asarray(r, dtype=np.float64)
    half = 0.5 * np.linalg.norm(r, axis=-1, keepdims=True)
    return np.concatenate([np.cos(half), 0.5 * np.sinc(half / np.pi) * r], axis=-1)


@dataclass(frozen=True, eq=False)
class Pose:
    """One or many poses. `p` (..., 3) [m], `q` (..., 4) unit quaternion (w, x, y, z); both read-only copies."""

    p: Array
    q: Array

    def __post_init__(self) -> None:
        p, q = frozen(self.p), np.array(self.q, dtype=np.float64)
        if p.shape[-1:] != (3,) or q.shape[-1:] != (4,):
            raise InputError(f"a pose needs p (..., 3) and q (..., 4), got {p.shape} and {q.shape}")
        # a unit quaternion keeps its bits, so that saving and loading gives the same pose
        if p.shape == (3,) and q.shape == (4,) and isfinite(sum(p.tolist())) and abs(_norm(*q.tolist()) - 1.0) < _UNIT:
            # numpy's functions take ten times as long for a single pose, and every control tick makes a dozen
            q.setflags(write=False)
            object.__setattr__(self, "p", p)
            object.__setattr__(self, "q", q)
            return
        norm = np.sqrt((q * q).sum(-1, keepdims=True))
        if not (np.isfinite(p).all() and np.isfinite(norm).all() and (norm > 1e-9).all()):
            raise InputError("a pose holds a number that is not finite, or a quaternion of length 0")
        object.__setattr__(self, "p", p)
        object.__setattr__(self, "q", frozen(np.where(np.abs(norm - 1.0) < _UNIT, q, q / norm)))

    @classmethod
    def identity(cls) -> Pose:
        return cls(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))

    @classmethod
    def from_matrix(cls, T: ArrayLike) -> Pose:
        """From homogeneous matrices (..., 4, 4)."""
        T = np.asarray(T, dtype=np.float64)
        R = T[..., :3, :3]
        xyzw = Rotation.from_matrix(R.reshape(-1, 3, 3)).as_quat().reshape(*R.shape[:-2], 4)
        return cls(T[..., :3, 3], xyzw[..., [3, 0, 1, 2]])

    @classmethod
    def from_rotvec(cls, p: ArrayLike, r: ArrayLike) -> Pose:
        """From position [m] and rotation vector [rad], both (..., 3)."""
        return cls(np.asarray(p, dtype=np.float64), quat_exp(r))

    @classmethod
    def from_vector(cls, x: ArrayLike) -> Pose:
        """From (..., 7): position, then quaternion (w, x, y, z)."""
        x = np.asarray(x, dtype=np.float64)
        return cls(x[..., :3], x[..., 3:7])

    @classmethod
    def stack(cls, poses: Sequence[Pose]) -> Pose:
        """Many poses as one batch along a new first axis."""
        return cls(np.stack([T.p for T in poses]), np.stack([T.q for T in poses]))

    def vector(self) -> Array:
        """(..., 7): position, then quaternion (w, x, y, z)."""
        return np.concatenate([self.p, self.q], axis=-1)

    def matrix(self) -> Array:
        """Homogeneous matrices (..., 4, 4)."""
        T = np.zeros((*self.p.shape[:-1], 4, 4))
        T[..., :3, :3] = self.rotation_matrix()
        T[..., :3, 3] = self.p
        T[..., 3, 3] = 1.0
        return T

    def rotation_matrix(self) -> Array:
        """(..., 3, 3)."""
        w, x, y, z = _components(self.q)
        # fmt: off
        entries = (
            1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
            2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
            2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
        )
        # fmt: on
        return _joined(*entries).reshape(*self.q.shape[:-1], 3, 3)

    def rotvec(self) -> Array:
        """Rotation vectors (..., 3) [rad], angle in [0, pi]."""
        return quat_log(self.q)

    def inverse(self) -> Pose:
        q = quat_conjugate(self.q)
        return Pose(-quat_rotate(q, self.p), q)

    def apply(self, points: ArrayLike) -> Array:
        """Map points (..., 3) of the child frame into the parent frame."""
        return np.asarray(self.p + quat_rotate(self.q, points))

    def rotate(self, vectors: ArrayLike) -> Array:
        """Rotate free vectors (..., 3), such as velocities, into the parent frame."""
        return quat_rotate(self.q, vectors)

    def __matmul__(self, other: Pose) -> Pose:
        return Pose(self.p + quat_rotate(self.q, other.p), quat_multiply(self.q, other.q))

    def __getitem__(self, index: Any) -> Pose:
        """Index the batch axes, as in numpy."""
        return Pose(self.p[index], self.q[index])

    def __len__(self) -> int:
        if self.p.ndim < 2:
            raise InputError("a single pose has no length")
        return len(self.p)

    @property
    def shape(self) -> tuple[int, ...]:
        """The batch shape: () for a single pose."""
        return self.p.shape[:-1]


def rotation_distance(a: Pose, b: Pose) -> Array:
    """Angle (...) [rad] between the orientations, in [0, pi]."""
    return np.asarray(np.linalg.norm(quat_log(quat_multiply(quat_conjugate(a.q), b.q)), axis=-1))


def karcher_mean(q: ArrayLike) -> Array:
    """Mean unit quaternion (4,) of (n, 4), in the sense of the rotation group; sign of each entry does not matter."""
    q = np.asarray(q, dtype=np.float64).reshape(-1, 4)
    # The chordal mean starts the iteration (Markley et al. 2007); a few Karcher steps make the tangent residuals sum to zero.
    mean = np.linalg.eigh(q.T @ q)[1][:, -1]
    for _ in range(20):
        step = quat_log(quat_multiply(quat_conjugate(mean), q)).mean(axis=0)
        mean = quat_multiply(mean, quat_exp(step))
        if np.linalg.norm(step) < 1e-12:
            break
    mean = mean / np.linalg.norm(mean)
    return np.asarray(-mean if mean[np.argmax(np.abs(mean) > 1e-9)] < 0 else mean)
