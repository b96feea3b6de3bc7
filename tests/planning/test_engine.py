"""What engines do with steps that failed before, one by one and in a warm session."""

from dataclasses import replace

import pytest
from random_domains import atoms, covered_egg, kitchen

from symskill_pddl.planning import LPG, Auto, Builtin, Engine, FastDownward, Kairos, Limits, Mimir, Pyperplan, Status, session
from symskill_pddl.planning.engine import barred
from symskill_pddl.planning.protocol import PlanResult
from symskill_pddl.symbols import Absent, Atom, Operator, Predicate, check_domain, validate

ENGINES = (Builtin(), Auto(), Pyperplan(), Kairos(), Mimir(), FastDownward(), LPG())
MUST = ("pick-lid", ("lid-a", "pan-a"))
"""The egg lies under this lid: there is no other way."""


@pytest.fixture(params=ENGINES, ids=lambda e: e.name)
def engine(request):
    if not getattr(request.param, "installed", lambda: True)():
        pytest.skip(f"{request.param.name} is not installed; pip install 'symskill-pddl[planners]'")
    return request.param


def choice(plan):
    """Where the plan puts lid-a, which may go to either of two pans."""
    return next((name, args) for name, args in plan.steps if name == "place-lid" and args[0] == "lid-a")


def test_another_way_is_taken_in_a_warm_session_and_in_a_cold_call(engine):
    problem = covered_egg()
    warm = session(engine, kitchen(), problem.objects)
    first = choice(warm.solve(problem.init, problem.goal).unwrap())
    for solve in (
        lambda extra: warm.solve(problem.init, problem.goal, Limits(60.0), extra),
        lambda extra: engine.solve(kitchen(), problem, Limits(60.0), extra),
    ):
        result = solve({first: 1000.0})
        validate(kitchen(), problem, result.unwrap())
        assert choice(result.plan) != first
        if isinstance(engine, Engine):
            assert result.messages[-1] == f"left out for this call, as failed before: (place-lid {' '.join(first[1])})"
    if not isinstance(engine, Auto):  # which goes on with the last plan
        assert choice(warm.solve(problem.init, problem.goal).unwrap()) == first  # nothing of it stays


def test_what_cannot_be_avoided_is_done(engine):
    problem = covered_egg()
    result = session(engine, kitchen(), problem.objects).solve(problem.init, problem.goal, Limits(60.0), {MUST: 1000.0})
    assert MUST in result.unwrap().steps
    if isinstance(engine, Engine):
        why = "failed" if engine.name == "lpg" else "unsolvable"  # LPG proves little
        said = f"no plan without the steps that failed before ({why}), so none was left out: (pick-lid lid-a pan-a)"
        assert result.messages[-1] == said


class Slow(Engine):
    """Says what it is told, and remembers what it was asked."""

    name = "slow"

    def __init__(self, *statuses):
        self.statuses, self.asked, self.opened = list(statuses), [], []

    def open(self, domain, objects):
        self.opened.append(domain)
        return super().open(domain, objects)

    def plan(self, domain, problem, limits):
        self.asked.append((domain, problem, limits))
        status = self.statuses.pop(0)
        return replace(Builtin().solve(domain, problem)) if status is Status.SOLVED else PlanResult(status)


@pytest.mark.parametrize("status", [Status.TIMEOUT, Status.FAILED, Status.UNSOLVABLE])
def test_half_of_the_time_for_the_other_way(status, monkeypatch):
    monkeypatch.setattr("time.monotonic", lambda: 7.0)
    slow = Slow(status, Status.SOLVED)
    result = slow.solve(kitchen(), covered_egg(), Limits(time_s=8.0), {MUST: 1.0})
    assert result.status is Status.SOLVED
    (_, first, half), (_, second, rest) = slow.asked
    assert (half.time_s, rest.time_s) == (4.0, 8.0)
    assert first.init - second.init == {Atom("avoid-pick-lid", MUST[1])}
    assert f"({status.value})" in result.messages[-1]


def test_the_forbidding_domain_is_loaded_once_for_its_actions():
    slow = Slow(*[Status.SOLVED] * 8)
    warm = slow.session(kitchen(), covered_egg().objects)
    steps = [("place-lid", ("lid-a", "pan-c")), ("place-lid", ("lid-a", "pan-d")), ("pick-food", ("egg", "pan-d"))]
    for extra in ({}, {steps[0]: 1.0}, {steps[1]: 1.0}, {steps[0]: 0.0}, {steps[2]: 1.0}, {steps[0]: 1.0, steps[2]: 1.0}):
        assert warm.solve(covered_egg().init, covered_egg().goal, Limits(), extra).status is Status.SOLVED
    assert [len(d.predicates) - len(kitchen().predicates) for d in slow.opened] == [0, 1, 2]


def test_a_name_that_is_taken_and_an_action_without_arguments():
    wait = Operator("wait", (), frozenset(), atoms("avoid-wait"), frozenset())
    domain = replace(kitchen(), predicates=(*kitchen().predicates, Predicate("avoid-wait")), operators=(wait,))
    found, avoid = barred(domain, ["wait"])
    check_domain(found)
    assert avoid == {"wait": "avoid-wait-2"}
    assert found.operators[0].absent == {Absent(Atom("avoid-wait-2"))}
