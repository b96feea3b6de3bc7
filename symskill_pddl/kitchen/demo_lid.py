"""How people move a lid: level, by its knob, from above. On the pan it is felt into its seat, in the rack it lies on rails."""

from __future__ import annotations

import numpy as np

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.human import approach_twice, vary
from symskill_pddl.demonstrator.poses import along, facing, moved, offset
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen.demo_dish import CLEAR, back_off, dish_shape
from symskill_pddl.kitchen.judges import SEATED_M, SEATED_RAD
from symskill_pddl.kitchen.layout import PLAY
from symskill_pddl.kitchen.layout import RACK as RAILS
from symskill_pddl.kitchen.loose import Lid
from symskill_pddl.scene import Scene

PAN, RACK = "pan", "dish-rack"
PITCH_DEG = (78.0, 83.0)
ON_PAN_M, ON_RACK_M = 0.002, 0.010
"""How far from the middle people put a lid on the pan and in the rack, to either side [m]."""
QUARTER = np.pi / 2
"""The knob is square."""
CIRCLE_M, PRESS_M = 0.006, 0.004
"""A lid that is not in its seat is pressed and moved about in a small circle."""


def lid_shape(lid: str) -> Lid:
    """What a lid of the play scene is made of."""
    shape = PLAY.loose[lid].shape
    assert isinstance(shape, Lid), f"'{lid}' is no lid"
    return shape


def lid_at(scene: Scene, lid: str) -> str | None:
    """Where a lid is seen: seated on the pan, or on the rails of the rack."""
    T = scene.pose(lid)
    level = np.arccos(np.clip(T.rotate([0.0, 0.0, 1.0])[2], -1.0, 1.0)) < SEATED_RAD
    for place in (PAN, RACK):
        home = _home(scene, lid, place)
        x, y, z = T.p - home.p
        if level and abs(z) < SEATED_M and np.hypot(x, y) < (0.015 if place == PAN else 0.05):
            return place
    return None


def _home(scene: Scene, lid: str, place: str) -> Pose:
    """`T_world_lid` in the middle of its place."""
    shape = lid_shape(lid)
    height = dish_shape(PAN).rim_z - shape.seat_z if place == PAN else RAILS.half[2] + shape.half[2]
    return scene.pose(place) @ offset([0.0, 0.0, height])


def move_lid(hand: Hand, lid: str, place: str) -> None:
    """Take the lid from wherever it lies to the pan or the rack."""
    rng = hand.rng
    _pick(hand, lid)
    T_lid_ee = hand.scene.pose(lid).inverse() @ hand.T
    up = moved(hand.T, [0.0, 0.0, rng.uniform(0.09, 0.12)])
    hand.go([moved(hand.T, [0.0, 0.0, 0.03])], careful=True)
    spread = ON_PAN_M if place == PAN else ON_RACK_M
    spot = _home(hand.scene, lid, place) @ offset([*rng.uniform(-spread, spread, 2), 0.0])
    # turned as the hand likes it, and level whatever the hand does
    turn = Pose.from_rotvec(np.zeros(3), [0.0, 0.0, float(np.radians(rng.uniform(-6.0, 6.0)))])
    down = Pose(spot.p, turn.q) @ T_lid_ee
    hand.go([up, moved(down, [0.0, 0.0, rng.uniform(0.08, 0.11)]), moved(down, [0.0, 0.0, 0.025])])
    hand.go([moved(down, [0.0, 0.0, 0.001])], careful=True)
    if place == PAN and lid_at(hand.scene, lid) != PAN:
        _feel_for_seat(hand, down)
    hand.rest(0.2)
    hand.fingers(False)
    back_off(hand, hand.T)


def _feel_for_seat(hand: Hand, down: Pose) -> None:
    for angle in np.linspace(0.0, 2.0 * np.pi, 7):
        hand.go([moved(down, [CIRCLE_M * np.cos(angle), CIRCLE_M * np.sin(angle), -PRESS_M])], careful=True)
    hand.go([down], careful=True)


def _pick(hand: Hand, lid: str) -> None:
    """From above onto the knob, with whatever goes wrong, and close."""
    rng, faults = hand.rng, hand.faults
    T = hand.scene.pose(lid)
    forward = T.rotate([1.0, 0.0, 0.0])
    yaw = float(np.arctan2(forward[1], forward[0]))
    yaw -= QUARTER * np.round(yaw / QUARTER)
    knob = T.apply([0.0, 0.0, lid_shape(lid).knob_z]) + rng.uniform([-0.002, -0.002, -0.002], [0.002, 0.002, 0.004])
    grasp = Pose(knob, facing(yaw, float(np.radians(rng.uniform(*PITCH_DEG)))))
    way = [vary(along(grasp, -float(rng.uniform(*CLEAR))), rng, 0.012), along(grasp, -0.04), grasp]
    if faults.second_approach:
        way = list(approach_twice(way, rng))
    hand.go(way[:-1], pause=faults.pause)
    if faults.poor_grasp:
        hand.go([along(grasp, -float(rng.uniform(0.006, 0.012)))], careful=True)
        hand.fingers(True)
        hand.fingers(False)
        hand.go([along(grasp, -0.03)], careful=True)
    hand.go([grasp], careful=True)
    hand.fingers(True)
