"""The person who plays does everything the scene allows, often, in varied order, and nothing that it does not allow."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import symskill_pddl
from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.human import Faults, Person
from symskill_pddl.demos import load_demos
from symskill_pddl.demos.truth import load_truths
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import make
from symskill_pddl.kitchen.demo_dish import dish_of, fits, move_thing
from symskill_pddl.kitchen.demo_lid import lid_at, move_lid
from symskill_pddl.kitchen.demo_play import AT_LEAST_S, OFTEN, Move, possible, seen_at
from symskill_pddl.kitchen.judges import covers, in_rack, inside
from symskill_pddl.kitchen.layout import PLAY
from symskill_pddl.scene import Scene

SHIPPED = Path(symskill_pddl.__file__).parent / "data" / "play" / "Play.hdf5"
HOMES = {
    "stove": (0.55, -0.02),
    "dish-rack": (0.50, -0.31),
    "pan": (0.55, -0.02),
    "red-plate": (0.40, 0.22),
    "white-plate": (0.58, 0.22),
}


def scene(lid_on: str, **things: tuple[str, float]) -> Scene:
    """A scene by hand: the dishes at home, things in a dish at some x, the lid on the pan or in the rack."""
    at = {name: (*xy, {"pan": 0.024, "dish-rack": 0.012}.get(name, 0.0075)) for name, xy in HOMES.items()}
    at["lid"] = (*HOMES[lid_on], at[lid_on][2] + (0.057 - 0.012 if lid_on == "pan" else 0.012 + 0.039))
    for name, (dish, x) in things.items():
        floor = PLAY.loose[dish].shape.floor_z  # type: ignore[union-attr]
        at[name] = (at[dish][0] + x, at[dish][1], at[dish][2] + floor + PLAY.loose[name].half[2])
    p = np.array([at.get(name, (0.0, 0.0, 0.0)) for name in PLAY.types])
    T = Pose(p, np.tile([1.0, 0.0, 0.0, 0.0], (len(p), 1)))
    return Scene(0.0, Pose.identity(), 0.08, False, dict(PLAY.types), T)


def test_where_things_are_seen() -> None:
    seen = seen_at(scene("dish-rack", block=("pan", 0.0), bread=("red-plate", 0.03)), "lid")
    assert seen == {"lid": "dish-rack", "block": "pan", "bread": "red-plate"}
    fallen = scene("dish-rack", block=("pan", 0.15), bread=("red-plate", 0.0))
    assert dish_of(fallen, "block") is None


def test_a_covered_pan_is_left_alone() -> None:
    covered = scene("pan", block=("pan", 0.0), bread=("red-plate", 0.0))
    assert lid_at(covered, "lid") == "pan"
    moves = possible(covered, seen_at(covered, "lid"), "lid")
    assert moves == [Move("lid", "pan", "dish-rack"), Move("bread", "red-plate", "white-plate")]
    opened = scene("dish-rack", block=("pan", 0.03), bread=("red-plate", 0.0))
    assert {(m.obj, m.end) for m in possible(opened, seen_at(opened, "lid"), "lid")} == {
        ("lid", "pan"),
        ("block", "white-plate"),
        ("bread", "white-plate"),
        ("bread", "pan"),
    }


def test_a_second_thing_needs_room() -> None:
    assert fits(scene("pan", block=("red-plate", 0.03), bread=("white-plate", 0.0)), "red-plate", "bread")
    assert not fits(scene("pan", block=("red-plate", 0.01), bread=("white-plate", 0.0)), "red-plate", "bread")


@pytest.mark.simulation
def test_lid_and_things_go_where_they_are_to_go() -> None:
    kitchen = make("PlayServe", 1)
    hand = Hand(kitchen, Person(speed_m_s=0.18), Faults(poor_grasp=True), np.random.default_rng(0))
    assert covers(kitchen.physics, "lid", "pan")
    move_lid(hand, "lid", "dish-rack")
    assert in_rack(kitchen.physics, "lid", "dish-rack")
    hand.faults = Faults(nudge=True)
    move_thing(hand, "block", "white-plate")
    assert inside(kitchen.physics, "block", "white-plate")
    hand.faults = Faults(second_approach=True)
    move_lid(hand, "lid", "pan")
    assert covers(kitchen.physics, "lid", "pan")


def test_the_shipped_play_shows_every_operator_often_and_with_the_others_in_many_places() -> None:
    (demo,) = load_demos(SHIPPED)
    assert AT_LEAST_S <= demo.times[-1] < 480.0
    moves = load_truths(SHIPPED)[demo.name].moves
    shown = Counter[tuple[str, str, str | None]]()
    company: dict[tuple[str, str, str | None], set[tuple[str | None, ...]]] = {}
    for move in moves:
        kind, now = demo.objects[move.obj], demo.scene(int(np.searchsorted(demo.times, move.start_s)) - 1)
        others = tuple(where for name, where in seen_at(now, "lid").items() if name != move.obj)
        for way, place in (("pick", move.before), ("place", move.after)):
            shown[kind, way, place] += 1
            company.setdefault((kind, way, place), set()).add(others)
    places = [("lid", place) for place in ("pan", "dish-rack")] + [("thing", d) for d in ("pan", "red-plate", "white-plate")]
    for kind, place in places:
        for way in ("pick", "place"):
            assert shown[kind, way, place] >= OFTEN
            assert len(company[kind, way, place]) >= 3
    assert SHIPPED.stat().st_size < 1_000_000
