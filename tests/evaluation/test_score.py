"""Scores on hand-made truths: what is right counts, what is made wrong on purpose is seen."""

from dataclasses import replace

import numpy as np
import pytest
from synthetic import record

from symskill_pddl.demos import Move, Truth
from symskill_pddl.evaluation.score import predicate_frames, score
from symskill_pddl.learning import learn_symbols


@pytest.fixture(scope="module")
def learned():
    return learn_symbols((*record("PnPCabToCounter", 3, faults=False), *record("OpenSingleDoor", 3, faults=False)))


def truth_from(found, demo):
    """The truth as if learning were right about everything."""
    moves, own = [], [label for label in found.relations.labels if label.episode.demo is demo]
    for k, label in enumerate(own):
        e = label.episode
        states = (("shut", "between"), ("between", "open"))[k] if e.type == "door" else ("", "")
        begin, end = float(demo.times[e.start]), float(demo.times[e.stop])
        moves.append(Move(e.obj, begin, end, label.start_ref, label.end_ref, *states))
    relations = {
        ("at", *atom.args): value
        for atom, value in found.truths[demo.where].items()
        if atom.predicate in ("food-in-cabinet", "food-on-counter")
    }
    return Truth(tuple(moves), relations)


@pytest.fixture(scope="module")
def truths(learned):
    return {demo.where: truth_from(learned, demo) for demo in learned.demos}


def test_all_is_right_against_itself(learned, truths):
    s = score(learned, truths)
    assert (s.moves, s.found, s.spurious) == (9, 9, 0)
    assert s.movers == (9, 9)
    assert s.references == (18, 18)
    assert set(s.boundary_errors_s) == {0.0}
    assert s.within(0.0) == s.precision == s.recall == 1.0
    assert len(s.operators) == 6
    assert all(s.operators.values())
    assert s.tasks == {"OpenSingleDoor": True, "PnPCabToCounter": True}
    assert s.extra_operators == ()


def changed(truths, where, **how):
    truth = truths[where]
    return {**truths, where: replace(truth, moves=tuple(replace(m, **how) for m in truth.moves))}


def test_what_is_wrong_is_seen(learned, truths):
    food = next(w for w in truths if "PnP" in w)
    assert score(learned, changed(truths, food, obj="counter")).movers == (8, 9)
    assert score(learned, changed(truths, food, after="cabinet")).references == (17, 18)
    late = score(learned, changed(truths, food, start_s=truths[food].moves[0].start_s + 0.3))
    assert min(late.boundary_errors_s) == pytest.approx(-0.3)
    assert late.within(0.15) == pytest.approx(17 / 18)
    elsewhen = score(learned, changed(truths, food, start_s=0.0, stop_s=0.2))
    assert (elsewhen.found, elsewhen.spurious) == (8, 1)


def test_an_operator_of_two_kinds_is_no_operator(learned, truths):
    """Two kinds of places that learning did not tell apart: neither is recovered."""
    where = sorted(w for w in truths if "PnP" in w)
    mixed = {**truths, **{w: changed(truths, w, after="cabinet")[w] for w in where[:2]}}
    s = score(learned, mixed)
    assert not any(done for kind, done in s.operators.items() if kind[0] == "place" and kind[1] == "food")
    assert not s.tasks["PnPCabToCounter"]
    assert s.tasks["OpenSingleDoor"]
    assert "place-food-on-counter" in s.extra_operators


def test_frames_are_counted_both_ways(learned, truths):
    demo = next(d for d in learned.demos if d.task == "PnPCabToCounter")
    (move,) = truths[demo.where].moves
    never = np.zeros(len(demo), bool)
    held = truths[demo.where].relations["at", move.obj, "counter"]
    judged = [(demo, Truth((), {("at", move.obj, "counter"): never, ("at", move.obj, "cabinet"): ~never}))]
    right, wrong, missed = predicate_frames(learned.classifiers, learned.gripper, judged)
    inside = truths[demo.where].relations["at", move.obj, "cabinet"]
    assert (right, wrong, missed) == (inside.sum(), held.sum(), (~inside).sum())
