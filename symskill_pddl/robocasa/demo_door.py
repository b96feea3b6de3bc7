"""How people open and close the door of a wall cabinet that hangs close in front of them, above their shoulder.

Opening takes two contacts: the bar is grasped and pulled until the door is ajar, then the inner face is pushed, so that the
hand ends on the robot's side. Closing takes one: the hand goes below the door to its outer side and pushes it shut with both
fingers.
"""

from __future__ import annotations

import numpy as np

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.human import vary
from symskill_pddl.demonstrator.part import Jointed, take_along, take_hold
from symskill_pddl.demonstrator.poses import along, facing, moved
from symskill_pddl.geometry import Pose

BAR_Y, BAR_Z = -0.014, -0.005
"""Where on the bar: a little towards the hinge, where a neighbour's front leaves room for a finger [m]."""
FACE_Z = -0.09
"""Where on a face the door is pushed, from the middle of its handle [m]."""
BAR_PITCH = np.radians(12.0)
AJAR_DEG, WIDE_DEG = (47.0, 51.0), (86.0, 89.0)
STROKE_FROM, STROKE_M = np.radians(2.5), 0.07
"""From this angle on the hand moves along the outer face by so much, towards the handle."""
INSIDE_YAW, INSIDE_PITCH, INSIDE_ROLL = np.radians(-60.0), np.radians(35.0), -np.pi / 2
BEHIND_M = 0.22
"""Where the outer face is pushed, from the hinge on [m]: inside the handle."""
YAW_WITH_DOOR, FINGER_ASIDE_M = 0.65, 0.045
"""The hand's yaw follows a door that it shuts by this part of its angle only, so that its wrist stays away from what is beside
the robot; the outer finger, this far from the middle, then meets the face first [m]."""


def open_door(hand: Hand, door: Jointed) -> None:
    """Grasp the bar, pull until ajar, let go, round the free edge, push the inner face until wide open, leave on that side."""
    rng = hand.rng
    bar = (0.0, BAR_Y, BAR_Z + float(rng.uniform(-0.015, 0.015)))

    def on_bar(angle: float) -> Pose:
        return door.hand(angle, bar, 0.95 * angle, BAR_PITCH)

    grasp = on_bar(0.0)
    before = vary(along(grasp, -0.10), rng, 0.01)
    take_hold(hand, grasp, [moved(before, [-0.04, 0.0, -0.05]), before, grasp])
    ajar = float(np.radians(rng.uniform(*AJAR_DEG)))
    take_along(hand, door, on_bar, 0.0, ajar)
    hand.rest(0.4)
    hand.fingers(False)
    hand.go([along(hand.T, -0.07)], careful=True)
    hand.rest(float(rng.uniform(0.6, 0.9)))
    wide, height = float(np.radians(rng.uniform(*WIDE_DEG))), FACE_Z + float(rng.uniform(-0.01, 0.01))
    inner = door.pivot[0] + 0.015

    def inside(angle: float, inset: float, gap: float) -> Pose:
        """Beside the inner face: `inset` from the free edge (negative: beyond it), `gap` off the face."""
        return door.hand(
            angle, (inner + gap, 0.05 - inset, height), INSIDE_YAW + 0.35 * (angle - ajar), INSIDE_PITCH, INSIDE_ROLL
        )

    now = door.position(hand.scene.pose(door.name))
    around = vary(inside(now, -0.14, 0.0), rng, 0.01)
    hand.go([around, inside(now, -0.06, 0.12), inside(now, 0.07, 0.10), inside(now, 0.07, 0.05)])
    take_along(hand, door, lambda angle: inside(angle, 0.07, 0.028), now, wide)
    hand.go([inside(wide, 0.05, 0.11)])
    hand.leave()


def close_door(hand: Hand, door: Jointed) -> None:
    """Below the door to its outer side, and push it shut with both fingers."""
    rng = hand.rng
    start = door.position(hand.scene.pose(door.name))
    from_hinge, height = BEHIND_M + float(rng.uniform(-0.015, 0.015)), FACE_Z + float(rng.uniform(-0.01, 0.01))
    outer = door.pivot[0] - 0.015

    def behind(angle: float, gap: float = 0.0, further: float = 0.0) -> Pose:
        ahead = FINGER_ASIDE_M * float(np.sin((1.0 - YAW_WITH_DOOR) * angle))
        p = (outer - gap - ahead, door.pivot[1] + from_hinge + further, height)
        return door.hand(angle, p, YAW_WITH_DOOR * angle, 0.0)

    below = Pose(np.array([0.28, -0.12, 0.36]), facing(-0.4, 0.8))
    aside = Pose(behind(start, 0.10).p * (1.0, 1.0, 0.0) + np.array([0.0, 0.0, 0.40]), facing(0.0, 0.45))
    hand.go([vary(below, rng, 0.01), vary(aside, rng, 0.01), behind(start, 0.07), behind(start, 0.01)])
    hand.rest(float(rng.uniform(0.3, 0.6)))
    take_along(hand, door, lambda angle: behind(angle, -0.006), start, STROKE_FROM)
    # the last of it is stroked shut, along the face: where a hand stops a little short of its place, the door hardly does
    hand.go([behind(0.0, -0.012, STROKE_M)], careful=True)
    take_along(hand, door, lambda angle: behind(angle, -0.015, STROKE_M), STROKE_FROM, 0.0)
    hand.go([along(hand.T, -0.08)], careful=True)
    hand.leave()
