"""Broken goals of many kinds: none has a plan, and each is told why, word by word in `golden/why_not.txt`."""

from contextlib import suppress
from dataclasses import replace
from itertools import combinations, count
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_domains import atoms, breadth_first, covered_egg, domains, kitchen, problems

from symskill_pddl.pddl import read_domain, read_problem
from symskill_pddl.planning import Builtin, Effort, Status, why_not
from symskill_pddl.planning.conflicts import Pairs, forbidden
from symskill_pddl.planning.grounding import reachable
from symskill_pddl.symbols import Absent, Atom, Problem, State

GOLDEN = Path(__file__).parent / "golden" / "why_not.txt"


def without(*operators):
    return replace(kitchen(), operators=tuple(o for o in kitchen().operators if o.name not in operators))


def egg(goal, **changes):
    return replace(covered_egg(), goal=atoms(goal), **changes)


MATCHES = """(define (domain d) (:types thing - object candle match - thing)
  (:predicates (fresh ?m - match) (lit ?c - candle) (dry) (near ?a ?b - thing)
    (tool ?t - thing) (sharp ?t - thing) (cut ?t - thing))
  (:action light :parameters (?m - match ?c - candle)
    :precondition (and (fresh ?m) (dry)) :effect (and (lit ?c) (not (fresh ?m))))
  (:action put-beside :parameters (?a ?b - thing)
    :precondition (and (dry) (not (= ?a ?b))) :effect (near ?a ?b))
  (:action rain :parameters () :precondition (dry) :effect (not (dry)))
  (:action cut :parameters (?t ?by - thing)
    :precondition (and (tool ?by) (sharp ?by) (not (= ?t ?by))) :effect (cut ?t))
  (:action sharpen :parameters (?t ?by - thing)
    :precondition (and (cut ?t) (sharp ?by) (not (= ?t ?by))) :effect (sharp ?t)))"""


def matches(goal, init="(fresh m) (dry)", objects="m - match c d - candle"):
    domain = read_domain(MATCHES)
    return domain, read_problem(f"(define (problem p) (:objects {objects}) (:init {init}) (:goal (and {goal})))", domain)


BROKEN = {
    "no operator adds it": lambda: (without("pick-lid", "place-lid"), egg("lid-on-pan lid-a pan-c")),
    "a static fact is missing": lambda: matches("(cut c)", "(sharp m)"),
    "each step needs the other one first": lambda: matches("(cut c)", "(tool m)"),
    "no object of a type": lambda: matches("(lit c)", "(dry)", "c - candle"),
    "what it needs, needs what cannot be": lambda: (without("pick-lid"), egg("lid-on-pan lid-a pan-c, gripper-open")),
    "nothing opens the gripper": lambda: (kitchen(), egg("gripper-holds-food egg", init=atoms("food-in-pan egg pan-c"))),
    "one thing with itself": lambda: matches("(near c c)"),
    "a lid that nobody takes off": lambda: (without("pick-lid"), egg("food-in-pan egg pan-c")),
    "two things in one hand": lambda: (kitchen(), egg("gripper-holds-lid lid-a, gripper-holds-lid lid-b, food-in-pan egg pan-a")),
    "an open hand that holds": lambda: (kitchen(), egg("gripper-holds-food egg, gripper-open")),
    "one match for two candles": lambda: matches("(lit c) (lit d)"),
    "what was used up is to be there still": lambda: matches("(lit c) (fresh m)"),
    "two places at once": lambda: (kitchen(), egg("food-in-pan egg pan-c, food-in-pan egg pan-d")),
    "no operators at all": lambda: (replace(kitchen(), operators=()), egg("gripper-holds-food egg")),
    "a fact that holds for ever is forbidden": lambda: barred_egg(),
}


def barred_egg() -> tuple[object, Problem]:
    """Nothing may be picked up while the alarm rings, and nobody can turn it off."""
    domain = kitchen()
    ringing = Absent(Atom("ringing"))
    operators = tuple(replace(o, absent=o.absent | {ringing}) if o.name == "pick-lid" else o for o in domain.operators)
    alarmed = replace(domain, predicates=(*domain.predicates, replace(domain.predicates[0], name="ringing", types=())))
    init: State = covered_egg().init | {Atom("ringing")}
    return replace(alarmed, operators=operators), egg("food-in-pan egg pan-c", init=init)


