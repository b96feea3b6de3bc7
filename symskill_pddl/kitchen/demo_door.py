"""How people open and close the cabinet's door.

Both take two contacts. Opening: the bar is grasped and pulled until the door is ajar, then the inner face is pushed; with one
pull the hand would end outside the open door and drag it shut on its way out. Closing: the free edge is grasped and pulled until
the door is ajar, then the bar is pushed from the front; the outer face of a wide open door is behind the door for the arm.
"""

from __future__ import annotations

import numpy as np

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.human import vary
from symskill_pddl.demonstrator.part import Jointed, take_along, take_hold
from symskill_pddl.demonstrator.poses import along
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.demo_part import seen

YAW_AT_SHUT, YAW_WITH_DOOR = np.radians(15.0), 0.6
BAR_PITCH_DEG = (39.0, 45.0)
"""The hand on the bar: its yaw follows the door by 0.6 of the angle, and it looks down, for the sake of the wrist's limits."""
INSIDE_PITCH, INSIDE_ROLL = np.radians(35.0), -np.pi / 2
"""The hand against the inner face: rolled, so that its thin side is towards the door."""
AJAR_DEG = (49.5, 52.5)
"""Where a door is left between the two contacts."""


def open_door(hand: Hand, door_name: str) -> None:
    """Grasp the bar, pull until ajar, let go, round the free edge, push the inner face until wide open, leave on that side."""
    rng = hand.rng
    door = seen(hand.scene, door_name)
    x, y, z = layout.HANDLE
    bar, pitch = (x, y, z + float(rng.uniform(-0.015, 0.015))), float(np.radians(rng.uniform(*BAR_PITCH_DEG)))

    def on_bar(angle: float) -> Pose:
        return door.hand(angle, bar, YAW_AT_SHUT + YAW_WITH_DOOR * angle, pitch)

    grasp = on_bar(0.0)
    way = [vary(along(grasp, -0.12), rng, 0.01), grasp]
    take_hold(hand, grasp, way)
    ajar = float(np.radians(rng.uniform(*AJAR_DEG)))
    take_along(hand, door, on_bar, 0.0, ajar)
    hand.fingers(False)
    hand.go([along(hand.T, -0.08)], careful=True)
    hand.rest(float(rng.uniform(0.6, 0.9)))
    _push_open(hand, door, ajar)
    hand.leave()


def _push_open(hand: Hand, door: Jointed, ajar: float) -> None:
    rng = hand.rng
    wide = float(np.radians(rng.uniform(92.0, 99.0)))
    height = layout.HANDLE[2] + float(rng.uniform(-0.01, 0.02))

    def inside(angle: float, reach: float, gap: float) -> Pose:
        """Beside the inner face: `reach` over the free edge (negative: short of it), `gap` off the face."""
        yaw = np.radians(-35.0) + 0.35 * (angle - ajar)
        return door.hand(angle, (layout.DOOR.half[0] + gap, layout.DOOR.half[1] - reach, height), yaw, INSIDE_PITCH, INSIDE_ROLL)

    round_edge = vary(inside(ajar, -0.13, -0.02), rng, 0.01)
    hand.go([round_edge, inside(ajar, -0.04, 0.10), inside(ajar, 0.06, 0.08), inside(ajar, 0.06, 0.03)])
    angles = np.linspace(ajar, wide, 6)
    hand.go([inside(float(a), 0.06, 0.01) for a in angles], careful=True)
    hand.go([inside(wide, 0.05, 0.10)])


def close_door(hand: Hand, door_name: str) -> None:
    """Grasp the free edge of the open door, pull it until ajar, let go, and push the bar from the front until it is shut."""
    rng = hand.rng
    door = seen(hand.scene, door_name)
    start = door.position(hand.scene.pose(door_name))
    height, pitch = layout.HANDLE[2] + float(rng.uniform(-0.01, 0.03)), float(np.radians(rng.uniform(57.0, 63.0)))

    def on_edge(angle: float) -> Pose:
        """Fingers on either side of the panel, steep, looking along the door towards its hinge (0.7 of it, for the wrist)."""
        yaw = 0.7 * (angle - np.pi / 2)
        return door.hand(angle, (0.0, layout.DOOR.half[1] - 0.012, height), yaw, pitch)

    grasp = on_edge(start)
    way = [vary(Pose(np.array([0.29, -0.06, grasp.p[2]]), grasp.q), rng, 0.02), vary(along(grasp, -0.11), rng, 0.01), grasp]
    take_hold(hand, grasp, way)
    ajar = float(np.radians(rng.uniform(*AJAR_DEG)))
    take_along(hand, door, on_edge, start, ajar)
    hand.fingers(False)
    hand.go([along(hand.T, -0.08)], careful=True)
    hand.rest(float(rng.uniform(0.6, 0.9)))
    _push_shut(hand, door, door_name)
    hand.go([along(hand.T, -0.09)], careful=True)
    hand.leave()


def _push_shut(hand: Hand, door: Jointed, door_name: str) -> None:
    """The bar between the open fingers, and on with the palm until nothing moves any more."""
    rng = hand.rng
    x, y, z = layout.HANDLE
    bar, pitch = (x, y, z + float(rng.uniform(-0.015, 0.015))), float(np.radians(rng.uniform(*BAR_PITCH_DEG)))

    def on_bar(angle: float) -> Pose:
        return along(door.hand(angle, bar, YAW_AT_SHUT + YAW_WITH_DOOR * angle, pitch), 0.025)

    ajar = door.position(hand.scene.pose(door_name))
    hand.go([vary(along(on_bar(ajar), -0.13), rng, 0.01), along(on_bar(ajar), -0.02)])
    take_along(hand, door, on_bar, ajar, 0.0)
