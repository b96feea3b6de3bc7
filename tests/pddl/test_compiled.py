"""Texts that our model cannot hold as they are: compiled, solved there, and the plans judged by the meaning of the texts."""

from __future__ import annotations

import pytest

from symskill_pddl.pddl.compiled import compiled
from symskill_pddl.pddl.symbolic import BeyondModelError
from symskill_pddl.pddl.task import read_task
from symskill_pddl.pddl.validate import validate_plan
from symskill_pddl.planning import Builtin, Kairos, Status
from symskill_pddl.planning.foreign import solve

HEAD = """(define (domain d) (:requirements :adl) (:types room thing - object box ball - thing) (:constants hall - room)
  (:predicates (at ?x - thing ?r - room) (in ?x - ball ?b - box) (open ?b - box) (lit ?r - room) (won) (seen ?x - thing))
"""
TASKS = {
    "a constant": ("(:action win :parameters () :precondition (at b1 hall) :effect (won))", "(won)", 1),
    "a constant in an effect": (
        "(:action bring :parameters (?x - thing) :effect (at ?x hall)) (:action win :parameters (?x - ball) "
        ":precondition (at ?x hall) :effect (won))",
        "(won)",
        2,
    ),
    "either way": (
        "(:action win :parameters (?x - ball) :precondition (or (lit hall) (exists (?b - box) (in ?x ?b))) :effect (won))",
        "(won)",
        1,
    ),
    "neither way": (
        "(:action win :parameters (?x - ball) :precondition (or (lit hall) (exists (?b - box) (and (in ?x ?b) (open ?b)))) "
        ":effect (won))",
        "(won)",
        None,
    ),
    "an implication for all": (
        "(:action light :parameters (?r - room) :effect (lit ?r)) (:action win :parameters () "
        ":precondition (forall (?x - ball) (imply (at ?x hall) (lit hall))) :effect (won))",
        "(won)",
        1,
    ),
    "two ways to act": (
        "(:action go :parameters (?b - box ?r - room) "
        ":effect (and (at ?b ?r) (forall (?x - ball) (when (in ?x ?b) (at ?x ?r)))))",
        "(and (at r1 hall) (not (at b2 hall)))",
        1,
    ),
    "a condition that is false": (
        "(:action peek :parameters (?b - box) :effect (when (not (open ?b)) (and (open ?b) (seen ?b))))",
        "(and (seen b1) (open b1))",
        1,
    ),
    "equal": (
        "(:action win :parameters (?x ?y - ball) :precondition (and (= ?x ?y) (in ?x b1)) :effect (seen ?y))",
        "(seen r1)",
        1,
    ),
    "either type": (
        "(:action see :parameters (?x - (either ball box)) :effect (seen ?x))",
        "(and (seen b1) (seen r1))",
        2,
    ),
    "a negative goal": ("(:action put-out :parameters (?x - ball ?b - box) :effect (not (in ?x ?b)))", "(not (in r1 b1))", 1),
    "a goal of two ways": ("(:action light :parameters (?r - room) :effect (lit ?r))", "(or (won) (lit hall))", 1),
    "a goal that exists": ("(:action see :parameters (?x - ball) :effect (seen ?x))", "(exists (?x - thing) (seen ?x))", 1),
    "a goal for all": ("(:action see :parameters (?x - thing) :effect (seen ?x))", "(forall (?x - thing) (seen ?x))", 3),
}


def task(name):
    actions, goal, _ = TASKS[name]
    domain = HEAD + actions.replace("b1 hall)", "?k hall)").replace("win :parameters ()", "win :parameters (?k - box)") + ")"
    problem = f"(define (problem p) (:domain d) (:objects b1 b2 - box r1 - ball) (:init (at b1 hall) (in r1 b1)) (:goal {goal}))"
    return read_task(domain.replace("(in ?x b1)", "(in ?x ?x1)").replace("(?x ?y - ball)", "(?x ?y - ball ?x1 - box)"), problem)


@pytest.mark.parametrize("name", TASKS)
def test_the_model_has_the_plans_of_the_text(name):
    given = task(name)
    length = TASKS[name][2]
    result = solve(Builtin(optimal=True), given)
    if length is None:
        assert result.status is Status.UNSOLVABLE
    else:
        assert len(result.unwrap()) == length
        validate_plan(given, result.unwrap())


@pytest.mark.skipif(not Kairos.installed(), reason="kairos is not installed")
@pytest.mark.parametrize("name", TASKS)
def test_a_planner_that_reads_the_text_agrees(name):
    assert (solve(Kairos(), task(name)).status is Status.SOLVED) == (TASKS[name][2] is not None)


@pytest.mark.parametrize(
    ("part", "what"),
    [
        ("(:functions (fuel)) (:action a :parameters () :precondition (> (fuel) 1) :effect (won))", "numeric conditions"),
        ("(:functions (fuel)) (:action a :parameters () :effect (increase (fuel) 1))", "numeric effects"),
        ("(:derived (won) (lit hall))", "derived predicates"),
        (
            "(:action a :parameters () :effect (and " + " ".join(f"(when (seen b{i}) (open b{i}))" for i in (1, 2)) * 4 + "))",
            "",
        ),
    ],
)
def test_what_the_model_cannot_hold_has_its_place(part, what):
    problem = "(define (problem p) (:domain d) (:objects r - ball) (:goal (won)))"
    domain = HEAD.replace("(:constants hall - room)", "(:constants hall - room b1 b2 - box)") + part + ")"
    if not what:  # four times the same two conditions are two
        assert len(compiled(read_task(domain, problem)).domain.operators) == 4
        return
    with pytest.raises(BeyondModelError, match=rf"<domain>:3:\d+: {what} are not supported by our own model"):
        compiled(read_task(domain, problem))
