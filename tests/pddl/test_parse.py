import sys
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_domains import atoms, covered_egg, domains, kitchen, problems

from symskill_pddl.errors import ParseError
from symskill_pddl.pddl import DIALECTS, Names, exported, read_atoms, read_domain, read_problem, write_domain, write_problem
from symskill_pddl.symbols import Absent, Atom, Domain, Operator, Parameter, Predicate, Problem, Type

GOLDEN = Path(__file__).parent / "golden"


@pytest.mark.parametrize("dialect", DIALECTS)
@settings(max_examples=250, deadline=None)
@given(st.data())
def test_writing_and_reading_is_identity(dialect, data):
    """A thousand random domains, each with a problem."""
    domain = data.draw(domains(quantified=dialect != "strips"))
    problem = data.draw(problems(domain))
    form = exported(domain, dialect)
    read = read_domain(write_domain(domain, dialect=dialect))
    assert read == form.domain
    assert read_problem(write_problem(problem, domain, dialect=dialect), read) == form.problem(problem)


@pytest.mark.parametrize("dialect", DIALECTS)
def test_the_kitchen_comes_back(dialect):
    form = exported(kitchen(), dialect)
    text = write_domain(kitchen(), dialect=dialect)
    assert read_domain(text) == form.domain
    assert read_domain(text.upper()) == form.domain
    assert read_problem(write_problem(covered_egg(), kitchen(), dialect=dialect), form.domain) == form.problem(covered_egg())


def test_what_others_write():
    text = """
    ; by hand
    (DEFINE (DOMAIN Blocks) (:requirements :adl)
      (:types block - object arm)
      (:predicates (on ?x ?y - block) (free ?a - arm) (anything ?z))
      (:functions (total-cost) - number)
      (:action Stack :parameters (?x ?y - block ?a - arm)
        :precondition (and (free ?a) (and (not (on ?y ?x)) (not (= ?x ?y)))
                           (forall (?z - block) (and (not (on ?z ?y)) (not (on ?z ?x)))))
        :effect (and (on ?x ?y) (increase (total-cost) 2.5)))
      (:action noop :parameters () :precondition () :effect (and)))
    """
    z = (Parameter("?z", "block"),)
    assert read_domain(text) == Domain(
        "blocks",
        (Type("block"), Type("arm")),
        (Predicate("on", ("block", "block")), Predicate("free", ("arm",)), Predicate("anything", ("object",))),
        (
            Operator(
                "stack",
                (Parameter("?x", "block"), Parameter("?y", "block"), Parameter("?a", "arm")),
                atoms("free ?a"),
                atoms("on ?x ?y"),
                frozenset(),
                absent=frozenset({Absent(Atom("on", ("?y", "?x"))), *(Absent(Atom("on", ("?z", v)), z) for v in ("?x", "?y"))}),
                cost=2.5,
                distinct=frozenset({("?x", "?y")}),
            ),
            Operator("noop", (), frozenset(), frozenset(), frozenset(), cost=0.0),
        ),
    )


def of_others():
    """Domains by other people, as they come with unified-planning; none where that is not installed."""
    found = find_spec("unified_planning")
    return sorted((Path(found.origin).parent / "test" / "pddl").glob("*/domain.pddl")) if found and found.origin else []


@pytest.mark.parametrize("path", of_others(), ids=lambda p: p.parent.name)
def test_domains_of_others_come_back_or_are_refused_with_their_place(path):
    text = path.read_text()
    refusal, domain = None, None
    try:
        domain = read_domain(text, path.name)
    except ParseError as error:
        refusal = error
    if domain is None:
        assert "not supported" in str(refusal) or "supported is" in str(refusal)
        assert refusal.line > 1
        return
    names = Names.of(domain)
    mine = names.domain(domain)
    dialect = "temporal" if ":durative-action" in text else "costs"
    form = exported(mine, dialect)
    assert read_domain(write_domain(mine, dialect=dialect)) == form.domain
    assert names.inverse().domain(mine) == domain


