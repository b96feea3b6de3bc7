"""Whether there is room for an arm beside an open door: on its outer side, where another door, a fridge or a wall may be, and
on its inner side for the hand, which is 20 cm wide."""

from __future__ import annotations

import numpy as np

from symskill_pddl.demonstrator.part import Jointed
from symskill_pddl.geometry import Array
from symskill_pddl.robocasa.tracking import Model
from symskill_pddl.robocasa.view import View

ROBOT = ("robot0", "mobilebase0")
FROM_HINGE_M, BESIDE_M, HEIGHT_M = (0.05, 0.35), (0.06, 0.30), (0.35, 0.85)
"""The room an arm needs: along the open door, away from its outer side, and above the arm's base."""
FROM_DOOR_M, FROM_SIDE_M = 0.15, 0.12
"""How far from the hinge, and from the handle's place on the other side, something is that a hand gets to from in front."""


def free_beside(m: Model, view: View, door: Jointed, body: int) -> bool:
    """Whether nothing but the robot, and what the door belongs to, is in the room beside the wide open door.

    `body` is MuJoCo's of the door.
    """
    hinge = door.T_world_home.apply(door.pivot)
    low = np.array([hinge[0] - FROM_HINGE_M[1], hinge[1] - BESIDE_M[1], HEIGHT_M[0]])
    high = np.array([hinge[0] - FROM_HINGE_M[0], hinge[1] - BESIDE_M[0], HEIGHT_M[1]])
    own, root = int(m.model.body_rootid[body]), m.model.body_rootid
    others = [b for b in range(m.model.nbody) if root[b] != own and not m.model.body(root[b]).name.startswith(ROBOT)]
    return not any(_within(*_seen_box(m, view, g), low, high) for g in m.touchable(others))


def hand_fits(door: Jointed, p_world: Array) -> bool:
    """Whether a hand gets to a point (3,) between a door that is open at a right angle and the cabinet's other side."""
    hinge, y = door.pivot[1], float(door.T_world_home.inverse().apply(p_world)[1])
    from_hinge, from_handle = (y - hinge) * -np.sign(hinge), y * np.sign(hinge)
    return bool(from_hinge > FROM_DOOR_M and from_handle > FROM_SIDE_M)


def _seen_box(m: Model, view: View, geom: int) -> tuple[Array, Array]:
    """The box about a geom along the axes of the view."""
    center, half = m.model.geom_aabb[geom][:3], m.model.geom_aabb[geom][3:]
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
    corners = (center + signs * half) @ m.data.geom_xmat[geom].reshape(3, 3).T + m.data.geom_xpos[geom]
    seen = view.point(corners)
    return seen.min(axis=0), seen.max(axis=0)


def _within(low: Array, high: Array, room_low: Array, room_high: Array) -> bool:
    return bool(np.all(low < room_high) and np.all(high > room_low))
