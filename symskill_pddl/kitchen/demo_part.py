"""Where the points of a part are that turns or slides in a unit, and a hand on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symskill_pddl.demonstrator.poses import facing, offset
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.mjcf import Vec3
from symskill_pddl.scene import Scene

CLOSE_ENOUGH = {"hinge": float(np.radians(0.6)), "slide": 0.003}
"""A part this near to where it is to go is there [rad] or [m]."""


@dataclass(frozen=True)
class Jointed:
    """The part `name` of a unit that stands at `T_world_unit`: where its points are when it is open that far [rad] or [m]."""

    name: str
    T_world_unit: Pose

    @classmethod
    def seen(cls, scene: Scene, name: str) -> Jointed:
        """The part in the unit as the scene shows it."""
        return cls(name, scene.pose(layout.PARTS[name].unit))

    @property
    def part(self) -> layout.Part:
        return layout.PARTS[self.name]

    @property
    def enough(self) -> float:
        return CLOSE_ENOUGH[self.part.joint]

    def frame(self, position: float) -> Pose:
        """`T_world_part`."""
        part, axis = self.part, np.array(self.part.axis)
        home = self.T_world_unit @ offset(part.home)
        if part.joint == "slide":
            return home @ offset(axis * position)
        pivot = np.array(part.pivot)
        return home @ Pose.from_rotvec(pivot, axis * position) @ offset(-pivot)

    def position(self, T_world_part: Pose) -> float:
        """How far a part seen at this pose is open."""
        T = (self.T_world_unit @ offset(self.part.home)).inverse() @ T_world_part
        return float(np.dot(self.part.axis, T.p if self.part.joint == "slide" else T.rotvec()))

    def hand(self, position: float, p: Vec3, yaw: float, pitch: float, roll: float = 0.0) -> Pose:
        """A hand at the point `p` of the part's frame, part at `position`; `yaw` counts from the unit's own heading."""
        heading = float(self.T_world_unit.rotvec()[2])
        return Pose(self.frame(position).apply(p), facing(heading + yaw, pitch, roll))