def test_some_domains_of_others_lie_in_the_fragment():
    fine = 0
    for path in of_others():
        with suppress(ParseError):
            fine += bool(read_domain(path.read_text()).operators)
    assert fine >= 1 or not of_others()


def test_what_is_asked_for_and_not_used_does_no_harm():
    asked = "(:requirements :strips :telepathy :fluents) (:functions (fuel) - number) (:constants)"
    text = f"(define (domain d) {asked} (:predicates (q)))"
    assert read_domain(text) == Domain("d", (), (Predicate("q"),), ())


D = "(define (domain d) (:types pan) (:predicates (p ?x - pan) (q)) "
A = D + "(:action a :parameters (?x - pan) "
T = D + "(:durative-action a :parameters () :duration (= ?duration 1) "
DOMAIN_ERRORS = {
    "empty": "",
    "not-a-list": "domain",
    "not-define": "(domain d)",
    "no-name": "(define (domain))",
    "two-domains": "(define (domain d)) (define (domain e))",
    "unclosed": "(define (domain d)\n  (:types a)",
    "closed-twice": "(define (domain d)))",
    "too-deep": "(" * 101,
    "bad-character": '(define (domain d)\n  (:types "a"))',
    "unknown-section": "(define (domain d) (:things a))",
    "constants": D + "(:constants wok - pan) (:action a :parameters (?x - pan) :effect (p wok)))",
    "derived": D + "(:derived (q) (exists (?x - pan) (p ?x))))",
    "type-below-itself": "(define (domain d)\n (:types a - b b - a))",
    "constraints": D + "(:constraints (always (q))))",
    "second-section": "(define (domain d) (:types a) (:types b))",
    "type-twice": "(define (domain d)\n  (:types a b\n   a))",
    "unknown-parent": "(define (domain d) (:types a - b))",
    "dangling-dash": "(define (domain d) (:types a -))",
    "either": "(define (domain d) (:types a b) (:predicates (p ?x - (either a b))))",
    "predicate-twice": "(define (domain d) (:predicates (p) (p)))",
    "predicate-unknown-type": "(define (domain d) (:types a) (:predicates (p ?x - b)))",
    "predicate-argument": "(define (domain d) (:predicates (p x)))",
    "function": D + "(:functions (fuel) - number) (:action a :parameters () :precondition (> (fuel) 1) :effect (q)))",
    "bare-comparison": A + ":precondition (=) :effect (q)))",
    "action-no-name": D + "(:action))",
    "action-twice": D + "(:action a :parameters () :effect (q)) (:action a :parameters () :effect (q)))",
    "action-key": D + "(:action a :params ()))",
    "action-no-effect": D + "(:action a :parameters ()))",
    "action-key-twice": D + "(:action a :parameters () :parameters ()))",
    "action-key-alone": D + "(:action a :parameters))",
    "parameter-twice": D + "(:action a :parameters (?x ?x - pan) :effect (q)))",
    "unknown-predicate": A + "\n  :precondition (and (q)\n (on ?x)) :effect (q)))",
    "unknown-variable": A + ":precondition (p ?y) :effect (q)))",
    "arity": A + ":precondition (p ?x ?x) :effect (q)))",
    "type": D + "(:action a :parameters (?x) :precondition (p ?x) :effect (q)))",
    "or": A + ":precondition (or (q) (p ?x)) :effect (q)))",
    "exists": A + ":precondition (exists (?y - pan) (p ?y)) :effect (q)))",
    "forall-positive": A + ":precondition (forall (?y - pan) (p ?y)) :effect (q)))",
    "forall-short": A + ":precondition (forall (?y - pan)) :effect (q)))",
    "equality": A + ":precondition (= ?x ?x) :effect (q)))",
    "inequality": A + ":precondition (not (= ?x ?z)) :effect (q)))",
    "not-two": A + ":precondition (not (q) (q)) :effect (q)))",
    "when": A + ":effect (when (q) (p ?x))))",
    "forall-effect": A + ":effect (forall (?y - pan) (p ?y))))",
    "increase-fuel": D + "(:functions (fuel) - number) (:action a :parameters () :effect (increase (fuel) 1)))",
    "increase": A + ":effect (increase (fuel) 1)))",
    "negative-cost": A + ":effect (increase (total-cost) -1)))",
    "cost-word": A + ":effect (increase (total-cost) much)))",
    "word-as-effect": A + ":effect q))",
    "duration": D + "(:durative-action a :parameters () :duration (<= ?duration 1) :effect (at end (q))))",
    "no-duration": D + "(:durative-action a :parameters () :effect (at end (q))))",
    "untimed": T + ":effect (q)))",
    "at-end-condition": T + ":condition (at end (q)) :effect (at end (q))))",
    "add-at-start": T + ":effect (at start (q))))",
    "numeric-in-time": T + ":effect (at end (increase (total-cost) 1))))",
    "negative-over-all": T + ":condition (over all (not (q))) :effect (at end (q))))",
}
P = "(define (problem p) (:domain kitchen) (:objects egg - food pan-a - pan) "
PROBLEM_ERRORS = {
    "other-domain": "(define (problem p) (:domain garage) (:goal (and)))",
    "no-goal": P + "(:init))",
    "two-goals": P + "(:goal (gripper-open) (gripper-open)))",
    "object-type": "(define (problem p) (:domain kitchen) (:objects egg - meal) (:goal (and)))",
    "object-twice": "(define (problem p) (:domain kitchen) (:objects egg egg - food) (:goal (and)))",
    "object-variable": "(define (problem p) (:domain kitchen) (:objects ?egg - food) (:goal (and)))",
    "init-unknown-object": P + "(:init (food-in-pan egg\n pan-b)) (:goal (and)))",
    "goal-negative": P + "(:goal (not (gripper-open))))",
    "bare-number": P + "(:init (= )) (:goal (and)))",
    "timed": P + "(:init (at 5 (gripper-open))) (:goal (and)))",
    "goal-type": P + "(:goal (and (food-in-pan pan-a egg))))",
    "goal-or": P + "(:goal (or (gripper-open) (gripper-open))))",
    "number": P + "(:init (= (fuel) 3)) (:goal (and)))",
}
ATOM_ERRORS = {
    "nothing": " ; only a comment",
    "word": "gripper-open",
    "predicate": "(gripper-open) (fried egg)",
    "object": "(food-in-pan egg wok)",
    "arity": "(food-in-pan egg)",
    "type": "(food-in-pan pan-a egg)",
    "variable": "(food-in-pan ?food pan-a)",
    "negative": "(not (gripper-open))",
}


