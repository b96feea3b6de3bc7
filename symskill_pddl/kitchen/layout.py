"""Where things stand in the kitchen and how large they are. Metres; the robot's base is the origin, x forward, y left.

The top of the counter is z = 0. Numbers are those of a real kitchen, within what one Panda reaches from a fixed base.
"""

from __future__ import annotations

from dataclasses import dataclass

from symskill_pddl.geometry import Array, Pose, frozen

Vec3 = tuple[float, float, float]


@dataclass(frozen=True)
class Box:
    """A box: centre and half sizes, in the frame of what it belongs to."""

    center: Vec3
    half: Vec3

    def contains(self, p: Array, margin: float = 0.0) -> bool:
        """Whether the point p (3,) lies inside, at least `margin` from every face."""
        return bool(all(abs(p[i] - self.center[i]) <= self.half[i] - margin for i in range(3)))


FLOOR_Z = -0.92
COUNTER = Box((0.56, 0.0, -0.02), (0.36, 0.90, 0.02))
WALL_X = 0.92

CABINET = Box((0.77, -0.11, 0.705), (0.15, 0.19, 0.25))
"""Outer box of the wall cabinet: front at x = 0.62, floor 0.47 above the counter, high enough for a wrist above a steep hand."""
PANEL = 0.015
"""Thickness of the cabinet's walls."""
CABINET_INSIDE = Box((-PANEL / 2, 0.0, 0.0), (0.15 - PANEL / 2, 0.19 - PANEL, 0.25 - PANEL))
"""The inside, open to the front, in the cabinet's frame (its centre)."""
SHELF = Box((0.075, 0.0, 0.15), (0.06, 0.175, 0.006))
"""Half-depth shelf at the back, in the cabinet's frame: high enough for a hand to work below it."""

DOOR = Box((-0.159, 0.0, 0.0), (0.009, 0.19, 0.25))
"""The door's panel when shut, in the cabinet's frame. The frame of the door is the centre of its panel."""
DOOR_HINGE: Vec3 = (0.009, -0.19, 0.0)
"""A point of the hinge axis (vertical, opens to the right) in the door's frame."""
DOOR_RANGE = 1.955
"""The door opens 0 to 112 degrees; the joint's angle grows as it opens [rad]."""
HANDLE: Vec3 = (-0.054, 0.145, -0.12)
"""Centre of the vertical handle bar in the door's frame: 4.5 cm in front of the panel, 4.5 cm from the free edge."""
HANDLE_RADIUS = 0.007
HANDLE_LENGTH = 0.12

FOODS: dict[str, Vec3] = {"cheese": (0.03, 0.02, 0.02), "bread": (0.02, 0.024, 0.024), "can": (0.025, 0.025, 0.024)}
"""Half sizes of the foods; each fits between the fingers across y."""
FOOD_MASS = {"cheese": 0.12, "bread": 0.10, "can": 0.15}

TYPES = {"cabinet": "cabinet", "door": "door", "counter": "counter"} | dict.fromkeys(FOODS, "food")
"""Type of every object, in the order of the scene."""
EXTENTS: dict[str, Vec3] = {
    "cabinet": CABINET.half,
    "door": DOOR.half,
    "counter": COUNTER.half,
    "food": (0.03, 0.025, 0.024),
}
"""Half sizes per type; of foods, the largest."""


def hand_pose(p: Array | Vec3, yaw: float, pitch: float) -> Pose:
    """A hand at p (3,) that looks `pitch` [rad] below the horizontal, turned left by `yaw` [rad]; the fingers open sideways."""
    from scipy.spatial.transform import Rotation

    # columns x, y, z of the frame at yaw 0 and pitch 0: z forward, y to the left, x down
    base = Rotation.from_matrix([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    x, y, z, w = (Rotation.from_euler("ZY", [yaw, pitch]) * base).as_quat()
    return Pose(frozen(p), frozen([w, x, y, z]))
