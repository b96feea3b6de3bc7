"""What a hand does with anything that turns or slides: taking hold of it, taking it along, pushing it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.human import approach_twice, vary
from symskill_pddl.demonstrator.poses import along, facing, offset
from symskill_pddl.geometry import Pose

Vec3 = tuple[float, float, float]


CLOSE_ENOUGH = {"hinge": float(np.radians(0.6)), "slide": 0.003}
"""A part this near to where it is to go is there [rad] or [m]."""


@dataclass(frozen=True)
class Jointed:
    """Something that turns or slides: where its points are when it is open that far [rad] or [m].

    Attributes
    ----------
    name : str
        The object of the scene.
    T_world_home : Pose
        Its frame when it is shut; upright.
    joint : str
        'hinge' or 'slide'.
    axis, pivot : (float, float, float)
        Of the joint, in its frame; it opens along or about the axis.
    """

    name: str
    T_world_home: Pose
    joint: str
    axis: Vec3
    pivot: Vec3 = (0.0, 0.0, 0.0)

    @property
    def enough(self) -> float:
        """See `CLOSE_ENOUGH`."""
        return CLOSE_ENOUGH[self.joint]

    def frame(self, position: float) -> Pose:
        """`T_world_part`."""
        axis = np.array(self.axis)
        if self.joint == "slide":
            return self.T_world_home @ offset(axis * position)
        pivot = np.array(self.pivot)
        return self.T_world_home @ Pose.from_rotvec(pivot, axis * position) @ offset(-pivot)

    def position(self, T_world_part: Pose) -> float:
        """How far it is open when it is seen at this pose."""
        T = self.T_world_home.inverse() @ T_world_part
        return float(np.dot(self.axis, T.p if self.joint == "slide" else T.rotvec()))

    def hand(self, position: float, p: Vec3, yaw: float, pitch: float, roll: float = 0.0) -> Pose:
        """A hand at the point `p` of its frame, open that far; `yaw` counts from the heading of its home."""
        heading = float(self.T_world_home.rotvec()[2])
        return Pose(self.frame(position).apply(p), facing(heading + yaw, pitch, roll))


def take_along(hand: Hand, jointed: Jointed, on_part: Callable[[float], Pose], start: float, goal: float) -> None:
    """Take the part along from `start` to `goal`, and on until it is seen there: the hand slips and gives a little."""
    hand.go([on_part(float(a)) for a in np.linspace(start, goal, 8)[1:]], careful=True)
    aim, way, enough = goal, np.sign(goal - start), jointed.enough
    for _ in range(4):
        missing = goal - jointed.position(hand.scene.pose(jointed.name))
        if missing * way < enough:
            return
        aim += missing + way * 0.8 * enough
        hand.go([on_part(aim)], careful=True)


def take_hold(hand: Hand, grasp: Pose, way: list[Pose]) -> None:
    """By `way` to `grasp` and close the fingers, with whatever goes wrong."""
    hand.go(approach_twice(way, hand.rng) if hand.faults.second_approach else way, pause=hand.faults.pause)
    if hand.faults.poor_grasp:
        # open, back off a little, come again
        hand.fingers(True)
        hand.fingers(False)
        hand.go([along(hand.T, -0.03)], careful=True)
        hand.go([grasp], careful=True)
    hand.fingers(True)


def grasp_and_take(hand: Hand, jointed: Jointed, on_part: Callable[[float], Pose], goal: float, approach_m: float) -> None:
    """Straight on to the part from `approach_m` away, take it to `goal`, let go, straight off and back."""
    start = jointed.position(hand.scene.pose(jointed.name))
    grasp = on_part(start)
    take_hold(hand, grasp, [vary(along(grasp, -approach_m), hand.rng, 0.01), grasp])
    take_along(hand, jointed, on_part, start, goal)
    hand.fingers(False)
    hand.go([along(hand.T, -approach_m)], careful=True)
    hand.leave()


def push_along(hand: Hand, jointed: Jointed, on_part: Callable[[float], Pose], goal: float, approach_m: float) -> None:
    """The part between the open fingers, straight on from `approach_m` away; one pushes it to `goal`; straight off and back."""
    start = jointed.position(hand.scene.pose(jointed.name))
    there = on_part(start)
    way = [vary(along(there, -approach_m), hand.rng, 0.01), there]
    hand.go(approach_twice(way, hand.rng) if hand.faults.second_approach else way, pause=hand.faults.pause)
    hand.rest(float(hand.rng.uniform(0.3, 0.6)))
    take_along(hand, jointed, on_part, start, goal)
    hand.go([along(hand.T, -approach_m)], careful=True)
    hand.leave()