def messages(cases, read):
    lines = []
    for name, text in cases.items():
        with pytest.raises(ParseError) as caught:
            read(text)
        assert "\n" not in str(caught.value)
        lines.append(f"{name}: {caught.value}")
    return "".join(line + "\n" for line in lines)


@pytest.mark.parametrize(
    ("name", "cases", "read"),
    [
        ("domain", DOMAIN_ERRORS, lambda text: read_domain(text, "d.pddl")),
        ("problem", PROBLEM_ERRORS, lambda text: read_problem(text, kitchen(), "p.pddl")),
        ("atoms", ATOM_ERRORS, lambda text: read_atoms(text, kitchen(), covered_egg().object_types, "--goal")),
    ],
)
def test_error_texts(name, cases, read):
    assert messages(cases, read) == (GOLDEN / f"{name}_errors.txt").read_text()


def test_an_error_carries_its_place():
    with pytest.raises(ParseError) as caught:
        read_domain("(define (domain d)\n  (:types a - b))", "d.pddl")
    assert (caught.value.source, caught.value.line, caught.value.column) == ("d.pddl", 2, 15)


@given(st.text(alphabet="()?:- \n;abdefinot=", max_size=80))
def test_any_text_is_read_or_refused_with_a_place(text):
    for read in (read_domain, lambda t: read_problem(t, kitchen()), lambda t: read_atoms(t, kitchen(), {})):
        with pytest.raises(ParseError) as caught:
            read(text)
        assert caught.value.line >= 1


