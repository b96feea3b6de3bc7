"""The simulator's word on what happened, against what the demonstrator set out to do."""

import numpy as np
import pytest

from symskill_pddl.kitchen import make
from symskill_pddl.kitchen.record import record_with_truth
from symskill_pddl.kitchen.truth import TruthLog
from symskill_pddl.scene import Command

pytestmark = pytest.mark.simulation


def test_food_is_moved_once_from_the_cabinet_to_the_counter():
    (demo,), truths = record_with_truth("PnPCabToCounter", 1, 3)
    (move,) = truths["demo_0"].moves
    assert (move.before, move.after) == ("cabinet", "counter")
    assert demo.objects[move.obj] == "food"
    i, j = np.searchsorted(demo.times, [move.start_s, move.stop_s])
    assert np.linalg.norm(demo.pose(move.obj).p[: i - 1] - demo.pose(move.obj).p[0], axis=-1).max() < 0.01
    assert np.linalg.norm(demo.pose(move.obj).p[j:] - demo.pose(move.obj).p[-1], axis=-1).max() < 0.003
    relations = truths["demo_0"].relations
    assert relations["at", move.obj, "cabinet"][0]
    assert not relations["at", move.obj, "cabinet"][-1]
    assert relations["at", move.obj, "counter"][-1]
    assert not relations["at", move.obj, "counter"][(i + j) // 2]


def test_the_door_is_moved_twice():
    _, truths = record_with_truth("OpenSingleDoor", 1, 3)
    moves = truths["demo_0"].moves
    assert [(m.obj, m.before, m.state_before, m.state_after) for m in moves] == [
        ("door", "cabinet", "shut", "between"),
        ("door", "cabinet", "between", "open"),
    ]
    assert truths["demo_0"].relations["open", "door", "cabinet"].sum() > 50


def test_nobody_moves_what_falls_by_itself_or_stands():
    kitchen = make("TurnOnStove", 0)
    log = TruthLog(kitchen)
    for _ in range(20):
        kitchen.step(Command(np.zeros(6), False))
    assert log.truth().moves == ()
    relations = log.truth().relations
    assert all(len(row) == 21 for row in relations.values())
    assert {obj for kind, obj, _ in relations if kind == "at"} == set(kitchen.physics.loose)
    assert not relations["open", "knob", "stove"].any()
