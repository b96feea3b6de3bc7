"""What a hand does with anything that turns or slides: taking hold of it, taking it along, pushing it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.human import approach_twice, vary
from symskill_pddl.demonstrator.poses import along
from symskill_pddl.geometry import Pose


class Part(Protocol):
    """Something that turns or slides, as it is seen."""

    @property
    def name(self) -> str:
        """The object of the scene."""

    @property
    def enough(self) -> float:
        """This near to where it is to go, it is there [rad] or [m]."""

    def position(self, T_world_part: Pose) -> float:
        """How far it is open when it is seen at this pose [rad] or [m]."""


def take_along(hand: Hand, jointed: Part, on_part: Callable[[float], Pose], start: float, goal: float) -> None:
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


def grasp_and_take(hand: Hand, jointed: Part, on_part: Callable[[float], Pose], goal: float, approach_m: float) -> None:
    """Straight on to the part from `approach_m` away, take it to `goal`, let go, straight off and back."""
    start = jointed.position(hand.scene.pose(jointed.name))
    grasp = on_part(start)
    take_hold(hand, grasp, [vary(along(grasp, -approach_m), hand.rng, 0.01), grasp])
    take_along(hand, jointed, on_part, start, goal)
    hand.fingers(False)
    hand.go([along(hand.T, -approach_m)], careful=True)
    hand.leave()


def push_along(hand: Hand, jointed: Part, on_part: Callable[[float], Pose], goal: float, approach_m: float) -> None:
    """The part between the open fingers, straight on from `approach_m` away; one pushes it to `goal`; straight off and back."""
    start = jointed.position(hand.scene.pose(jointed.name))
    there = on_part(start)
    way = [vary(along(there, -approach_m), hand.rng, 0.01), there]
    hand.go(approach_twice(way, hand.rng) if hand.faults.second_approach else way, pause=hand.faults.pause)
    hand.rest(float(hand.rng.uniform(0.3, 0.6)))
    take_along(hand, jointed, on_part, start, goal)
    hand.go([along(hand.T, -approach_m)], careful=True)
    hand.leave()
