"""How people who play take a thing from one dish to another: across its thin side, straight up, over, and straight down again.

Two things may lie in one dish if they fit one behind the other: beside each other, the fingers of a hand would not.
"""

from __future__ import annotations

import numpy as np

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.human import approach_twice, vary
from symskill_pddl.demonstrator.poses import along, facing, moved, offset
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen.layout import PLAY
from symskill_pddl.kitchen.loose import Vessel
from symskill_pddl.scene import Scene

PITCH_DEG = (76.0, 80.0)
CLEAR = (0.14, 0.17)
"""How far above a thing the hand comes from and leaves to: it may pass over a lid's knob on its way [m]."""
SPREAD = (0.030, 0.012)
"""Where things are put in a dish at most: half widths about its middle, along and across [m]."""
APART_M, RIM_M = 0.062, 0.002
"""Distance between the middles of two things in one dish, and from a thing's corner to the wall, at least [m]."""
UNDER_LID_M = 0.072
"""In the pan, things stay within this of the middle: a lid's skirt comes down around them [m]."""
TURN_DEG = (-12.0, 6.0)
"""How a thing is turned when it is put down, in the world."""
PUT_DOWN_CHANCE = 0.06
"""Of a thing being put down where it was and taken again."""


def dish_shape(dish: str) -> Vessel:
    """What a dish of the play scene is made of."""
    shape = PLAY.loose[dish].shape
    assert isinstance(shape, Vessel), f"'{dish}' is no dish"
    return shape


DISHES = tuple(name for name, thing in PLAY.loose.items() if isinstance(thing.shape, Vessel))


def dish_of(scene: Scene, thing: str) -> str | None:
    """The dish that a thing is seen in."""
    for dish in DISHES:
        shape = dish_shape(dish)
        x, y, z = (scene.pose(dish).inverse() @ scene.pose(thing)).p
        if np.hypot(x, y) < shape.radius and 0.0 < z - shape.floor_z < max(PLAY.loose[thing].half) + 0.01:
            return dish
    return None


def _others_in(scene: Scene, dish: str, thing: str) -> list[float]:
    """Where the other things of a dish lie in it, along [m]."""
    there = [other for other in PLAY.of_type("thing") if other != thing and dish_of(scene, other) == dish]
    return [float((scene.pose(dish).inverse() @ scene.pose(other)).p[0]) for other in there]


def fits(scene: Scene, dish: str, thing: str) -> bool:
    """Whether there is room for a thing in a dish."""
    return all(APART_M - abs(x) <= _farthest(dish, thing, 0.0) for x in _others_in(scene, dish, thing))


def _farthest(dish: str, thing: str, y: float) -> float:
    """How far from the middle of a dish, along, a thing fits in that lies `y` across [m]."""
    half_x, half_y, _ = PLAY.loose[thing].half
    radius = min(dish_shape(dish).radius - RIM_M, UNDER_LID_M)
    return float(np.sqrt(radius**2 - (half_y + abs(y)) ** 2) - half_x)


def _spot(hand: Hand, thing: str, dish: str) -> tuple[float, float]:
    """Where in a dish the thing is put, in its frame (x, y) [m]: anywhere, or on the free side."""
    others, rng = _others_in(hand.scene, dish, thing), hand.rng
    if not others:
        y = float(rng.uniform(-1.0, 1.0)) * SPREAD[1]
        return float(rng.uniform(-1.0, 1.0)) * min(SPREAD[0], _farthest(dish, thing, y)), y
    nearest = APART_M - abs(others[0])
    farthest = min(_farthest(dish, thing, 0.0), nearest + 0.01)
    return -float(np.sign(others[0])) * float(rng.uniform(nearest, max(nearest, farthest))), 0.0


