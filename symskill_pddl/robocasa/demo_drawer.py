"""How people open and shut a drawer beside them: the bar is grasped from the robot's side, pulled or pushed, and let go."""

from __future__ import annotations

import numpy as np

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.part import Jointed, grasp_and_take
from symskill_pddl.demonstrator.poses import along
from symskill_pddl.geometry import Pose

PITCH_DEG, YAW = (18.0, 24.0), np.radians(-20.0)
"""Flat enough to come in below the edge of the counter; from the side on which the robot stands."""
SHORT_M = 0.012
"""The tips of the fingers stay this much short of the front that the bar is on."""
ROLL = -np.pi / 2
"""The bar is level: the fingers open in the upright plane."""


def open_drawer(hand: Hand, drawer: Jointed, travel: float) -> None:
    """Pull it as far as it goes."""
    _slide(hand, drawer, travel * float(hand.rng.uniform(0.975, 0.995)))


def close_drawer(hand: Hand, drawer: Jointed) -> None:
    """Push it shut."""
    _slide(hand, drawer, 0.0)


def _slide(hand: Hand, drawer: Jointed, goal: float) -> None:
    rng = hand.rng
    bar, pitch = (0.0, float(rng.uniform(-0.02, 0.02)), 0.0), float(np.radians(rng.uniform(*PITCH_DEG)))

    def on_bar(position: float) -> Pose:
        return along(drawer.hand(position, bar, YAW, pitch, ROLL), -SHORT_M)

    grasp_and_take(hand, drawer, on_bar, goal, float(rng.uniform(0.10, 0.12)))
