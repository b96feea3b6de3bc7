"""How people take food out of the cabinet and put it in: grasped across its thin side, at one pitch from the pick to the place.

The pitch stays, because food that is turned between the fingers tumbles when it is put down. The way in and the way out are straight
along the approach direction, clear of the cabinet's floor.
"""

from __future__ import annotations

import numpy as np

from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.demo_hand import Hand, along, facing, moved
from symskill_pddl.kitchen.human import approach_twice, vary

HALF_TURN = np.pi


def grasp_of(hand: Hand, food: str, pitch: float) -> Pose:
    """A hand about the middle of the food, its fingers across the thin side, its yaw as near to straight ahead as the food lets it."""
    T = hand.scene.pose(food)
    forward = T.rotate([1.0, 0.0, 0.0])
    yaw = float(np.arctan2(forward[1], forward[0]))
    yaw -= np.pi * np.round(yaw / np.pi)
    p = T.p + hand.rng.uniform([-0.003, -0.002, 0.0], [0.003, 0.002, 0.004])
    return Pose(p, facing(yaw, pitch, hand.T))


def to_counter(hand: Hand, food: str) -> None:
    """Out of the cabinet, onto the counter."""
    rng = hand.rng
    grasp = grasp_of(hand, food, float(np.radians(rng.uniform(37.0, 44.0))))
    _pick(hand, food, grasp, reach_m=0.20)
    up = moved(grasp, [0.0, 0.0, rng.uniform(0.03, 0.06)])
    front = layout.CABINET.center[0] - layout.CABINET.half[0] - 0.12
    out = Pose(np.array([front, 0.5 * up.p[1], up.p[2] + 0.03]), up.q)
    place = _place_pose(hand, grasp, np.array([0.44, 0.02, 0.0]) + rng.uniform([-0.05, -0.08, 0.0], [0.05, 0.08, 0.0]), support_was=0.47)
    _carry(hand, [up, vary(out, rng, 0.015), moved(place, [0.0, 0.0, 0.10]), place])
    _let_go(hand)


def to_cabinet(hand: Hand, food: str) -> None:
    """From the counter into the cabinet."""
    rng = hand.rng
    grasp = grasp_of(hand, food, float(np.radians(rng.uniform(40.0, 48.0))))
    _pick(hand, food, grasp, reach_m=0.12)
    up = moved(grasp, [0.0, 0.0, rng.uniform(0.06, 0.09)])
    place = _place_pose(hand, grasp, np.array([0.73, -0.10, 0.47]) + rng.uniform([-0.03, -0.06, 0.0], [0.03, 0.06, 0.0]), support_was=0.0)
    front = layout.CABINET.center[0] - layout.CABINET.half[0] - 0.13
    before = Pose(np.array([front, 0.7 * place.p[1], place.p[2] + 0.07]), place.q)
    _carry(hand, [up, vary(before, rng, 0.015), moved(place, [-0.04, 0.0, 0.05]), place])
    _let_go(hand)


def _place_pose(hand: Hand, grasp: Pose, p: np.ndarray, support_was: float) -> Pose:
    """Hand pose that puts the food down over `p` (3,), a point of the support; the grasp keeps its height over the support."""
    yaw = float(np.arctan2(*grasp.rotate([0.0, 0.0, 1.0])[[1, 0]]))
    pitch = float(-np.arcsin(grasp.rotate([0.0, 0.0, 1.0])[2]))
    turned = yaw * hand.rng.uniform(0.0, 0.6)
    height = grasp.p[2] - support_was + 0.002
    return Pose(p + np.array([0.0, 0.0, height]), facing(turned, pitch, hand.T))


def _pick(hand: Hand, food: str, grasp: Pose, reach_m: float) -> None:
    rng, faults = hand.rng, hand.faults
    way = [vary(along(grasp, -reach_m), rng, 0.012), along(grasp, -0.07), grasp]
    hand.go(approach_twice(way, rng) if faults.second_approach else way, pause=faults.pause)
    if faults.poor_grasp:
        hand.fingers(True)
        hand.fingers(False)
        hand.go([along(hand.T, -0.03)], careful=True)
        hand.go([grasp], careful=True)
    hand.fingers(True)


def _carry(hand: Hand, way: list[Pose]) -> None:
    hand.go(way)
    hand.rest(0.2)


def _let_go(hand: Hand) -> None:
    hand.fingers(False)
    hand.go([along(hand.T, -0.12)])
    hand.leave()
