"""Foreign texts on their way to planners: as they are written, and never with a wrong "unsolvable"."""

from __future__ import annotations

import pytest

from symskill_pddl.errors import InputError, ParseError
from symskill_pddl.pddl import read_task, validate_plan, write_plan
from symskill_pddl.pddl.symbolic import BeyondModelError
from symskill_pddl.planning import Builtin, Command, FastDownward, Limits, Pyperplan, Status, get, planners
from symskill_pddl.planning.command import proof
from symskill_pddl.planning.diverse import diverse
from symskill_pddl.planning.foreign import explained, solve
from symskill_pddl.planning.text import Answer

GREET = """(define (domain d) (:predicates (at ?x) (over ?x) (greet ?a ?b) (all))
  (:action greet :parameters (?a ?b) :precondition (and (at ?a) (over ?b)) :effect (greet ?a ?b))
  (:action go :parameters (?a ?b) :precondition (at ?a) :effect (and (at ?b) (not (at ?a)))))"""
HOME = """(define (problem p) (:domain d) (:objects greet home d) (:init (at home) (over home))
  (:goal (and (greet home home) (at d))))"""
WAYS = """(define (domain w) (:requirements :strips) (:predicates (here) (there) (done))
  (:action walk :parameters () :precondition (here) :effect (there))
  (:action ride :parameters () :precondition (here) :effect (there))
  (:action work :parameters () :precondition (there) :effect (done)))"""
WORK = "(define (problem p) (:domain w) (:init (here)) (:goal (done)))"


@pytest.mark.parametrize("planner", [p.name for p in planners()])
def test_names_of_pddl_itself_and_one_object_twice(planner):
    """A predicate `at`, one like an action, an object like both; parameters that may be one object."""
    task = read_task(GREET, HOME)
    result = solve(get(planner), task)
    assert result.status is Status.SOLVED, result.messages
    assert result.plan.steps == (("greet", ("home", "home")), ("go", ("home", "d")))
    assert validate_plan(task, result.plan) == 2.0


def test_a_text_reaches_a_program_byte_for_byte(tmp_path):
    domain, problem = f"; mine\t\n{GREET.upper()}\r\n", HOME + "  ;; end"
    script = tmp_path / "copy.sh"
    script.write_text(
        f"cp $1 {tmp_path}/d.pddl; cp $2 {tmp_path}/p.pddl; echo 'step 0: GREET HOME HOME'; echo '     1: GO HOME D'\n"
    )
    result = solve(Command(f"bash {script} {{domain}} {{problem}}"), read_task(domain, problem))
    assert len(result.unwrap()) == 2
    assert (tmp_path / "d.pddl").read_bytes() == domain.encode()
    assert (tmp_path / "p.pddl").read_bytes() == problem.encode()


def test_the_last_plan_that_is_one_is_taken_and_it_is_said(tmp_path):
    script = tmp_path / "say.sh"
    said = "Solution 1\n(walk)\n(ride)\n(work)\nSolution 2\n(walk)\n(work)\nSolution 3\n(work)\n"
    script.write_text(f"cat <<'EOF'\n{said}EOF\n")
    result = solve(Command(f"bash {script} {{domain}} {{problem}}"), read_task(WAYS, WORK))
    assert result.plan.steps == (("walk", ()), ("work", ()))
    assert any("a later plan is none" in m and "needs (there)" in m for m in result.messages)


@pytest.mark.parametrize(
    ("said", "status", "found"),
    [
        ("The task is not unsolvable, but I ran out of memory", 22, ""),
        ("Completely explored state space -- no solution!", 11, "explored state space -- no solution"),
        ("Completely explored state space -- no solution!", 12, ""),
        ("problem proven unsolvable.", 0, "unsolvable"),
        ("ff: goal can be simplified to FALSE. No plan will solve it", 0, "No plan will solve it"),
        ("no solution!", 1, ""),
        ("the problem might be unsolvable", 0, ""),
        ("checking whether it is unsolvable\nfound nothing", 0, ""),
    ],
)
def test_only_a_proof_is_a_proof(said, status, found):
    assert proof(said, status) == found


