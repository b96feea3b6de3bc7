"""How people take something from one place to another (cabinet, counter, pan, plate): across a narrow side, at one pitch.

The pitch stays, because what is turned between the fingers tumbles when it is put down. It is one at which the hand clears a
pan's rim and the arm reaches all of the counter from where RoboCasa puts the robot; out of a cabinet it is flatter, where the arm
is nearly stretched above the lowest shelf.
"""

from __future__ import annotations

import numpy as np

from symskill_pddl.demonstrator.carry import carry, pick, put_down
from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.human import vary
from symskill_pddl.demonstrator.poses import along, facing, moved, offset
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.robocasa.things import SHELF_DEPTH_M
from symskill_pddl.robocasa.world import RoboCasaWorld

PITCH_DEG, FLAT_PITCH_DEG = (48.0, 52.0), (43.0, 45.0)
SPREAD = {"counter": (0.025, 0.06), "cabinet": (0.015, 0.03), "pan": (0.01, 0.01), "plate": (0.01, 0.01)}
"""How far from the middle of a place people put something down, to either side [m]."""
FINGERTIP_M = 0.016
"""How high above what it stands on a hand takes something at least: the fingers end below the middle of their pads."""
CLEAR_M = 0.11
"""How far before the front of a cabinet a hand goes down with what it brings: half of that, and room."""
AWAY_M = 0.30
"""How far the hand goes off what it let go of."""


def to_counter(hand: Hand, world: RoboCasaWorld) -> None:
    """Out of the cabinet, onto the counter."""
    grasp, standing = _grasp(hand, world, FLAT_PITCH_DEG)
    grasp = pick(hand, "food", _half(world)[1], [_before(hand, world, grasp, 0.05)], grasp)
    up = moved(grasp, [0.0, 0.0, hand.rng.uniform(0.03, 0.045)])
    place = _place(hand, world, "counter", grasp, standing)
    # straight down until the shelf's edge is well above what is carried, and only then on below the cabinet
    out = vary(_before(hand, world, up, 0.02, CLEAR_M), hand.rng, 0.012)
    carry(hand, [up, out, moved(out, [0.0, 0.0, -0.16]), moved(place, [0.0, 0.0, 0.08])], place)
    _leave(hand, [along(place, -AWAY_M)])


def to_cabinet(hand: Hand, world: RoboCasaWorld) -> None:
    """From the counter into the cabinet."""
    grasp, standing = _grasp(hand, world)
    grasp = pick(hand, "food", _half(world)[1], [], grasp)
    up = moved(grasp, [0.0, 0.0, hand.rng.uniform(0.05, 0.08)])
    place = _place(hand, world, "cabinet", grasp, standing)
    carry(hand, [up, vary(_before(hand, world, place, 0.06), hand.rng, 0.012), moved(place, [-0.02, 0.0, 0.04])], place)
    _leave(hand, [along(place, -0.06), moved(_before(hand, world, place, 0.05), [-0.16, 0.0, 0.0])])


def to_plate(hand: Hand, world: RoboCasaWorld) -> None:
    """Out of the pan, onto the plate."""
    _to_dish(hand, world, "plate")


def to_pan(hand: Hand, world: RoboCasaWorld) -> None:
    """From the plate, into the pan."""
    _to_dish(hand, world, "pan")


def _to_dish(hand: Hand, world: RoboCasaWorld, dish: str) -> None:
    """Straight up out of one dish, over the rim of the other, and straight down into it."""
    grasp, standing = _grasp(hand, world)
    grasp = pick(hand, "food", _half(world)[1], [], grasp)
    up = moved(grasp, [0.0, 0.0, hand.rng.uniform(0.09, 0.12)])
    place = _place(hand, world, dish, grasp, standing)
    carry(hand, [up, moved(place, [0.0, 0.0, hand.rng.uniform(0.10, 0.12)])], place)
    _leave(hand, [along(place, -AWAY_M)])


def _half(world: RoboCasaWorld) -> tuple[float, float, float]:
    return world.extents["food"]


def _grasp(hand: Hand, world: RoboCasaWorld, pitch_deg: tuple[float, float] = PITCH_DEG) -> tuple[Pose, float]:
    """A hand about the middle of the food, its fingers across the narrow side; and how high what it stands on is."""
    T = hand.scene.pose("food")
    standing = float(T.p[2]) - _half(world)[2]
    p = T.p + hand.rng.uniform([-0.003, -0.002, -0.002], [0.003, 0.002, 0.003])
    p[2] = max(p[2], standing + FINGERTIP_M)
    return Pose(p, facing(_heading(T), float(np.radians(hand.rng.uniform(*pitch_deg))))), standing


def _heading(T: Pose) -> float:
    forward = T.rotate([1.0, 0.0, 0.0])
    return float(np.arctan2(forward[1], forward[0]))


def _before(hand: Hand, world: RoboCasaWorld, T_world_ee: Pose, up_m: float, out_m: float = 0.08) -> Pose:
    """The hand drawn straight back out of the cabinet, `out_m` before its front, `up_m` higher."""
    cabinet = hand.scene.pose("cabinet")
    T = cabinet.inverse() @ T_world_ee
    back = float(world.room("cabinet")[0]) - SHELF_DEPTH_M - out_m - T.p[0]
    return cabinet @ offset([back, 0.0, up_m]) @ T


def _place(hand: Hand, world: RoboCasaWorld, name: str, grasp: Pose, standing: float) -> Pose:
    """The hand that puts down what it holds about where there is room in or on an object."""
    there, (x, y) = hand.scene.pose(name), hand.rng.uniform(-1.0, 1.0, 2) * SPREAD[name]
    spot: Array = there.apply(world.room(name) + np.array([x, y, 0.0]))
    return put_down(hand, grasp, spot, standing, _heading(there))


def _leave(hand: Hand, via: list[Pose]) -> None:
    """Straight off and on until the hand is well away, a rest, and back."""
    hand.go(via)
    hand.rest(float(hand.rng.uniform(0.5, 0.8)))
    hand.leave()
