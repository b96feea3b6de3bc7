"""What a hand does with anything that turns or slides: where its points are, taking it along, a second grasp."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.demo_hand import Hand, along, facing, offset
from symskill_pddl.kitchen.human import approach_twice, vary
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


def take_along(hand: Hand, jointed: Jointed, on_part: Callable[[float], Pose], start: float, goal: float) -> None:
    """Take the part along from `start` to `goal`, and on until it is seen there: the hand slips and gives a little."""
    hand.go([on_part(float(a)) for a in np.linspace(start, goal, 8)[1:]], careful=True)
    aim, way, enough = goal, np.sign(goal - start), CLOSE_ENOUGH[jointed.part.joint]
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