def test_a_failure_blames_nobody():
    result = solve(Command("false {domain} {problem}"), read_task(WAYS, WORK))
    assert result.status is Status.FAILED
    assert explained(read_task(WAYS, WORK), result) == ()
    proved = solve(Builtin(), read_task(WAYS, WORK.replace("(:init (here))", "(:init)")))
    assert proved.status is Status.UNSOLVABLE
    assert any(
        "needs (there)" in line or "(here)" in line for line in explained(read_task(WAYS, WORK.replace("(here)", "")), proved)
    )


def test_costs_are_those_of_the_text():
    domain = """(define (domain c) (:requirements :action-costs) (:types place) (:predicates (at ?p - place))
      (:functions (total-cost) - number (far ?a ?b - place) - number)
      (:action go :parameters (?a ?b - place) :precondition (at ?a)
        :effect (and (at ?b) (not (at ?a)) (increase (total-cost) (far ?a ?b))))
      (:action fall :parameters (?a ?b - place) :precondition (at ?a)
        :effect (and (at ?b) (not (at ?a)) (increase (total-cost) 5))))"""
    problem = """(define (problem p) (:domain c) (:objects x y - place) (:init (at x) (= (far x y) 7) (= (total-cost) 0))
      (:goal (at y)) (:metric minimize (total-cost)))"""
    result = solve(Builtin(), read_task(domain, problem))
    assert result.plan.cost in (5.0, 7.0)
    assert any("count as 1" in m for m in result.messages)


def test_a_metric_to_maximize_is_refused_with_its_place():
    task = read_task(
        WAYS.replace("(:predicates", "(:functions (total-cost)) (:predicates"), WORK[:-1] + "\n (:metric maximize (total-cost)))"
    )
    with pytest.raises(ParseError, match=r"<problem>:2:2: no planner here follows a metric to maximize"):
        solve(get("auto"), task)
    assert len(solve(Builtin(), task, any_plan=True).unwrap()) == 2


def test_plans_that_differ():
    plans = [r.unwrap().steps for r in diverse(Builtin(), read_task(WAYS, WORK), 5)]
    assert len(plans) == len(set(plans)) == 2
    with pytest.raises(InputError, match="at least one plan"):
        next(diverse(Builtin(), read_task(WAYS, WORK), 0))
    (none,) = diverse(Builtin(), read_task(WAYS, WORK.replace("(here)", "")), 3)
    assert none.status is Status.UNSOLVABLE
    with pytest.raises(BeyondModelError):
        next(diverse(Builtin(), read_task(WAYS.replace("(:action walk", "(:derived (done) (here)) (:action walk"), WORK), 2))


def test_what_no_model_holds_goes_to_those_that_read():
    domain = WAYS.replace("(:action walk", "(:derived (done) (and (there) (here))) (:action walk").replace(
        ":effect (done)", ":effect (there)"
    )
    result = solve(Pyperplan(), read_task(domain, WORK), Limits(time_s=5.0))
    assert result.status is Status.FAILED
    assert "derived predicates are not supported by our own model" in result.messages[0]
    assert "planners that read PDDL themselves may take it" in result.messages[0]
    assert write_plan(solve(get("auto"), read_task(domain, WORK)).unwrap()).startswith(("(walk)", "(ride)"))


def test_fast_downward_s_incomplete_search_is_no_proof_with_axioms(monkeypatch):
    said = Answer(Status.UNSOLVABLE, messages=("fast-downward ended with status 12: no plan exists",))
    monkeypatch.setattr(FastDownward, "load", lambda _self, _text: lambda _problem, _limits: said)
    assert solve(FastDownward(), read_task(WAYS, WORK)).status is Status.UNSOLVABLE
    rule = "(:derived (done) (exists (?x) (= ?x ?x))) (:action walk"
    assert solve(FastDownward(), read_task(WAYS.replace("(:action walk", rule), WORK)).status is Status.FAILED
