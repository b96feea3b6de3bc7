"""How the robot sees a kitchen: from its own base, and where its task is on the other side, in a mirror.

RoboCasa's kitchens stand anywhere and at any right angle in the world. Seen from the robot, all counters are ahead. What remains
is handedness: a door hinged on the left is the mirror image of one hinged on the right, and no turn makes one of the other. The
arm is its own mirror image, nearly, and so is the hand. So an episode whose part is of the other hand is seen, and acted in, in a
mirror that stands upright through the robot's axis: y becomes -y. The image of a rigid motion is one, and gravity stays as it is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symskill_pddl.geometry import Array, Pose

FLIP = np.array([1.0, -1.0, 1.0])
"""Of a point or a velocity in the mirror."""
FLIP_TURN = -FLIP
"""Of a rotation axis or a turn rate in the mirror, which reverses turns as well."""


@dataclass(frozen=True, eq=False)
class View:
    """`T_world_robot`: where the robot stands in the simulator's world. `mirrored`: whether it looks into the mirror."""

    T_world_robot: Pose
    mirrored: bool = False

    def pose(self, T_world: Pose) -> Pose:
        """Poses (...,) of the simulator as they are seen."""
        T = self.T_world_robot.inverse() @ T_world
        return mirror(T) if self.mirrored else T

    def point(self, p_world: Array) -> Array:
        """Points (..., 3) of the simulator as they are seen."""
        p = self.T_world_robot.inverse().apply(p_world)
        return p * FLIP if self.mirrored else p

    def twist(self, seen: Array) -> Array:
        """A twist (6,) in the axes of the view, in those of the simulator's world."""
        linear, angular = seen[:3], seen[3:]
        if self.mirrored:
            linear, angular = FLIP * linear, FLIP_TURN * angular
        return np.concatenate([self.T_world_robot.rotate(linear), self.T_world_robot.rotate(angular)])


def mirror(T: Pose) -> Pose:
    """The mirror images of poses (...,): each axis of a frame is seen in the mirror, and its y axis turned round again."""
    return Pose(T.p * FLIP, T.q * np.array([1.0, -1.0, 1.0, -1.0]))
