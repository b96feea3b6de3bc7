"""Which planner `auto` takes, and that sessions of the planners without engines replan."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_domains import atoms, breadth_first, covered_egg, domains, kitchen, problems

import symskill_pddl.planning.auto as auto
from symskill_pddl.errors import InputError
from symskill_pddl.planning import Auto, Builtin, Limits, Pyperplan, Status, get, session
from symskill_pddl.planning.protocol import PlanResult
from symskill_pddl.symbols import validate


class Breaks:
    name, version, licence, dialects = "breaks", "0", "none", ("negative",)

    def solve(self, domain, problem, limits=None, extra_costs=None):
        return PlanResult(Status.FAILED, messages=("out of order",), planner=self.name)


class Solves(Breaks):
    name = "solves"

    def solve(self, domain, problem, limits=None, extra_costs=None):
        return replace(Builtin().solve(domain, problem), planner=self.name)


def taken(result):
    return result.planner, result.messages[-1]


def chosen(monkeypatch, *engines):
    """Let `auto` choose among these."""
    monkeypatch.setattr(auto, "choices", lambda *_: tuple(auto.Choice(e, 1.0, "as the test wants") for e in engines))


def installed(monkeypatch, *families):
    for family in (auto.Kairos, auto.Mimir):
        monkeypatch.setattr(family, "module", "sys" if family in families else "no_such_module")


def test_where_the_problem_is_small_the_cheapest_plan_is_found(monkeypatch):
    installed(monkeypatch, auto.Kairos, auto.Mimir)
    assert auto.bindings(kitchen(), covered_egg().objects) <= auto.SMALL
    (choice,) = auto.choices(kitchen(), covered_egg().objects, 1)
    assert choice.engine.name == "builtin"


def test_few_goal_atoms_and_many(monkeypatch):
    monkeypatch.setattr(auto, "SMALL", 0)
    installed(monkeypatch, auto.Kairos)
    few, many = (auto.choices(kitchen(), covered_egg().objects, n) for n in (auto.FEW, auto.FEW + 1))
    assert [(c.engine.name, getattr(c.engine, "search", "")) for c in few] == [
        ("kairos", "ff"),
        ("kairos", "auto"),
        ("builtin", ""),
    ]
    assert [(c.engine.name, getattr(c.engine, "search", "")) for c in many] == [("kairos", "auto"), ("builtin", "")]


def test_without_engines_there_is_builtin(monkeypatch):
    monkeypatch.setattr(auto, "SMALL", 0)
    installed(monkeypatch)
    planner, why = taken(get().solve(kitchen(), covered_egg()))
    assert planner == "builtin"
    assert why.startswith("auto took builtin: no faster planner is installed")


def test_mimir_is_for_operators_that_cost_the_same(monkeypatch):
    monkeypatch.setattr(auto, "SMALL", 0)
    installed(monkeypatch, auto.Mimir)
    same = replace(kitchen(), operators=tuple(replace(op, cost=1.0) for op in kitchen().operators))
    assert [c.engine.name for c in auto.choices(same, covered_egg().objects, 1)] == ["mimir", "builtin"]
    assert [c.engine.name for c in auto.choices(kitchen(), covered_egg().objects, 1)] == ["builtin"]


def test_an_engine_that_breaks_is_followed_by_the_next(monkeypatch):
    chosen(monkeypatch, Breaks(), Solves(), Builtin())
    planner, why = taken(Auto().solve(kitchen(), covered_egg()))
    assert planner == "solves"
    assert why == "auto took solves: as the test wants; breaks failed before (out of order)"
    warm = session(Auto(), kitchen(), covered_egg().objects)
    for extra in ({}, {("pick-lid", ("lid-a", "pan-a")): 1.0}):
        result = warm.solve(covered_egg().init, covered_egg().goal, Limits(), extra)
        assert ("out of order" in taken(result)[1]) == (not extra)  # not asked again


def test_what_is_left_of_the_last_plan_needs_no_planner(monkeypatch):
    chosen(monkeypatch, Solves(), Breaks())
    egg = covered_egg()
    warm, state = session(Auto(), kitchen(), egg.objects), egg.init
    plan = warm.solve(state, egg.goal).unwrap()
    chosen(monkeypatch, Breaks())
    for done, step in enumerate(plan.ground(kitchen(), egg.object_types), start=1):
        state = step.apply(state)
        result = warm.solve(state, egg.goal)
        assert result.plan.steps == plan.steps[done:]
        assert result.messages == (
            f"auto asked no planner: {len(plan) - done} of the {len(plan)} steps that solves planned still reach the goal",
        )
    blamed = dict.fromkeys(plan.steps[-1:], 1.0)
    assert warm.solve(egg.init, egg.goal, Limits(), blamed).status is Status.FAILED  # it is asked
    assert warm.solve(egg.init, atoms("gripper-holds-lid lid-a")).status is Status.FAILED
    with pytest.raises(InputError, match="ghost"):
        warm.solve(egg.init | atoms("food-in-pan ghost pan-a"), egg.goal)


@pytest.mark.parametrize("planner", [Builtin(), Builtin(optimal=True), Auto(), Pyperplan()], ids=lambda p: type(p).__name__)
def test_a_session_replans_from_every_state_of_a_plan(planner):
    egg = covered_egg()
    warm, state = session(planner, kitchen(), egg.objects), egg.init
    for step in Builtin().solve(kitchen(), egg).unwrap().ground(kitchen(), egg.object_types):
        validate(kitchen(), replace(egg, init=state), warm.solve(state, egg.goal).unwrap())
        state = step.apply(state)
    assert len(warm.solve(state, egg.goal).unwrap()) == 0
    assert warm.solve(state, egg.goal | atoms("gripper-holds-food egg")).status is Status.UNSOLVABLE


def test_a_session_knows_extra_costs():
    egg = covered_egg()
    warm = session(Builtin(), kitchen(), egg.objects)
    plain = warm.solve(egg.init, egg.goal).unwrap()
    dear = dict.fromkeys(plain.steps[1:2], 50.0)
    with_costs = warm.solve(egg.init, egg.goal, Limits(), dear).unwrap()
    assert with_costs.cost == Builtin().solve(kitchen(), egg, Limits(), dear).unwrap().cost
    assert warm.solve(egg.init, egg.goal).plan == plain


@given(st.data())
@settings(max_examples=60, deadline=None)
def test_a_warm_session_is_as_right_as_a_cold_call(data):
    domain = data.draw(domains())
    first, second = data.draw(problems(domain)), data.draw(problems(domain))
    objects = dict(first.objects)
    states = [first.init, *([second.init] if all(x in objects for a in second.init for x in a.args) else [])]
    if dict(second.objects).items() <= objects.items():
        states.append(second.init | first.init)
    else:
        states = states[:1]
    warm = session(Builtin(optimal=True), domain, first.objects)
    for state in (*states, first.init):
        asked = replace(first, init=state)
        try:
            shortest = breadth_first(domain, asked)
        except OverflowError:
            return
        result = warm.solve(state, first.goal)
        assert result.status is (Status.UNSOLVABLE if shortest is None else Status.SOLVED)
        if result.plan is not None:
            validate(domain, asked, result.plan)
            assert result.plan.cost == pytest.approx(Builtin(optimal=True).solve(domain, asked).unwrap().cost)
