"""How people turn the knob of the stove, grasped from above and twisted, and the lever of the faucet, pushed by one finger."""

from __future__ import annotations

import numpy as np

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.part import grasp_and_take, push_along
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.demo_part import seen

KNOB_PITCH_DEG = (82.0, 88.0)
KNOB_OFF = (0.0, 0.08)
"""People turn a knob off, or nearly, and not hard against the stop [rad]."""
LEVER_PITCH_DEG = (70.0, 80.0)
LEVER_LEAD = 0.03
"""The hand goes ahead of the lever by this much, so that the finger behind it is the one that pushes [m]."""
YAW_WITH_LEVER = 0.6
"""The hand's yaw follows the lever by this part of its angle."""


def turn_knob_on(hand: Hand, name: str) -> None:
    """Twist it as far as a wrist likes to."""
    _twist(hand, name, float(hand.rng.uniform(1.5, 1.75)))


def turn_knob_off(hand: Hand, name: str) -> None:
    """Twist it back."""
    _twist(hand, name, float(hand.rng.uniform(*KNOB_OFF)))


def turn_lever_on(hand: Hand, name: str) -> None:
    """Push it to the left."""
    _push(hand, name, float(hand.rng.uniform(1.1, 1.3)))


def turn_lever_off(hand: Hand, name: str) -> None:
    """Push it back until it stops."""
    _push(hand, name, 0.0)


def _twist(hand: Hand, name: str, goal: float) -> None:
    rng = hand.rng
    knob = seen(hand.scene, name)
    x, y, z = layout.PARTS[name].grip
    ridge, pitch = (x + float(rng.uniform(-0.004, 0.004)), y, z), float(np.radians(rng.uniform(*KNOB_PITCH_DEG)))

    def on_knob(angle: float) -> Pose:
        return knob.hand(angle, ridge, angle, pitch)

    grasp_and_take(hand, knob, on_knob, goal, float(rng.uniform(0.09, 0.11)))


def _push(hand: Hand, name: str, goal: float) -> None:
    rng = hand.rng
    lever = seen(hand.scene, name)
    x, y, z = layout.PARTS[name].grip
    ahead = np.sign(goal - lever.position(hand.scene.pose(name))) * LEVER_LEAD
    end, pitch = (x + float(rng.uniform(-0.008, 0.008)), y + ahead, z), float(np.radians(rng.uniform(*LEVER_PITCH_DEG)))

    def on_lever(angle: float) -> Pose:
        return lever.hand(angle, end, -YAW_WITH_LEVER * angle, pitch)

    push_along(hand, lever, on_lever, goal, float(rng.uniform(0.09, 0.11)))
