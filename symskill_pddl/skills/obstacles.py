"""Ellipsoids that bend a velocity around themselves.

The modulation of Khansari-Zadeh and Billard (2012) with the reference direction of Huber et al. (2019): the velocity is split
into the direction from the obstacle's centre and the plane tangent to its surface; the first part fades towards the surface,
the second does not. With the surface normal in place of the first direction, a flat obstacle would hold the motion in front of
it. `Gamma = ||d / radii||^(2 power)` has no unit: it is 1 on the surface whatever the lengths are measured in.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, Pose, frozen

_ESCAPE = 0.3
"""Sideways part of a head-on velocity at the surface, as a fraction of its size."""


@dataclass(frozen=True, eq=False)
class Ellipsoid:
    """An obstacle: pose of its centre and axes, half lengths `radii` (3,) [m], world `velocity` (3,) [m/s] of its centre."""

    T_world: Pose
    radii: Array
    velocity: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        object.__setattr__(self, "radii", frozen(self.radii))
        object.__setattr__(self, "velocity", frozen(self.velocity))
        if (
            self.T_world.shape != ()
            or self.radii.shape != (3,)
            or not np.all(self.radii > 0)
            or not np.all(np.isfinite(self.radii))
        ):
            raise InputError(f"an ellipsoid needs one pose and three positive radii, got {self.T_world.shape} and {self.radii}")
        if self.velocity.shape != (3,) or not np.all(np.isfinite(self.velocity)):
            raise InputError(f"an ellipsoid's velocity has to be three finite numbers, got {self.velocity}")
        object.__setattr__(self, "_rotation", frozen(self.T_world.rotation_matrix()))

    def level(self, x: Array) -> tuple[float, Array, Array]:
        """At x (3,): ||d / radii|| (1 on the surface), unit direction from the centre (3,), unit normal (3,)."""
        R: Array = self._rotation  # type: ignore[attr-defined]
        d = R.T @ (x - self.T_world.p)
        size = float(np.sqrt(d @ d))
        if size < 1e-9 * float(self.radii.min()):
            # at the centre every direction leads out, the thinnest one first
            d = np.eye(3)[int(np.argmin(self.radii))] * 1e-9 * self.radii.min()
            size = float(np.sqrt(d @ d))
        scaled = d / self.radii
        normal = scaled / self.radii
        return float(np.sqrt(scaled @ scaled)), R @ (d / size), R @ (normal / np.sqrt(normal @ normal))


def modulate(velocity: ArrayLike, x: ArrayLike, obstacles: Sequence[Ellipsoid], *, power: float = 2.0) -> Array:
    """Bend `velocity` (3,) [m/s] at the point x (3,) [m] around the obstacles.

    Outside, the result never points into a surface it touches, relative to the obstacle's own motion, and is no faster than
    the given one in that sense; it is zero where the velocity is, so an attractor outside the obstacles stays one. Inside, it
    leads out. Several obstacles are weighed by nearness; on the surface of one, that one decides alone. A robot with an extent
    adds it to the radii.

    Parameters
    ----------
    power : float
        The larger, the more local: at twice the radii an obstacle counts 4^-power.
    """
    v, x = np.asarray(velocity, dtype=np.float64), np.asarray(x, dtype=np.float64)
    if not power > 0:
        raise InputError(f"the power of a modulation has to be positive, got {power!r}")
    if not obstacles:
        return v.copy()
    levels = [obstacle.level(x) for obstacle in obstacles]
    gaps = np.array([max(level - 1.0, 0.0) for level, _, _ in levels])
    weights = 1.0 / np.maximum(gaps, 1e-9)
    weights /= weights.sum()
    closeness = np.array([min(1.0, max(level, 1e-3) ** (-2.0 * power)) for level, _, _ in levels])
    carried = np.asarray(sum(w * c * o.velocity for w, c, o in zip(weights, closeness, obstacles, strict=True)))
    relative = v - carried
    speed = float(np.sqrt(relative @ relative))
    if speed < 1e-12:
        return v.copy()
    bent = [
        _single(relative, speed, *level, near, obstacle)
        for level, near, obstacle in zip(levels, closeness, obstacles, strict=True)
    ]
    return _mean(relative / speed, bent, weights) + carried


def _single(v: Array, speed: float, level: float, out: Array, normal: Array, near: float, obstacle: Ellipsoid) -> Array:
    along = float(v @ normal) / float(out @ normal)  # v = along * out + tangent, tangent in the surface's plane
    tangent = v - along * out
    if level >= 1.0 and along >= 0.0:
        return v
    # head-on, nothing leads around: a sideways push, decided by the obstacle's thinnest way
    size = float(np.sqrt(tangent @ tangent))
    lack = _ESCAPE * near * speed - size
    if lack > 0.0:
        tangent = tangent + lack * (tangent / size if size > 1e-6 * speed else _sideways(normal, obstacle))
    if level < 1.0:
        # inside: outwards, the faster the deeper
        outwards = max(along, 0.0) + speed * min(1.0, 0.1 + 5.0 * (1.0 - level))
    else:
        outwards = (1.0 - near) * along
    bent = outwards * out + (1.0 + near) * tangent
    length = float(np.sqrt(bent @ bent))
    return bent * (speed / length) if length > speed else bent


def _sideways(normal: Array, obstacle: Ellipsoid) -> Array:
    """A unit tangent, along the axis of the least radius that lies in the surface's plane well enough."""
    R: Array = obstacle._rotation  # type: ignore[attr-defined]
    for i in np.argsort(obstacle.radii, kind="stable"):
        tangent = R[:, i] - (R[:, i] @ normal) * normal
        size = float(np.sqrt(tangent @ tangent))
        if size > 0.5:
            return np.asarray(tangent / size)
    raise AssertionError("two of three orthogonal axes make more than 30 degrees with any normal")


def _mean(nominal: Array, velocities: Sequence[Array], weights: Array) -> Array:
    """Weighted mean of sizes, and of directions as angles from the nominal one, so that opposite ones do not cancel."""
    if len(velocities) == 1:
        return velocities[0]
    size, turn = 0.0, np.zeros(3)
    for velocity, weight in zip(velocities, weights, strict=True):
        length = float(np.sqrt(velocity @ velocity))
        size += float(weight) * length
        if length > 1e-12:
            direction = velocity / length
            cosine = float(np.clip(direction @ nominal, -1.0, 1.0))
            across = direction - cosine * nominal
            span = float(np.sqrt(across @ across))
            if span > 1e-12:
                turn += float(weight) * np.arccos(cosine) * across / span
    angle = float(np.sqrt(turn @ turn))
    if angle < 1e-12:
        return size * nominal
    return np.asarray(size * (np.cos(angle) * nominal + np.sin(angle) * turn / angle))
