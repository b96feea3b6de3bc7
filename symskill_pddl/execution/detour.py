"""Around what was never shown, and back to the shown way.

A field leads to its goal from everywhere, but only along the demonstrated way does the hand clear what stands around that way,
the sides of a cabinet for instance. So a hand that has to leave the way for an obstacle follows the field, bent around it, only
until nothing is ahead any more, and then goes to where the way comes out behind the obstacle. It waits where the way does not
come out (the obstacle is on the goal) or where that cannot be got to; and when the obstacle is gone it comes back to where it
left.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.execution.around import Strangers
from symskill_pddl.execution.recovery import servo
from symskill_pddl.geometry import Array, Pose, rotation_distance
from symskill_pddl.scene import Scene
from symskill_pddl.skills import Field, rollout

_AHEAD_S, _WAY_S, _STEP_S = 0.5, 10.0, 0.1
"""How far the field is followed in thought [s]: to see whether it leads into something, and where it comes out again."""
_FREE = 1.1
"""Level of a place to go to: on the surface itself the last bit of the way there would take for ever."""
_NEAR_M, _NEAR_RAD = 0.02, 0.15
"""Within these of the shown way the hand is on it."""
_STUCK_S = 1.0
"""A hand that rests this long on a detour has met something that nobody told it of."""
_GAIN = 4.0
"""Pull to a place [1/s], up to the field's own speeds."""


@dataclass(frozen=True, eq=False)
class Led:
    """A twist (6,) in world axes, the place it leads to (None: the field's goal), and whether the hand waits."""

    twist: Array
    target: Pose | None = None
    waits: bool = False


class Detour:
    """Leads the hand where a field cannot. One for each run of a field."""

    def __init__(self, strangers: Strangers) -> None:
        self._strangers = strangers
        self._way: Pose | None = None
        """From where the hand left it (steps + 1,), in the field's frame: objects may move, and their fields with them."""
        self._blocked = self._stuck = False
        self._past = False
        """Whether the field, bent around the obstacle, has led the hand to where nothing is ahead any more."""
        self._since = 0.0
        """Since when the hand has been led to the same end [s]."""

    def __call__(self, field: Field, T_world_field: Pose, nominal: Array, scene: Scene, rest_s: float) -> Led:
        """What the field's twist `nominal` (6,) becomes; `rest_s` is how long the hand has been at rest [s]."""
        T_field_hand = T_world_field.inverse() @ scene.T_world_ee
        ahead = rollout(field, T_field_hand, _AHEAD_S, _STEP_S)
        clear = self._strangers.levels(scene, ahead, T_world_field).min() >= 1.0
        if self._way is None:
            if clear:
                return Led(nominal)
            self._way, self._blocked, self._past = rollout(field, T_field_hand, _WAY_S, _STEP_S), False, False
            self._since, self._stuck = scene.time, False
        way = self._way
        levels = self._strangers.levels(scene, way, T_world_field)
        entry = _first(levels < 1.0, 0)
        out = _first(levels >= _FREE, entry) if entry < len(levels) else 0
        if _on(T_field_hand, way, out, _first(levels < 1.0, out)):
            self._way = None
            return Led(nominal)
        if (entry < len(levels)) != self._blocked:
            self._blocked, self._stuck, self._since, self._past = not self._blocked, False, scene.time, False
        self._stuck |= min(rest_s, scene.time - self._since) > _STUCK_S
        if out < len(levels) and not self._stuck:
            self._past |= clear or not self._blocked
            if not self._past:
                return Led(nominal)
            place = T_world_field @ way[out]
            return Led(self._to(place, scene.T_world_ee, field), place)
        if not self._blocked:
            # nothing is in the way any more, and the hand does not get back to it: the field leads on from here
            self._way = None
            return Led(nominal)
        self._since = scene.time
        return self._wait(T_world_field @ way[entry - 1] if entry else None, scene.T_world_ee, field, scene)

    def _wait(self, place: Pose | None, hand: Pose, field: Field, scene: Scene) -> Led:
        """In front of the obstacle, or just outside it where it came upon the hand."""
        if place is not None:
            return Led(self._to(place, hand, field), place, waits=True)
        twist, near = np.zeros(6), self._strangers(scene)
        levels = near.levels(hand.p)
        if levels.min() < 1.0:
            away = hand.p - near.T_world.p[int(levels.argmin())]
            twist[:3] = field.position.max_speed / max(float(np.linalg.norm(away)), 1e-9) * away
        return Led(twist, waits=True)

    def _to(self, place: Pose, hand: Pose, field: Field) -> Array:
        speed, turn = field.position.max_speed, field.orientation.lpv.max_speed
        return servo(hand, place, gain=_GAIN, max_speed=speed, max_turn=turn)


def _first(holds: NDArray[np.bool_], start: int) -> int:
    """The first index from `start` on where it holds, or the length."""
    found = np.flatnonzero(holds[start:])
    return start + int(found[0]) if len(found) else len(holds)


def _on(T_field_hand: Pose, way: Pose, start: int, stop: int) -> bool:
    """Whether the hand is on a part of the way."""
    near = start + np.flatnonzero(np.linalg.norm(way.p[start:stop] - T_field_hand.p, axis=-1) < _NEAR_M)
    return len(near) > 0 and bool((rotation_distance(way[near], T_field_hand) < _NEAR_RAD).any())