def said():
    lines = []
    for name, make in BROKEN.items():
        domain, problem = make()
        lines += [f"{name}:", *(f"    {line}" for line in why_not(domain, problem))]
    return "".join(line + "\n" for line in lines)


@pytest.mark.parametrize("name", BROKEN)
def test_it_has_no_plan_and_a_reason(name):
    domain, problem = BROKEN[name]()
    assert Builtin().solve(domain, problem).status is Status.UNSOLVABLE
    lines = why_not(domain, problem)
    assert lines
    assert not any("\n" in line for line in lines)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_what_is_said_to_be_impossible_is(data):
    """Against breadth-first search by the plain semantics: no reason is ever given for what can be done."""
    domain = data.draw(domains())
    problem = data.draw(problems(domain))
    steps, reached = reachable(domain, problem)
    names = {a for a in reached if len(set(a.args)) == len(a.args)}
    for one, two in list(combinations(sorted(names), 2))[:6]:
        asked = replace(problem, goal=frozenset({one, two}))
        lines = (*forbidden(steps, problem.init, asked.goal), *Pairs(steps, problem.init, 10**6).reasons({one}, {two}))
        with suppress(OverflowError):
            assert not lines or breadth_first(domain, asked) is None


def test_the_reasons_word_by_word():
    assert said() == GOLDEN.read_text()


def test_the_clock_plays_no_part(monkeypatch):
    """On a machine where an hour passes between two looks at the clock, the same is said."""
    hours = count(0.0, 3600.0)
    monkeypatch.setattr("time.monotonic", lambda: next(hours))
    assert said() == GOLDEN.read_text()
    assert next(hours) > 7200.0  # it was looked at


BOTH = "gripper-holds-lid lid-a, gripper-holds-lid lid-b, food-in-pan egg pan-a"


@pytest.mark.parametrize(
    ("goal", "effort", "lines"),
    [
        (BOTH, Effort(ground_operators=3), ["the problem is too large to be explained"]),
        (
            "lid-on-pan lid-a pan-c, gripper-open",
            Effort(facts=0),
            ["the problem is too large to be explained", "the nearest goal that can be reached: (gripper-open)"],
        ),
        (
            BOTH,
            Effort(pairs=0),
            [
                "each goal atom could be reached by deletion-free steps, but (gripper-holds-lid lid-b) not together with "
                "(food-in-pan egg pan-a) (gripper-holds-lid lid-a): deletes or negative conditions stand against it",
                "the nearest goal that can be reached: (food-in-pan egg pan-a) (gripper-holds-lid lid-a)",
            ],
        ),
        (
            BOTH,
            Effort(pairs=0, searched=0),
            ["a part of the goal that can be reached: (food-in-pan egg pan-a) (gripper-holds-lid lid-a)"],
        ),
    ],
)
def test_what_is_too_much_work_is_left_out(goal, effort, lines):
    domain = without("pick-lid") if "lid-on-pan" in goal else kitchen()
    assert list(why_not(domain, egg(goal), effort)) == lines


def test_a_large_problem_gets_an_answer_of_counted_work():
    pans = [f"pan-{i}" for i in range(40)]
    foods = [f"egg-{i}" for i in range(12)]
    problem = Problem(
        "many",
        "kitchen",
        (*((f, "food") for f in foods), *((p, "pan") for p in pans)),
        atoms("gripper-open") | {Atom("food-in-pan", (f, p)) for f, p in zip(foods, pans, strict=False)},
        frozenset(Atom("food-in-pan", (f, pans[-1])) for f in foods) | atoms("gripper-holds-food egg-0"),
    )
    found = why_not(kitchen(), problem, Effort(searched=20_000))
    assert found == why_not(kitchen(), problem, Effort(searched=20_000))
    assert "can be reached: (food-in-pan egg-" in found[-1]
