"""How people turn the knob of a stove, grasped along its axis and twisted, and the lever of a faucet, pushed by one finger."""

from __future__ import annotations

import numpy as np

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.part import Jointed, grasp_and_take, push_along
from symskill_pddl.demonstrator.poses import facing
from symskill_pddl.geometry import Pose

KNOB_PITCH_DEG = (82.0, 88.0)
LEVER_PITCH_DEG = (34.0, 42.0)
"""Flat: most sinks have a cabinet above them, and a wrist above the lever would be in it."""
LEVER_LEAD = 0.018
"""The hand goes ahead of the lever by this much, so that the finger behind it pushes, and comes down well clear of it [m]."""
YAW_WITH_LEVER = 0.6
"""The hand's yaw follows the lever by this part of its angle."""


def turn_knob_on(hand: Hand, knob: Jointed, travel: float) -> None:
    """Twist it as far as a wrist likes to."""
    _twist(hand, knob, travel * float(hand.rng.uniform(0.82, 0.95)))


def turn_knob_off(hand: Hand, knob: Jointed) -> None:
    """Twist it back."""
    _twist(hand, knob, float(hand.rng.uniform(0.0, 0.08)))


def turn_lever_on(hand: Hand, lever: Jointed, travel: float) -> None:
    """Push it two thirds of its way, a little further than where it is found on."""
    _push(hand, lever, travel * float(hand.rng.uniform(0.64, 0.74)))


def turn_lever_off(hand: Hand, lever: Jointed) -> None:
    """Push it back until it stops."""
    _push(hand, lever, 0.0)


def _twist(hand: Hand, knob: Jointed, goal: float) -> None:
    rng = hand.rng
    ridge, pitch = (float(rng.uniform(-0.004, 0.004)), 0.0, 0.012), float(np.radians(rng.uniform(*KNOB_PITCH_DEG)))

    def on_knob(angle: float) -> Pose:
        return knob.frame(angle) @ Pose(np.array(ridge), facing(0.0, pitch))

    grasp_and_take(hand, knob, on_knob, goal, float(rng.uniform(0.09, 0.11)))


def _push(hand: Hand, lever: Jointed, goal: float) -> None:
    rng = hand.rng
    sense = float(np.sign(lever.axis[2]))
    ahead = -sense * float(np.sign(goal - lever.position(hand.scene.pose(lever.name)))) * LEVER_LEAD
    end, pitch = (-0.04 + float(rng.uniform(-0.008, 0.008)), ahead, 0.0), float(np.radians(rng.uniform(*LEVER_PITCH_DEG)))

    def on_lever(angle: float) -> Pose:
        return lever.hand(angle, end, sense * YAW_WITH_LEVER * angle, pitch)

    push_along(hand, lever, on_lever, goal, float(rng.uniform(0.13, 0.16)))
