"""How people play: lid and things from where they are to where they could be, on and on, until all was done often.

What comes next is drawn from what is possible in what is seen. What was seldom done, or not yet with the other objects as they
are now, is more likely. What fell beside its place is taken up again and put where it should have gone.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.human import Faults
from symskill_pddl.kitchen.demo_dish import DISHES, dish_of, fits, move_thing
from symskill_pddl.kitchen.demo_lid import PAN, RACK, lid_at, move_lid
from symskill_pddl.kitchen.layout import PLAY
from symskill_pddl.scene import Scene

OFTEN = 4
"""Play goes on until the lid, and things, were taken from and put to each of their places this often,"""
AT_LEAST_S = 290.0
"""and for at least so long [s]."""
MOST_MOVES = 45
FAULT_CHANCE = 0.12
"""Of each fault, in each move."""
AGAIN = 0.1
"""How likely the object that was moved last is moved next, compared with the others."""
SEEN_ENOUGH = 2.0
"""The higher, the more what was done already is avoided."""

Where = dict[str, str | None]


@dataclass(frozen=True)
class Move:
    """`obj` from `start` (None: from where it fell) to `end`."""

    obj: str
    start: str | None
    end: str


@dataclass(frozen=True)
class Played:
    """A move that was meant, and whether it came out so, by what is seen."""

    move: Move
    done: bool


def play(hand: Hand, _focus: str) -> tuple[Played, ...]:
    """Play until everything was done often, for long, and nothing lies about; what was meant, and what came of it."""
    (lid,) = PLAY.of_type("lid")
    played: list[Played] = []
    done: Counter[tuple[object, ...]] = Counter()
    while len(played) < MOST_MOVES and (move := _next(hand, lid, played, done)) is not None:
        at = seen_at(hand.scene, lid)
        hand.faults = Faults.draw(hand.rng, FAULT_CHANCE)
        if move.obj == lid:
            move_lid(hand, lid, move.end)
        else:
            move_thing(hand, move.obj, move.end)
        hand.rest(float(hand.rng.uniform(0.2, 0.8)))
        played.append(Played(move, seen_at(hand.scene, lid)[move.obj] == move.end))
        if played[-1].done:
            done.update(_facets(move, at))
    hand.leave()
    return tuple(played)


def seen_at(scene: Scene, lid: str) -> Where:
    """Where the lid and every thing are, by what is seen; None for what lies elsewhere."""
    return {lid: lid_at(scene, lid)} | {thing: dish_of(scene, thing) for thing in PLAY.of_type("thing")}


def _next(hand: Hand, lid: str, played: list[Played], done: Counter[tuple[object, ...]]) -> Move | None:
    at = seen_at(hand.scene, lid)
    for obj, where in at.items():
        if where is None:
            meant = next((p.move.end for p in reversed(played) if p.move.obj == obj), None)
            return Move(obj, None, meant or (RACK if obj == lid else DISHES[-1]))
    wanted = [(PLAY.loose[obj].type, end, place) for obj, places in _places(lid) for end in (0, 1) for place in places]
    if hand.scene.time >= AT_LEAST_S and all(done[facet] >= OFTEN for facet in wanted):
        return None
    moves = possible(hand.scene, at, lid)
    last = played[-1].move.obj if played else None
    weights = np.array(
        [
            (AGAIN if move.obj == last else 1.0) * np.prod([(1.0 + done[f]) ** -SEEN_ENOUGH for f in _facets(move, at)])
            for move in moves
        ]
    )
    return moves[int(hand.rng.choice(len(moves), p=weights / weights.sum()))]


def _places(lid: str) -> list[tuple[str, tuple[str, ...]]]:
    return [(lid, (PAN, RACK)), *((thing, DISHES) for thing in PLAY.of_type("thing"))]


def possible(scene: Scene, at: Where, lid: str) -> list[Move]:
    """Into and out of a pan only when it is open; to a dish only where there is room."""
    moves = []
    for obj, places in _places(lid):
        for end in places:
            start = at[obj]
            if end == start or (obj != lid and at[lid] == PAN and PAN in (start, end)):
                continue
            if obj == lid or fits(scene, end, obj):
                moves.append(Move(obj, start, end))
    return moves


def _facets(move: Move, at: Where) -> list[tuple[object, ...]]:
    """What a move shows: taking from one place, putting to another, and each of them with the other objects where they are."""
    kind = PLAY.loose[move.obj].type
    others = tuple((name, where) for name, where in at.items() if name != move.obj)
    ends = [(kind, i, place) for i, place in enumerate((move.start, move.end))]
    return [*ends, *((*end, others) for end in ends)]
