"""How people open and shut the drawer: the bar is grasped from above and in front, pulled or pushed, and let go."""

from __future__ import annotations

import numpy as np

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.part import grasp_and_take
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.demo_part import seen

PITCH_DEG = (58.0, 66.0)
"""The hand looks down this much: flatter, the wrist meets its limit; steeper, the hand meets the drawer's front."""
ROLL = -np.pi / 2
"""The bar is level: the fingers open in the upright plane."""


def open_drawer(hand: Hand, name: str) -> None:
    """Pull it nearly as far as it goes."""
    _slide(hand, name, float(hand.rng.uniform(0.15, 0.185)))


def close_drawer(hand: Hand, name: str) -> None:
    """Push it shut."""
    _slide(hand, name, 0.0)


def _slide(hand: Hand, name: str, goal: float) -> None:
    rng = hand.rng
    drawer = seen(hand.scene, name)
    x, y, z = layout.DRAWER_BAR
    bar, pitch = (x, y + float(rng.uniform(-0.02, 0.02)), z), float(np.radians(rng.uniform(*PITCH_DEG)))

    def on_bar(position: float) -> Pose:
        return drawer.hand(position, bar, 0.0, pitch, ROLL)

    grasp_and_take(hand, drawer, on_bar, goal, float(rng.uniform(0.10, 0.12)))
