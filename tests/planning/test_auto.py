"""Which planner `auto` takes, and that sessions of the planners without engines replan."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_domains import atoms, breadth_first, covered_egg, domains, kitchen, problems

import symskill_pddl.planning.auto as auto
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


def test_small_problems_go_to_builtin():
    assert taken(get().solve(kitchen(), covered_egg())) == (
        "builtin",
        f"auto took builtin: the problem is small, {auto.bindings(kitchen(), covered_egg().objects)} ground operators by type",
    )


def test_large_problems_go_to_a_fast_engine(monkeypatch):
    monkeypatch.setattr(auto, "SMALL", 3)
    monkeypatch.setattr(auto, "fast", lambda _domain, _objects: (Solves(), Breaks()))
    assert taken(Auto().solve(kitchen(), covered_egg()))[0] == "solves"
    extra = {("pick-lid", ("lid-a", "pan-a")): 1.0}
    assert taken(Auto().solve(kitchen(), covered_egg(), Limits(), extra))[0] == "solves"


def test_an_engine_that_breaks_is_followed_by_builtin(monkeypatch):
    monkeypatch.setattr(auto, "SMALL", 3)
    monkeypatch.setattr(auto, "fast", lambda _domain, _objects: (Breaks(),))
    planner, why = taken(Auto().solve(kitchen(), covered_egg()))
    assert planner == "builtin"
    assert why.startswith("auto took builtin: the problem is large")
    assert why.endswith("; breaks failed (out of order)")
    warm = session(Auto(), kitchen(), covered_egg().objects)
    warm.solve(covered_egg().init, covered_egg().goal)
    assert "out of order" not in taken(warm.solve(covered_egg().init, covered_egg().goal))[1]


def test_without_engines_there_is_builtin(monkeypatch):
    monkeypatch.setattr(auto, "SMALL", 3)
    monkeypatch.setattr(auto, "fast", lambda _domain, _objects: ())
    assert "no faster planner is installed" in taken(Auto().solve(kitchen(), covered_egg()))[1]


def test_mimir_is_for_operators_that_cost_the_same(monkeypatch):
    for engine in (auto.Mimir, auto.Kairos):
        monkeypatch.setattr(engine, "module", "sys")  # as if it were installed
    same = replace(kitchen(), operators=tuple(replace(op, cost=1.0) for op in kitchen().operators))
    assert [e.name for e in auto.fast(same, covered_egg().objects)] == ["mimir", "kairos"]
    assert [e.name for e in auto.fast(kitchen(), covered_egg().objects)] == ["kairos"]


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