MUTANT = write_domain(kitchen(), dialect="costs")


@settings(max_examples=200, deadline=None)
@given(st.integers(0, len(MUTANT) - 1), st.sampled_from(["", "(", ")", "?", " - ", " and ", " not ", "1"]))
def test_a_damaged_domain_never_crashes(position, replacement):
    with suppress(ParseError):
        read_domain(MUTANT[:position] + replacement + MUTANT[position + 1 :])


def test_goals_from_the_command_line():
    objects = covered_egg().object_types
    goal = atoms("food-in-pan egg pan-b, gripper-open")
    assert read_atoms("(food-in-pan egg pan-b) (gripper-open)", kitchen(), objects) == goal
    assert read_atoms("(and (Food-In-Pan egg PAN-b) (gripper-open))", kitchen(), objects) == goal


def test_words_of_pddl_as_predicates_and_a_type_without_a_space():
    """`at` is the most common predicate there is; some write ``a -type``."""
    text = """(define (domain d) (:types truck place -object) (:predicates (at ?t -truck ?p -place) (over ?p -place))
      (:action go :parameters (?t -truck ?a ?b - place) :precondition (and (at ?t ?a) (not (over ?b)))
        :effect (and (at ?t ?b) (not (at ?t ?a))))
      (:durative-action fly :parameters (?t - truck ?p - place) :duration (= ?duration 2)
        :condition (at start (over ?p)) :effect (at end (at ?t ?p))))"""
    domain = read_domain(text)
    assert domain.types == (Type("truck"), Type("place"))
    assert domain.operator("go").add == atoms("at ?t ?b")
    assert domain.operator("go").absent == {Absent(Atom("over", ("?b",)))}
    assert domain.operator("fly").pre == atoms("over ?p")
    assert domain.operator("fly").add == atoms("at ?t ?p")


def test_a_problem_may_leave_out_what_is_empty():
    assert read_problem("(define (problem p) (:goal (gripper-open)))", kitchen()) == Problem(
        "p", "kitchen", (), frozenset(), atoms("gripper-open")
    )


def _steps(text, problem):
    """Lines of our code that reading takes: the same on every machine."""
    count = 0

    def trace(frame, event, _):
        nonlocal count
        count += event == "line"
        return trace if "symskill_pddl" in frame.f_code.co_filename else None

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        read_problem(problem, read_domain(text))
    finally:
        sys.settrace(before)
    return count


@pytest.mark.parametrize("form", ["flat", "line", "tree"])
def test_twice_as_many_types_take_twice_as_long(form):
    def steps(n):
        parents = {"flat": lambda _: "object", "line": lambda i: f"t{i - 1}", "tree": lambda i: f"t{i // 2}"}[form]
        types = " ".join(["t0 - object", *(f"t{i} - {parents(i)}" for i in range(1, n))])
        objects = " ".join(f"o{i} - t{i}" if form == "tree" else f"o{i} - t1" for i in range(n))
        text = f"(define (domain d) (:types {types}) (:predicates (p ?x - t0) (q)))"
        return _steps(text, f"(define (problem x) (:domain d) (:objects {objects}) (:init (q)) (:goal (and (q))))")

    assert steps(800) < 2.6 * steps(400)


def test_the_type_that_is_below_itself_is_named_among_many():
    types = " ".join(f"t{i} - t{i + 1}" for i in range(3000)) + " t3000 - t2998"
    with pytest.raises(ParseError, match="the type 't2998' is below itself: t2998 - t2999 - t3000 - t2998"):
        read_domain(f"(define (domain d) (:types {types}))")
