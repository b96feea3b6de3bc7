"""How people open and shut a drawer beside them: the bar is grasped and pulled, or pushed from in front with both fingers."""

from __future__ import annotations

import numpy as np

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.human import vary
from symskill_pddl.demonstrator.part import Jointed, grasp_and_take, take_along
from symskill_pddl.demonstrator.poses import along
from symskill_pddl.geometry import Pose

PULL_PITCH_DEG, PULL_YAW, PULL_ROLL = (18.0, 24.0), np.radians(-20.0), np.pi / 2
"""Flat enough to come in below the edge of the counter, from the side on which the robot stands. The bar is level: the fingers
open in the upright plane. Of the two ways to roll the hand, this one hardly turns the last joint, also in the mirror."""
PUSH_PITCH_DEG = (76.0, 82.0)
"""The hand hangs down in front of the bar, its thin side towards it."""
BEFORE_M = 0.022
"""From the middle of the bar to that of the fingers in front of it [m]."""


def open_drawer(hand: Hand, drawer: Jointed, travel: float) -> None:
    """Pull it as far as it goes."""
    rng = hand.rng
    bar, pitch = (0.0, float(rng.uniform(-0.02, 0.02)), 0.0), float(np.radians(rng.uniform(*PULL_PITCH_DEG)))

    def on_bar(position: float) -> Pose:
        return drawer.hand(position, bar, PULL_YAW, pitch, PULL_ROLL)

    goal = travel * float(rng.uniform(0.975, 0.995))
    grasp_and_take(hand, drawer, on_bar, goal, float(rng.uniform(0.10, 0.12)))


def close_drawer(hand: Hand, drawer: Jointed) -> None:
    """Push it shut."""
    rng = hand.rng
    start = drawer.position(hand.scene.pose(drawer.name))
    aside, pitch = float(rng.uniform(-0.02, 0.02)), float(np.radians(rng.uniform(*PUSH_PITCH_DEG)))

    def before(position: float, gap: float = 0.0) -> Pose:
        return drawer.hand(position, (-BEFORE_M - gap, aside, 0.0), 0.0, pitch)

    hand.go([vary(along(before(start, 0.05), -0.14), rng, 0.01), before(start, 0.04), before(start, 0.008)])
    hand.rest(float(rng.uniform(0.3, 0.6)))
    take_along(hand, drawer, before, start, 0.0)
    hand.go([before(0.0, 0.05)], careful=True)
    hand.leave([along(hand.T, -0.10)])
