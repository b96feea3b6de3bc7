"""The builtin planner against breadth-first search by the semantics of `symbols`."""

import math
from dataclasses import replace
from itertools import count, pairwise

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from random_domains import atoms, breadth_first, covered_egg, domains, kitchen, problems

from symskill_pddl.errors import InputError, NoPlanError
from symskill_pddl.planning import Builtin, Limits, PlanResult, Status
from symskill_pddl.planning import search as module
from symskill_pddl.symbols import Atom, Domain, Operator, Parameter, Plan, Predicate, Problem, Type, validate

EGG = (
    ("pick-lid", ("lid-a", "pan-a")),
    ("place-lid", ("lid-a", "pan-c")),
    ("pick-food", ("egg", "pan-a")),
)


def unit(domain):
    return replace(domain, operators=tuple(replace(o, cost=1.0) for o in domain.operators))


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.data())
def test_it_solves_what_can_be_solved_and_proves_the_rest(data):
    domain = unit(data.draw(domains()))
    problem = data.draw(problems(domain))
    try:
        shortest = breadth_first(domain, problem, 300)
    except OverflowError:
        assume(False)
    for planner in (Builtin(), Builtin(optimal=True)):
        result = planner.solve(domain, problem)
        assert result.status is (Status.UNSOLVABLE if shortest is None else Status.SOLVED)
        if result.plan is not None:
            validate(domain, problem, result.plan)
            assert result.plan.cost == len(result.plan)
            assert not planner.optimal or len(result.plan) == shortest


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.data())
def test_the_greedy_search_does_too(data):
    domain = data.draw(domains())
    problem = data.draw(problems(domain))
    try:
        shortest = breadth_first(domain, problem, 300)
    except OverflowError:
        assume(False)
    task = module.ground_task(domain, problem, extra_costs={})
    if task.goal is None:
        assert shortest is None
        return
    actions, _ = module._lazy_greedy(task, module.Relaxation(task), math.inf)
    assert (actions is None) == (shortest is None)
    if actions is not None:
        validate(domain, problem, Plan(tuple(a.step for a in actions)))
        shorter = module._shortened(task, actions)
        validate(domain, problem, Plan(tuple(a.step for a in shorter)))
        assert sum(a.cost for a in shorter) <= sum(a.cost for a in actions)


def test_a_detour_is_cut_out_of_the_middle_of_a_long_plan():
    go = Operator(
        "go",
        (Parameter("?a", "place"), Parameter("?b", "place")),
        pre=frozenset({Atom("at", ("?a",)), Atom("link", ("?a", "?b"))}),
        add=frozenset({Atom("at", ("?b",))}),
        delete=frozenset({Atom("at", ("?a",))}),
    )
    domain = Domain("walk", (Type("place"),), (Predicate("at", ("place",)), Predicate("link", ("place", "place"))), (go,))
    names = [f"p{i:02}" for i in range(30)]
    links = {Atom("link", pair) for pair in [*pairwise(names), ("p13", "p17")]}
    problem = Problem("far", "walk", tuple((n, "place") for n in names), frozenset({Atom("at", ("p00",)), *links}), frozenset())
    problem = replace(problem, goal=frozenset({Atom("at", ("p29",))}))
    task = module.ground_task(domain, problem, extra_costs={})
    by_step = {a.step: a for a in task.actions}
    long = [by_step["go", pair] for pair in pairwise(names)]
    steps = [a.step for a in module._shortened(task, long)]
    assert [args[1] for _, args in steps] == [*names[1:14], *names[17:]]


def test_the_egg():
    result = Builtin().solve(kitchen(), covered_egg())
    assert result.status is Status.SOLVED
    validate(kitchen(), covered_egg(), result.unwrap())
    assert len(result.unwrap()) == len(Builtin(optimal=True).solve(kitchen(), covered_egg()).unwrap())
    assert result.planner == "builtin"


def test_same_input_same_plan():
    shuffled = replace(covered_egg(), objects=covered_egg().objects)
    assert Builtin().solve(kitchen(), covered_egg()).plan == Builtin().solve(kitchen(), shuffled).plan


def test_a_goal_that_holds_needs_no_step():
    result = Builtin().solve(kitchen(), replace(covered_egg(), goal=atoms("gripper-open")))
    assert result.status is Status.SOLVED
    assert result.plan == Plan()


def test_an_empty_goal_needs_no_step():
    assert Builtin().solve(kitchen(), replace(covered_egg(), goal=frozenset())).plan == Plan()


WAYS = Domain(
    "ways",
    (),
    (Predicate("start"), Predicate("middle"), Predicate("end")),
    (
        Operator("straight", (), atoms("start"), atoms("end"), frozenset(), cost=3.0),
        Operator("first", (), atoms("start"), atoms("middle"), frozenset(), cost=1.0),
        Operator("second", (), atoms("middle"), atoms("end"), frozenset(), cost=1.0),
    ),
)
WALK = Problem("walk", "ways", (), atoms("start"), atoms("end"))


