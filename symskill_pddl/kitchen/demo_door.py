"""How people open and close the cabinet's door.

Opening takes two contacts: the bar is grasped and pulled until the door is ajar, then the inner face is pushed. With one pull the hand
would end outside the open door and drag it shut on its way out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.demo_hand import Hand, along, facing, moved, offset
from symskill_pddl.kitchen.human import approach_twice, vary
from symskill_pddl.kitchen.layout import Vec3

YAW_AT_SHUT, YAW_WITH_DOOR = np.radians(15.0), 0.6
"""The hand's yaw on the bar: it follows the door by 0.6 of its angle, which keeps the wrist away from its limits."""


@dataclass(frozen=True)
class Door:
    """The door of a cabinet that stands at `T_world_cabinet`: where its points are when it is open by an angle [rad]."""

    T_world_cabinet: Pose

    def frame(self, angle: float) -> Pose:
        """`T_world_door`."""
        hinge = np.array(layout.DOOR_HINGE)
        T_cabinet_hinge = Pose.from_rotvec(np.array(layout.DOOR.center) + hinge, [0.0, 0.0, angle])
        return self.T_world_cabinet @ T_cabinet_hinge @ offset(-hinge)

    def hand(self, angle: float, p: Vec3, yaw: float, pitch: float, like: Pose, roll: float = 0.0) -> Pose:
        """A hand at the point `p` of the door's frame, door at `angle`; `yaw` counts from the direction straight into the cabinet."""
        into = float(self.T_world_cabinet.rotvec()[2])
        return Pose(self.frame(angle).apply(p), facing(into + yaw, pitch, like, roll))

    def angle(self, T_world_door: Pose) -> float:
        """How far a door seen at this pose is open [rad]."""
        return float((self.T_world_cabinet.inverse() @ T_world_door).rotvec()[2])


def open_door(hand: Hand, door_name: str) -> None:
    """Grasp the bar, pull until ajar, let go, round the free edge, push the inner face until wide open, leave on that side."""
    rng, faults = hand.rng, hand.faults
    door = Door(hand.scene.pose("cabinet"))
    x, y, z = layout.HANDLE
    bar = (x, y, z + float(rng.uniform(-0.015, 0.015)))

    def on_bar(angle: float) -> Pose:
        return door.hand(angle, bar, YAW_AT_SHUT + YAW_WITH_DOOR * angle, 0.0, hand.T)

    grasp = on_bar(0.0)
    way: list[Pose] = [vary(along(grasp, -0.12), rng, 0.01), grasp]
    hand.go(approach_twice(way, rng) if faults.second_approach else way, pause=faults.pause)
    if faults.poor_grasp:
        hand.go([along(hand.T, -0.03)], careful=True)
        hand.fingers(True)
        hand.fingers(False)
        hand.go([on_bar(0.0)], careful=True)
    hand.fingers(True)
    ajar = float(np.radians(rng.uniform(49.0, 53.0)))
    hand.go([on_bar(float(a)) for a in np.linspace(0.0, ajar, 8)[1:]], careful=True)
    hand.fingers(False)
    hand.go([along(hand.T, -0.08)], careful=True)
    hand.rest(float(rng.uniform(0.6, 0.9)))
    _push_open(hand, door, ajar)
    hand.leave()


def _push_open(hand: Hand, door: Door, ajar: float) -> None:
    rng = hand.rng
    wide = float(np.radians(rng.uniform(92.0, 99.0)))
    height = float(rng.uniform(-0.08, -0.05))
    roll = np.pi / 2

    def inside(angle: float, reach: float, gap: float) -> Pose:
        """Beside the inner face: `reach` over the free edge (negative: short of it), `gap` off the face."""
        yaw = np.radians(-35.0) + 0.35 * (angle - ajar)
        return door.hand(angle, (layout.DOOR.half[0] + gap, layout.DOOR.half[1] - reach, height), yaw, 0.0, hand.T, roll)

    round_edge = vary(inside(ajar, -0.13, -0.02), rng, 0.01)
    hand.go([round_edge, inside(ajar, -0.04, 0.10), inside(ajar, 0.06, 0.08), inside(ajar, 0.06, 0.03)], pause=hand.faults.nudge)
    angles = np.linspace(ajar, wide, 6)
    hand.go([inside(float(a), 0.06, 0.01) for a in angles], careful=True)
    hand.go([inside(wide, 0.05, 0.10)])


def close_door(hand: Hand, door_name: str) -> None:
    """Low and round under the open door, up on its outer side, a fist against the outer face, and push until it is shut."""
    rng, faults = hand.rng, hand.faults
    door = Door(hand.scene.pose("cabinet"))
    start = door.angle(hand.scene.pose(door_name))
    y = float(rng.uniform(-0.01, 0.03))
    z = float(rng.uniform(-0.08, -0.05))

    def outside(angle: float, gap: float, up: float = 0.0) -> Pose:
        yaw = YAW_AT_SHUT + YAW_WITH_DOOR * angle
        return door.hand(angle, (-layout.DOOR.half[0] - gap, y, z + up), yaw, 0.0, hand.T)

    ready = outside(start, 0.10)
    under = moved(ready, [-0.12, -0.02, -0.22])
    low = moved(Pose(hand.T.p, under.q), [0.0, -0.10, min(0.0, under.p[2] - hand.T.p[2])])
    hand.go(
        [vary(low, rng, 0.015), vary(under, rng, 0.015), vary(moved(ready, [-0.04, -0.03, 0.0]), rng, 0.01), ready],
        pause=faults.pause,
    )
    hand.fingers(True)
    hand.go([outside(start, 0.02)], careful=True)
    hand.go([outside(float(a), -0.005) for a in np.linspace(start, 0.0, 10)[1:]])
    hand.rest(0.3)
    hand.fingers(False)
    hand.go([along(hand.T, -0.08)])
    hand.leave()
