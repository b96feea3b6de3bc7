"""What the hand flows around: ellipsoids around free-standing things, for the point between its fingers or for all of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from symskill_pddl.execution.config import MotionConfig
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.scene import Scene
from symskill_pddl.skills import Superellipsoids

_BULGE = 1.025
"""A superellipsoid through the edges and corners of a rounded box has to grow by 2.3 % at most to hold the rest of it."""
_WORLD = Pose.identity()


class Obstacles:
    """Ellipsoids around the small free-standing objects that a step has nothing to do with.

    An ellipsoid lies about half way between its box's faces and corners, plus the clearance for the hand.

    Parameters
    ----------
    objects : mapping of str to str
        The scene's objects and types, in its order.
    extents : mapping
        Half sizes of the types [m].
    spared : frozenset of str
        Objects to leave out: the step's arguments and what is held.
    velocities : callable
        The present velocities (n, 3) [m/s] of the scene's objects.
    """

    def __init__(
        self,
        objects: Mapping[str, str],
        extents: Mapping[str, tuple[float, float, float]],
        spared: frozenset[str],
        config: MotionConfig,
        velocities: Callable[[], Array] | None = None,
    ) -> None:
        def small(name: str, kind: str) -> bool:
            return name not in spared and kind in extents and max(extents[kind]) <= config.obstacle_limit

        rows = [(i, name, kind) for i, (name, kind) in enumerate(objects.items()) if small(name, kind)]
        self.names = tuple(name for _, name, _ in rows)
        self._rows = np.array([i for i, _, _ in rows], dtype=np.intp)
        self._radii = 1.3 * np.array([extents[kind] for _, _, kind in rows]).reshape(-1, 3) + config.obstacle_clearance
        self._velocities, self._hand = velocities, config.hand

    def __call__(self, scene: Scene) -> Superellipsoids:
        return Superellipsoids(scene.T_world_objects[self._rows], self._radii, self._velocity())

    def _velocity(self) -> Array:
        return np.zeros(self._radii.shape) if self._velocities is None else self._velocities()[self._rows]


class Strangers(Obstacles):
    """The same around things of types that were never shown: the hand is led with its whole length, not only with its tip.

    The demonstrated motions clear what was there with the whole hand; they know nothing of other things. The parameters are those
    of `Obstacles`, and the hand's size is the configuration's.
    """

    def __call__(self, scene: Scene) -> Superellipsoids:
        T, radii, power = around_hand(scene.T_world_objects[self._rows], self._radii, scene.T_world_ee, self._hand)
        return Superellipsoids(T, radii, self._velocity(), power)

    def levels(self, scene: Scene, hands: Pose, T_world_base: Pose = _WORLD) -> Array:
        """The least level (m,) of all of them for hands (m,) in the frame `base`: below 1 inside one."""
        from symskill_pddl.skills.hands import least_levels

        base, T, rows = T_world_base, scene.T_world_objects, self._rows
        arrays = (base.p, base.q, hands.p, hands.q, T.p[rows], T.q[rows], self._radii)
        told: tuple[Any, ...] = (*map(np.ascontiguousarray, arrays), self._hand, _BULGE)
        return np.asarray(least_levels(*told))


def around_hand(T_world: Pose, radii: Array, T_world_hand: Pose, hand: tuple[float, float]) -> tuple[Pose, Array, Array]:
    """What a hand's tip has to keep out of, turned as it is, for the whole hand to keep out of ellipsoids.

    The hand is a rectangle. The sum of it and an ellipsoid is convex, and so is the superellipsoid that holds the sum. Its centre
    is the sum's own: with the nearest point of the hand for a centre, its directions would be the surface's normals, and a flat
    side would hold the hand in front of it.

    Parameters
    ----------
    T_world : Pose (n,)
        Centres and axes of ellipsoids.
    radii : (n, 3)
        [m]
    T_world_hand : Pose
    hand : (float, float)
        Width along the opening of the fingers, and length from the tips back [m].

    Returns
    -------
    Pose (n,), radii (n, 3) [m] and powers (n,) of superellipsoids.
    """
    width, length = hand
    half, middle = np.array([0.0, width / 2, length / 2]), np.array([0.0, 0.0, -length / 2])
    # any axes are a ball's, and the hand's fit the hand best
    ball = (np.ptp(radii, axis=1) < 1e-9)[:, None]
    R = T_world_hand.rotation_matrix()
    T = Pose(T_world.p - R @ middle, np.where(ball, T_world_hand.q, T_world.q))
    wide = np.abs(T.rotation_matrix().swapaxes(-1, -2) @ R) @ half + radii
    # it is a box with round edges and corners; these are what is hard to hold
    share = (radii / wide).min(-1)
    powers = [np.log(k) / (-2.0 * np.log(1.0 - share * (1.0 - k**-0.5))) for k in (2.0, 3.0)]
    return T, _BULGE * wide, np.clip(np.maximum(*powers), 1.0, 50.0)