def move_thing(hand: Hand, thing: str, dish: str) -> None:
    """Take the thing from wherever it lies to the dish."""
    rng = hand.rng
    lay_on = _floor_below(hand.scene, thing)
    grasp = _pick(hand, thing)
    up = moved(grasp, [0.0, 0.0, rng.uniform(0.08, 0.11)])
    if rng.random() < PUT_DOWN_CHANCE:
        grasp = _put_down_and_take_again(hand, thing, grasp)
    spot = hand.scene.pose(dish).apply([*_spot(hand, thing, dish), dish_shape(dish).floor_z])
    # the hand is as high above the floor as it was above the last one, and looks down as before
    approach = grasp.rotate([0.0, 0.0, 1.0])
    turn = float(np.radians(rng.uniform(*TURN_DEG))) - _yaw(hand.scene.pose(thing)) + float(np.arctan2(approach[1], approach[0]))
    height = float(grasp.p[2] - lay_on + 0.002)
    place = moved(Pose(spot, facing(turn, float(-np.arcsin(approach[2])))), [0.0, 0.0, height])
    hand.go([up, moved(place, [0.0, 0.0, rng.uniform(0.09, 0.12)]), moved(place, [0.0, 0.0, 0.03])])
    hand.go([place], careful=True)
    hand.rest(0.2)
    hand.fingers(False)
    back_off(hand, place)


def back_off(hand: Hand, grasp: Pose) -> None:
    """Up and away along the approach direction; slow until the fingers are clear."""
    hand.go([along(grasp, -0.05)], careful=True)
    hand.go([vary(along(grasp, -float(hand.rng.uniform(*CLEAR))), hand.rng, 0.01)])


def _yaw(T: Pose) -> float:
    """How far a thing is turned, half turns left out: it looks the same [rad]."""
    forward = T.rotate([1.0, 0.0, 0.0])
    yaw = float(np.arctan2(forward[1], forward[0]))
    return float(yaw - np.pi * np.round(yaw / np.pi))


def _floor_below(scene: Scene, thing: str) -> float:
    dish = dish_of(scene, thing)
    return 0.0 if dish is None else float(scene.pose(dish).p[2] + dish_shape(dish).floor_z)


def _grasp(hand: Hand, thing: str) -> Pose:
    T, rng = hand.scene.pose(thing), hand.rng
    p = T.p + rng.uniform([-0.003, -0.002, 0.0], [0.003, 0.002, 0.005])
    return Pose(p, facing(_yaw(T), float(np.radians(rng.uniform(*PITCH_DEG)))))


def _pick(hand: Hand, thing: str) -> Pose:
    """From above onto the thing, with whatever goes wrong, and close; the pose at which it was grasped at last."""
    rng, faults, grasp = hand.rng, hand.faults, _grasp(hand, thing)
    way = [vary(along(grasp, -float(rng.uniform(*CLEAR))), rng, 0.012), along(grasp, -0.04), grasp]
    if faults.second_approach:
        way = list(approach_twice(way, rng))
    if faults.nudge:
        # one finger comes down beside the thing and pushes it a little
        aside = 0.5 * hand.scene.aperture - PLAY.loose[thing].half[1] + float(rng.uniform(0.004, 0.007))
        hand.go([*way[:-1], along(grasp, -0.005)])
        hand.go([grasp @ offset([0.0, float(rng.choice([-1.0, 1.0])) * aside, -0.005])], careful=True)
        grasp = Pose(hand.scene.pose(thing).p, grasp.q)
        way = [grasp]
    if faults.poor_grasp:
        hand.go([*way[:-1], along(grasp, -float(rng.uniform(0.006, 0.010)))])
        hand.fingers(True)
        hand.fingers(False)
        hand.go([along(grasp, -0.04)], careful=True)
        grasp = _grasp(hand, thing)
        way = [grasp]
    hand.go(way[:-1] or way, pause=faults.pause)
    hand.go([grasp], careful=True)
    hand.fingers(True)
    return grasp


def _put_down_and_take_again(hand: Hand, thing: str, grasp: Pose) -> Pose:
    """Up a little, and down again at the same place, as if thinking better of it; then again."""
    hand.go([moved(grasp, [0.0, 0.0, hand.rng.uniform(0.03, 0.06)])], careful=True)
    hand.rest(float(hand.rng.uniform(0.2, 0.6)))
    hand.go([moved(grasp, [0.0, 0.0, 0.001])], careful=True)
    hand.fingers(False)
    hand.go([along(grasp, -float(hand.rng.uniform(0.05, 0.08)))], careful=True)
    grasp = _grasp(hand, thing)
    hand.go([grasp], careful=True)
    hand.fingers(True)
    return grasp
