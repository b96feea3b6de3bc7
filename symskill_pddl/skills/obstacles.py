"""Ellipsoids that bend a velocity around themselves.

The modulation of Khansari-Zadeh and Billard (2012) with the reference direction of Huber et al. (2019): the velocity is split
into the direction from the obstacle's centre and the plane tangent to its surface; the first part fades towards the surface,
the second does not. With the surface normal in place of the first direction, a flat obstacle would hold the motion in front of
it. `Gamma = ||d / radii||^(2 power)` has no unit: it is 1 on the surface whatever the lengths are measured in.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, Pose, frozen

_ESCAPE = 0.3
"""Sideways part of a head-on velocity at the surface, as a fraction of its size."""


@dataclass(frozen=True, eq=False)
class Ellipsoids:
    """Obstacles, all in one batch: they are evaluated in every control tick.

    Attributes
    ----------
    T_world : Pose (n,)
        Centres and axes.
    radii : ndarray (n, 3)
        Half lengths [m].
    velocity : ndarray (n, 3)
        Of the centres, in world axes [m/s].
    """

    T_world: Pose
    radii: Array
    velocity: Array

    def __post_init__(self) -> None:
        shape = (*self.T_world.shape, 3)
        radii, velocity = frozen(self.radii), frozen(self.velocity)
        if len(shape) != 2 or radii.shape != shape or not (np.isfinite(radii).all() and (radii > 0).all()):
            raise InputError(f"ellipsoids need n poses and three positive radii each, got {self.T_world.shape} and {self.radii}")
        if velocity.shape != shape or not np.isfinite(velocity).all():
            raise InputError(f"an ellipsoid's velocity has to be three finite numbers, got {self.velocity}")
        object.__setattr__(self, "radii", radii)
        object.__setattr__(self, "velocity", velocity)
        object.__setattr__(self, "_rotation", self.T_world.rotation_matrix())

    @classmethod
    def join(cls, parts: Sequence[Ellipsoids]) -> Ellipsoids:
        """One batch of several."""
        T_world = Pose(np.concatenate([o.T_world.p for o in parts]), np.concatenate([o.T_world.q for o in parts]))
        return cls(T_world, np.concatenate([o.radii for o in parts]), np.concatenate([o.velocity for o in parts]))

    def __len__(self) -> int:
        return len(self.radii)

    def level(self, x: Array) -> tuple[Array, Array, Array]:
        """At x (3,): ||d / radii|| (n,), 1 on the surface; unit directions from the centres (n, 3); unit normals (n, 3)."""
        R: Array = self._rotation  # type: ignore[attr-defined]
        d = ((x - self.T_world.p)[:, None] @ R)[:, 0]
        size = _length(d)
        least = 1e-9 * self.radii.min(axis=1, keepdims=True)
        if (size < least).any():
            # at the centre every direction leads out, the thinnest one first
            d = np.where(size < least, np.eye(3)[np.argmin(self.radii, axis=1)] * least, d)
            size = _length(d)
        scaled = d / self.radii
        normal = scaled / self.radii
        turned = np.stack([d / size, normal / _length(normal)], axis=1) @ R.transpose(0, 2, 1)
        return _length(scaled)[:, 0], turned[:, 0], turned[:, 1]


def modulate(
    velocity: ArrayLike, x: ArrayLike, obstacles: Ellipsoids, *, goal: ArrayLike | None = None, power: float = 2.0
) -> Array:
    """Bend `velocity` (3,) [m/s] at the point x (3,) [m] around the obstacles.

    Outside, the result never points into a surface it touches, relative to the obstacle's own motion, and is no faster than
    the given one in that sense; it is zero where the velocity is, so an attractor outside the obstacles stays one. Inside, it
    leads out. Several obstacles are weighed by nearness; on the surface of one, that one decides alone. A robot with an extent
    adds it to the radii.

    Parameters
    ----------
    goal : (3,), optional
        Obstacles around this point [m] do not count: they would keep the motion from ever arriving.
    power : float
        The larger, the more local: at twice the radii an obstacle counts 4^-power.
    """
    v, x = np.asarray(velocity, dtype=np.float64), np.asarray(x, dtype=np.float64)
    if not power > 0:
        raise InputError(f"the power of a modulation has to be positive, got {power!r}")
    counts = np.arange(len(obstacles))
    if goal is not None:
        counts = np.flatnonzero(obstacles.level(np.asarray(goal, dtype=np.float64))[0] > 1.0)
    if not len(counts):
        return v.copy()
    level, out, normal = (of_all[counts] for of_all in obstacles.level(x))
    weights = 1.0 / np.maximum(level - 1.0, 1e-9)
    weights /= weights.sum()
    near = np.minimum(1.0, np.maximum(level, 1e-3) ** (-2.0 * power))
    carried = (weights * near) @ obstacles.velocity[counts]
    relative = v - carried
    speed = float(np.sqrt(relative @ relative))
    if speed < 1e-12:
        return v.copy()

    def sideways(i: int) -> Array:
        return _sideways(normal[i], obstacles, counts[i])

    return _mean(relative / speed, _bent(relative, speed, level, out, normal, near, sideways), weights) + carried


def _bent(
    v: Array, speed: float, level: Array, out: Array, normal: Array, near: Array, sideways: Callable[[int], Array]
) -> Array:
    """What each obstacle by itself makes of v (3,): (n, 3)."""
    along = (normal @ v) / (out * normal).sum(-1)  # v = along * out + tangent, tangent in the surface's plane
    tangent = v - along[:, None] * out
    # head-on, nothing leads around: a sideways push, decided by the obstacle's thinnest way
    size = _length(tangent)[:, 0]
    lack = np.maximum(_ESCAPE * near * speed - size, 0.0)
    if lack.any():
        straight = np.flatnonzero((lack > 0.0) & (size <= 1e-6 * speed))
        push = tangent / np.where(size > 1e-6 * speed, size, 1.0)[:, None]
        for i in straight.tolist():
            push[i] = sideways(i)
        tangent = tangent + lack[:, None] * push
    # inside: outwards, the faster the deeper
    leaving = np.maximum(along, 0.0) + speed * np.minimum(1.0, 0.1 + 5.0 * (1.0 - level))
    bent = np.where(level < 1.0, leaving, (1.0 - near) * along)[:, None] * out + (1.0 + near)[:, None] * tangent
    bent *= np.minimum(1.0, speed / np.maximum(_length(bent), 1e-300))
    return np.where(((level >= 1.0) & (along >= 0.0))[:, None], v, bent)


def _sideways(normal: Array, obstacles: Ellipsoids, i: int) -> Array:
    """A unit tangent of obstacle i, along the axis of the least radius that lies in the surface's plane well enough."""
    R: Array = obstacles._rotation[i]  # type: ignore[attr-defined]
    for axis in np.argsort(obstacles.radii[i], kind="stable"):
        tangent = R[:, axis] - (R[:, axis] @ normal) * normal
        size = float(np.sqrt(tangent @ tangent))
        if size > 0.5:
            return np.asarray(tangent / size)
    raise AssertionError("two of three orthogonal axes make more than 30 degrees with any normal")


def _mean(nominal: Array, velocities: Array, weights: Array) -> Array:
    """Weighted mean of sizes, and of directions as angles from the nominal one, so that opposite ones do not cancel."""
    if len(velocities) == 1:
        return np.asarray(velocities[0])
    length = _length(velocities)
    moving = length[:, 0] > 1e-12
    direction = velocities / np.where(moving[:, None], length, 1.0)
    cosine = np.clip(direction @ nominal, -1.0, 1.0)
    across = direction - cosine[:, None] * nominal
    span = _length(across)[:, 0]
    angles = np.where(moving & (span > 1e-12), weights * np.arccos(cosine) / np.maximum(span, 1e-12), 0.0)
    size, turn = float(weights @ length[:, 0]), angles @ across
    angle = float(np.sqrt(turn @ turn))
    if angle < 1e-12:
        return size * nominal
    return np.asarray(size * (np.cos(angle) * nominal + np.sin(angle) * turn / angle))


def _length(vectors: Array) -> Array:
    return np.asarray(np.sqrt((vectors * vectors).sum(-1, keepdims=True)))
