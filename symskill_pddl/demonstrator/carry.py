"""What a hand does with a small thing it takes between its fingers: grasping it, carrying it, letting go of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.human import approach_twice, vary
from symskill_pddl.demonstrator.poses import along, facing, offset
from symskill_pddl.geometry import Pose


def put_down(hand: Hand, grasp: Pose, spot: ArrayLike, support_was: float, heading: float = 0.0) -> Pose:
    """The hand that puts a thing down on `spot` (3,) of a support: as high above it as the hand was above the last one.

    It is turned some of the way towards `heading` [rad].
    """
    approach = grasp.rotate([0.0, 0.0, 1.0])
    yaw, pitch = float(np.arctan2(approach[1], approach[0])), float(-np.arcsin(approach[2]))
    height = grasp.p[2] - support_was + 0.002
    yaw = heading + (yaw - heading) * float(hand.rng.uniform(0.0, 0.5))
    return Pose(np.asarray(spot) + np.array([0.0, 0.0, height]), facing(yaw, pitch))


def pick(hand: Hand, thing: str, half_width: float, via: list[Pose], grasp: Pose) -> Pose:
    """Through `via` and along the approach direction onto a thing, and close; the pose at which it was grasped at last.

    `half_width` is half its size across the fingers [m].
    """
    rng, faults = hand.rng, hand.faults
    way = [*(vary(T, rng, 0.015) for T in via), along(grasp, -float(rng.uniform(0.09, 0.11))), grasp]
    if faults.nudge:
        # one finger knocks against the thing: half the opening, less the thing's, and a little more
        aside = 0.5 * hand.scene.aperture - half_width + float(rng.uniform(0.004, 0.007))
        way[-1] = along(grasp, -0.005)
        hand.go(way, pause=faults.pause)
        hand.go([grasp @ offset([0.0, float(rng.choice([-1.0, 1.0])) * aside, -0.005])], careful=True)
        grasp = Pose(hand.scene.pose(thing).p, grasp.q)
        way = [grasp]
    elif faults.second_approach:
        way = list(approach_twice(way, rng))
    if faults.poor_grasp:
        hand.go([*way[:-1], along(grasp, -float(rng.uniform(0.006, 0.012)))], pause=faults.pause)
        hand.fingers(True)
        hand.fingers(False)
        way = [along(grasp, -0.03), grasp]
    hand.go(way, pause=faults.pause and not faults.nudge, careful=faults.nudge or faults.poor_grasp)
    hand.fingers(True)
    return grasp


def carry(hand: Hand, via: list[Pose], place: Pose) -> None:
    """Through `via` to where it is put down, and let go of it."""
    hand.go(via)
    hand.go([place], careful=True)
    hand.rest(0.2)
    hand.fingers(False)


def retreat(hand: Hand, via: list[Pose]) -> None:
    """Off the thing and back; slow until the fingers are clear."""
    hand.go(via[:1], careful=True)
    hand.leave(via[1:])
