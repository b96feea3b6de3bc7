"""How people take food from one place to another (cabinet, counter, pan, plate): across its thin side, at one pitch.

The pitch stays, because food that is turned between the fingers tumbles when it is put down. It is one at which the arm reaches
both the counter and the cabinet's floor. The last way in and the first way out run straight along the approach direction.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from symskill_pddl.demonstrator.carry import carry, pick, put_down, retreat
from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.human import vary
from symskill_pddl.demonstrator.poses import along, facing, moved, offset
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.episode import INSIDE_FLOOR
from symskill_pddl.kitchen.loose import FOODS, PLATE, Vessel

PITCH_DEG = (76.0, 80.0)
COUNTER_TOP, CABINET_FLOOR = 0.0, INSIDE_FLOOR
"""Heights of the supports: of the counter in the world, of the floor in the cabinet's frame [m]."""
ON_COUNTER = ((0.55, 0.10), (0.03, 0.06))
"""Where people put food on the counter: middle and half width in the world [m]."""
IN_CABINET = ((-0.08, -0.005), (0.02, 0.04))
"""Where they put it in the cabinet, in its frame [m]."""
IN_DISH = {"cookware": ((-0.02, 0.0), 0.010), "container": ((0.0, 0.0), 0.008)}
"""Where they put it in a dish, in its frame, and how far from there to either side [m]: in a pan, in the nearer half."""
FRONT = -layout.CABINET.half[0]
"""The plane of the cabinet's opening: x in its frame."""


def to_counter(hand: Hand, food: str) -> None:
    """Out of the cabinet, onto the counter."""
    rng = hand.rng
    cabinet = hand.scene.pose("cabinet")
    grasp = _grasp(hand, food)
    grasp = pick(hand, food, FOODS[food].half[1], [_before(cabinet, grasp, 0.08)], grasp)
    up = moved(grasp, [0.0, 0.0, rng.uniform(0.035, 0.055)])
    spot = (*(np.array(ON_COUNTER[0]) + rng.uniform(-1.0, 1.0, 2) * ON_COUNTER[1]), COUNTER_TOP)
    place = put_down(hand, grasp, spot, cabinet.p[2] + CABINET_FLOOR)
    carry(hand, [up, vary(_before(cabinet, up, 0.02), rng, 0.012), moved(place, [0.0, 0.0, 0.08])], place)
    retreat(hand, [along(place, -float(rng.uniform(0.09, 0.12)))])


def to_cabinet(hand: Hand, food: str) -> None:
    """From the counter into the cabinet."""
    rng = hand.rng
    cabinet = hand.scene.pose("cabinet")
    grasp = pick(hand, food, FOODS[food].half[1], [], _grasp(hand, food))
    up = moved(grasp, [0.0, 0.0, rng.uniform(0.05, 0.08)])
    spot = cabinet.apply((*(np.array(IN_CABINET[0]) + rng.uniform(-1.0, 1.0, 2) * IN_CABINET[1]), CABINET_FLOOR))
    place = put_down(hand, grasp, spot, COUNTER_TOP)
    carry(hand, [up, vary(_before(cabinet, place, 0.07), rng, 0.012), moved(place, [-0.02, 0.0, 0.05])], place)
    retreat(hand, [along(place, -float(rng.uniform(0.045, 0.06))), vary(_before(cabinet, place, 0.06), rng, 0.012)])


def to_plate(hand: Hand, food: str) -> None:
    """Out of the pan, onto the plate."""
    _into_dish(hand, food, "pan", "plate")


def to_pan(hand: Hand, food: str, pan: str = "pan") -> None:
    """From a plate, or the counter, into the pan."""
    plates = [name for name, kind in hand.scene.objects.items() if kind == "container"]
    p = hand.scene.pose(food).p
    start = next((name for name in plates if np.linalg.norm((p - hand.scene.pose(name).p)[:2]) < PLATE.half[0]), None)
    _into_dish(hand, food, start, pan)


def _into_dish(hand: Hand, food: str, start: str | None, dish: str) -> None:
    """Straight up out of another dish, or from the counter, over the dish's rim, and straight down into it."""
    rng = hand.rng
    grasp = pick(hand, food, FOODS[food].half[1], [], _grasp(hand, food))
    up = moved(grasp, [0.0, 0.0, rng.uniform(0.07, 0.10)])
    spot, spread = IN_DISH[layout.DINNER.loose[dish].type]
    # the other dish as it stands after the food was lifted from it
    support = _floor(hand, start)[2] if start else COUNTER_TOP
    place = put_down(hand, grasp, _floor(hand, dish, np.array(spot) + rng.uniform(-spread, spread, 2)), support)
    carry(hand, [up, moved(place, [0.0, 0.0, rng.uniform(0.08, 0.10)])], place)
    retreat(hand, [along(place, -float(rng.uniform(0.09, 0.12)))])


def _floor(hand: Hand, dish: str, at: ArrayLike = (0.0, 0.0)) -> Array:
    """A point of a dish's floor in the world (3,)."""
    shape = layout.DINNER.loose[dish].shape
    assert isinstance(shape, Vessel)
    return hand.scene.pose(dish).apply((*np.asarray(at), shape.floor_z))


def _grasp(hand: Hand, food: str) -> Pose:
    """A hand about the middle of the food, its fingers across the thin side, looking ahead and not back."""
    T = hand.scene.pose(food)
    forward = T.rotate([1.0, 0.0, 0.0])
    yaw = float(np.arctan2(forward[1], forward[0]))
    yaw -= np.pi * np.round(yaw / np.pi)
    pitch = float(np.radians(hand.rng.uniform(*PITCH_DEG)))
    p = T.p + hand.rng.uniform([-0.003, -0.002, -0.002], [0.003, 0.002, 0.003])
    return Pose(p, facing(yaw, pitch))


def _before(cabinet: Pose, T_world_ee: Pose, up_m: float) -> Pose:
    """The hand drawn straight back out of the cabinet, 7 cm in front of its opening, `up_m` higher."""
    T = cabinet.inverse() @ T_world_ee
    back = FRONT - 0.07 - T.p[0]
    return cabinet @ offset([back, 0.0, up_m]) @ T
