"""What is learned from one unsegmented recording of play, against the paper's table of operators and the problems it is for."""

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

import symskill_pddl
from symskill_pddl.demos import load_demos, load_truths
from symskill_pddl.evaluation.score import score
from symskill_pddl.learning import learn_symbols
from symskill_pddl.pddl import DIALECTS, exported, expressible
from symskill_pddl.planning import Builtin
from symskill_pddl.symbols import GRIPPER_OPEN, Absent, Atom, Domain, Parameter, Predicate, Problem, Type, validate

RECORDING = Path(symskill_pddl.__file__).parent / "data" / "play" / "Play.hdf5"
DISHES = ("drawer", "cookware", "container")
PICKED = {("lid", "cabinet"), ("lid", "cookware"), *(("thing", dish) for dish in DISHES)}
"""The ten operators of the paper's table are a pick and a place for each."""


@pytest.fixture(scope="module")
def learned():
    return learn_symbols(load_demos(RECORDING))


@pytest.fixture(scope="module")
def place_of(learned):
    """The predicate of each (type, reference type): one for each."""
    found = {c.predicate.types: c.predicate.name for c in learned.classifiers if len(c.predicate.types) == 2}
    assert len(found) == sum(len(c.predicate.types) == 2 for c in learned.classifiers)
    return found


@pytest.fixture(scope="module")
def domain(learned):
    types = sorted({t for demo in learned.demos for t in demo.objects.values()})
    predicates = (Predicate(GRIPPER_OPEN), *(c.predicate for c in learned.classifiers))
    return Domain("play", tuple(map(Type, types)), predicates, tuple(g.learned.operator for g in learned.groups))


def test_the_ten_operators_of_the_paper_with_their_effects(learned, place_of):
    assert set(place_of) == PICKED
    operators = {g.learned.operator.name: g.learned for g in learned.groups}
    assert len(operators) == 10
    fingers, seen = Atom(GRIPPER_OPEN), set()
    for o in operators.values():
        op = o.operator
        moved, ref = op.parameters[:2]
        at = Atom(place_of[moved.type, ref.type], (moved.name, ref.name))
        holds = Atom(f"gripper-holds-{moved.type}", (moved.name,))
        seen.add((o.kind, moved.type, ref.type))
        assert len(op.parameters) == 2
        if o.kind == "pick":
            assert (op.pre, op.add, op.delete) == ({fingers, at}, {holds}, {at, fingers})
        else:
            assert (op.pre, op.add, op.delete) == ({holds}, {at, fingers}, {holds})
        lid = Absent(Atom(place_of["lid", "cookware"], ("?any-lid", "?cookware")), (Parameter("?any-lid", "lid"),), True)
        assert op.absent == ({lid} if (moved.type, ref.type) == ("thing", "cookware") else set()), op.name
        assert o.support >= 4
    assert seen == {(kind, *pair) for kind in ("pick", "place") for pair in PICKED}


def test_every_dialect_can_say_it_because_two_lids_were_never_on_one_pan(domain):
    assert expressible(domain) == DIALECTS
    (stated,) = exported(domain, "strips").stated
    assert stated.operator == "place-lid-on-cookware"
    seen_two = replace(
        domain,
        operators=tuple(
            replace(op, absent=frozenset(replace(a, at_most_one=False) for a in op.absent)) for op in domain.operators
        ),
    )
    assert expressible(seen_two) == DIALECTS[1:]


def problems(place_of, things):
    """Every start of the lid and the things, with every place of the things as goal."""
    objects = tuple((t, t) for t in ("lid", "cabinet", *DISHES)) + tuple((t, "thing") for t in things)
    for lid, *start in product(("cabinet", "cookware"), *[DISHES] * len(things)):
        init = {Atom(GRIPPER_OPEN), Atom(place_of["lid", lid], ("lid", lid))}
        init |= {Atom(place_of["thing", dish], (t, dish)) for t, dish in zip(things, start, strict=True)}
        for end in product(DISHES, repeat=len(things)):
            goal = frozenset(Atom(place_of["thing", dish], (t, dish)) for t, dish in zip(things, end, strict=True))
            yield Problem("play", "play", objects, frozenset(init), goal)


def solve(domain, place_of, problem):
    """Solve, check, and see that nobody reaches into a covered pan."""
    plan = Builtin().solve(domain, problem).unwrap()
    validate(domain, problem, plan)
    covered, state = Atom(place_of["lid", "cookware"], ("lid", "cookware")), problem.init
    for step in plan.ground(domain, problem.object_types):
        if "thing" in step.name and "cookware" in step.name:
            assert covered not in state
        state = step.apply(state)


def test_all_162_problems_with_two_things_are_solved(domain, place_of):
    many = list(problems(place_of, "ab"))
    assert len(many) == 162
    for problem in many:
        solve(domain, place_of, problem)


def test_problems_with_three_things_are_solved(domain, place_of):
    many = list(problems(place_of, "abc"))
    assert len(many) == 1458
    for i in np.random.default_rng(0).choice(len(many), 60, replace=False):
        solve(domain, place_of, many[i])


def test_moves_movers_and_references_are_those_of_the_truth(learned):
    (demo,) = learned.demos
    s = score(learned, {demo.where: load_truths(RECORDING)[demo.name]})
    assert s.found == s.moves == s.movers[0]
    assert s.within(0.15) >= 0.95
    assert s.recall > 0.99
    assert s.precision > 0.95
