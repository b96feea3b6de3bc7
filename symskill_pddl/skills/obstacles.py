"""Ellipsoids, boxes and what lies between them, as obstacles that bend a velocity around themselves.

The modulation of Khansari-Zadeh and Billard (2012) with the reference direction of Huber et al. (2019): the velocity is split
into the direction from the obstacle's centre and the plane tangent to its surface; the first part fades towards the surface,
the second does not. With the surface normal in place of the first direction, a flat obstacle would hold the motion in front of
it. Overlapping obstacles lead away from a point they share. All obstacles act at once; what comes out is moved as little as
needed for not entering any of them, which one linear condition for each (its level set is convex) ensures for finite steps.

Every obstacle is the set Gamma(d) = sum |d_i / radii_i|^(2 power) <= 1 in its own axes: an ellipsoid at power 1, nearly a box at
8. Gamma has no unit: it is 1 on the surface whatever the lengths are measured in.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, Pose, frozen

_BOX_POWER = 8.0


@dataclass(frozen=True, eq=False)
class Superellipsoids:
    """Obstacles, all in one batch: they are evaluated in every control tick.

    Attributes
    ----------
    T_world : Pose (n,)
        Centres and axes.
    radii : ndarray (n, 3)
        Half lengths along the axes [m].
    velocity : ndarray (n, 3)
        Of the centres, in world axes [m/s].
    power : ndarray (n,)
        At least 1, an ellipsoid (where none is given); the larger, the nearer to a box.
    """

    T_world: Pose
    radii: Array
    velocity: Array
    power: Array | None = None

    def __post_init__(self) -> None:
        shape = (*self.T_world.shape, 3)
        radii, velocity = frozen(self.radii), frozen(self.velocity)
        power = frozen(np.ones(shape[:-1]) if self.power is None else self.power)
        if len(shape) != 2 or radii.shape != shape or not (np.isfinite(radii).all() and (radii > 0).all()):
            raise InputError(f"obstacles need n poses and three positive radii each, got {self.T_world.shape} and {self.radii}")
        if velocity.shape != shape or not np.isfinite(velocity).all():
            raise InputError(f"an obstacle's velocity has to be three finite numbers, got {self.velocity}")
        if power.shape != shape[:-1] or not ((power >= 1.0) & (power <= 50.0)).all():
            raise InputError(f"an obstacle's power has to lie between 1 and 50, got {self.power}")
        object.__setattr__(self, "radii", radii)
        object.__setattr__(self, "velocity", velocity)
        object.__setattr__(self, "power", power)

    @classmethod
    def join(cls, parts: Sequence[Superellipsoids]) -> Superellipsoids:
        """One batch of several."""
        p, q, radii, velocity, power = (np.concatenate(arrays) for arrays in zip(*(o.arrays for o in parts), strict=True))
        return cls(Pose(p, q), radii, velocity, power)

    def __len__(self) -> int:
        return len(self.radii)

    @property
    def arrays(self) -> tuple[Array, Array, Array, Array, Array]:
        """Centres (n, 3), quaternions (n, 4), radii (n, 3), velocities (n, 3), powers (n,), all in one memory layout."""
        arrays = self.T_world.p, self.T_world.q, self.radii, self.velocity, self.power
        return tuple(np.ascontiguousarray(a) for a in arrays)  # type: ignore[return-value]

    def levels(self, x: ArrayLike) -> Array:
        """Gamma^(1 / (2 power)) (n,) at x (3,) [m]: below 1 inside, 1 on the surface, linear along every ray from the centre."""
        from symskill_pddl.skills.bending import levels

        return np.asarray(levels(np.array(x, dtype=np.float64), *self.arrays))


def ellipsoid(T_world: Pose, radii: ArrayLike, velocity: ArrayLike = (0.0, 0.0, 0.0)) -> Superellipsoids:
    """One ellipsoid of half lengths `radii` (3,) [m]."""
    return _one(T_world, np.asarray(radii, dtype=np.float64), velocity, 1.0)


def box(T_world: Pose, half: ArrayLike, velocity: ArrayLike = (0.0, 0.0, 0.0)) -> Superellipsoids:
    """The superellipsoid of power 8 that just holds a box of half lengths `half` (3,) [m]: 7 % wider than it at its faces."""
    wider = 3.0 ** (0.5 / _BOX_POWER)  # the corners are what is hard to hold
    return _one(T_world, wider * np.asarray(half, dtype=np.float64), velocity, _BOX_POWER)


def _one(T_world: Pose, radii: Array, velocity: ArrayLike, power: float) -> Superellipsoids:
    if T_world.shape != ():
        raise InputError(f"one obstacle needs one pose, got poses {T_world.shape}")
    return Superellipsoids(Pose.stack([T_world]), radii[None], np.asarray(velocity)[None], np.array([power]))


def modulate(
    velocity: ArrayLike,
    x: ArrayLike,
    obstacles: Superellipsoids | Sequence[Superellipsoids],
    *,
    goal: ArrayLike | None = None,
    locality: float = 2.0,
    rate_hz: float = 10.0,
) -> Array:
    """Bend velocities (..., 3) [m/s] at points x (..., 3) [m] around the obstacles.

    Outside, the result never points into a surface it touches, relative to the obstacle's own motion, and is no faster than
    the given one in that sense; it is zero where the velocity is, so an attractor outside the obstacles stays one. Inside, it
    leads out. Several obstacles are weighed by nearness; on the surface of one, that one decides alone. A robot with an extent
    adds it to the radii. The attractor is reached from everywhere around single obstacles, and around overlapping ones that
    share a point; where several overlap without one, they can make a pit that holds a few starts.

    Parameters
    ----------
    goal : (3,), optional
        Obstacles around this point [m] do not count: they would keep the motion from ever arriving.
    locality : float
        The larger, the more local: at twice the radii an obstacle counts 4^-locality.
    rate_hz : float
        Largest rate [1/s] at which the way to a surface may shrink. An explicit step of at most 1 / rate_hz from outside all
        (resting) obstacles ends outside all of them.

    Raises
    ------
    InputError
        If locality or rate are not positive, or shapes do not fit.
    """
    v, x = (np.array(a, dtype=np.float64, order="C") for a in (velocity, x))  # copies: one memory layout, compiled once
    if not (locality > 0 and rate_hz > 0):
        raise InputError(f"a modulation needs a positive locality and rate_hz, got {locality!r} and {rate_hz!r}")
    if v.shape != x.shape or v.shape[-1:] != (3,):
        raise InputError(f"a modulation needs velocities and points of one shape (..., 3), got {v.shape} and {x.shape}")
    if not len(obstacles):
        return v
    if not isinstance(obstacles, Superellipsoids):
        obstacles = Superellipsoids.join(obstacles)
    from symskill_pddl.skills.bending import bend

    free = np.empty((0, 3)) if goal is None else np.array(goal, dtype=np.float64).reshape(1, 3)
    out: Array = bend(v.reshape(-1, 3), x.reshape(-1, 3), free, *obstacles.arrays, locality, rate_hz)
    return out.reshape(v.shape)