@pytest.mark.parametrize("planner", [Builtin(), Builtin(optimal=True)])
def test_costs_and_extra_costs_choose_the_way(planner):
    cheap = planner.solve(WAYS, WALK).unwrap()
    assert [name for name, _ in cheap.steps] == ["first", "second"]
    assert cheap.cost == 2.0
    around = planner.solve(WAYS, WALK, Limits(), {("second", ()): 5.0}).unwrap()
    assert [name for name, _ in around.steps] == ["straight"]
    assert around.cost == 3.0


def test_extra_costs_are_of_the_ground_step():
    two = replace(covered_egg(), goal=atoms("gripper-holds-lid lid-a, gripper-holds-lid lid-b"))
    either = replace(two, goal=atoms("lid-on-pan lid-a pan-c"))
    extra = {("pick-lid", ("lid-a", "pan-b")): 100.0}
    assert Builtin().solve(kitchen(), either, Limits(), extra).unwrap().cost == 5.5


def test_negative_conditions_are_kept():
    result = Builtin().solve(kitchen(), replace(covered_egg(), goal=atoms("gripper-holds-food egg")))
    assert result.unwrap().steps[0] == EGG[0]
    assert len(result.unwrap()) == 3


def test_unsolvable_is_proved_where_the_relaxation_is_blind():
    both = replace(covered_egg(), goal=atoms("gripper-holds-lid lid-a, gripper-holds-lid lid-b"))
    result = Builtin().solve(kitchen(), both)
    assert result.status is Status.UNSOLVABLE
    assert "reachable states" in result.messages[0]
    with pytest.raises(NoPlanError, match=r"planner 'builtin' found no plan, unsolvable after .* s: all .* reachable states"):
        result.unwrap()


def test_unsolvable_at_once():
    result = Builtin().solve(replace(kitchen(), operators=()), covered_egg())
    assert result.status is Status.UNSOLVABLE
    assert "without deletes" in result.messages[0]


def large(n):
    objects = tuple((f"pan-{i}", "pan") for i in range(n)) + tuple((f"egg-{i}", "food") for i in range(n))
    init = frozenset(a for i in range(n) for a in atoms(f"food-in-pan egg-{i} pan-{i}")) | atoms("gripper-open")
    goal = frozenset(a for i in range(n) for a in atoms(f"food-in-pan egg-{i} pan-{(i + 1) % n}"))
    return Problem("large", "kitchen", objects, init, goal)


def test_a_large_problem_is_solved_greedily():
    problem = large(12)
    result = Builtin().solve(kitchen(), problem, Limits(time_s=3600.0))
    validate(kitchen(), problem, result.unwrap())
    assert len(result.unwrap()) == 24


def test_the_time_limit_holds(monkeypatch):
    """With a tick at each look at the clock it stops when that many ticks are over, in the middle of the search."""
    ticks = count(0.0, 1.0)
    monkeypatch.setattr("time.monotonic", lambda: next(ticks))
    result = Builtin(optimal=True).solve(kitchen(), large(8), Limits(time_s=1500.0))
    assert result.status is Status.TIMEOUT
    assert "1500 s" in result.messages[0]
    assert next(ticks) < 1510.0


def test_the_size_limit_holds():
    result = Builtin().solve(kitchen(), large(8), Limits(ground_operators=10))
    assert result.status is Status.FAILED
    assert "more than 10" in result.messages[0]


@pytest.mark.parametrize(
    "make",
    [
        lambda: Limits(time_s=0.0),
        lambda: Limits(time_s=float("nan")),
        lambda: Limits(ground_operators=0),
        lambda: PlanResult(Status.SOLVED),
        lambda: PlanResult(Status.TIMEOUT, Plan()),
        lambda: Builtin().solve(WAYS, WALK, Limits(), {("first", ()): -1.0}),
        lambda: Builtin().solve(replace(WAYS, operators=(replace(WAYS.operators[0], cost=-1.0),)), WALK),
        lambda: Builtin().solve(WAYS, replace(WALK, goal=atoms("nowhere"))),
    ],
)
def test_what_is_wrong_is_refused(make):
    with pytest.raises(InputError):
        make()


def test_distinct_parameters_stay_distinct():
    stack = Operator("stack", (Parameter("?a", "object"), Parameter("?b", "object")), frozenset(), atoms("on ?a ?b"), frozenset())
    domain = Domain("d", (), (Predicate("on", ("object", "object")),), (stack,))
    problem = Problem("p", "d", (("x", "object"), ("y", "object")), frozenset(), atoms("on x x"))
    assert Builtin().solve(domain, problem).status is Status.UNSOLVABLE
    assert Builtin().solve(domain, replace(problem, goal=atoms("on x y"))).status is Status.SOLVED


def test_zero_costs_do_not_loop():
    free = replace(kitchen(), operators=tuple(replace(o, cost=0.0) for o in kitchen().operators))
    assert Builtin().solve(free, covered_egg()).unwrap().cost == 0.0
