"""The domain as an object of unified-planning, and back."""

from dataclasses import replace

import pytest
from random_domains import covered_egg, kitchen

from symskill_pddl.planning import Builtin, to_unified_planning
from symskill_pddl.symbols import Operator, Predicate, Type, validate

plans = pytest.importorskip("unified_planning.plans", reason="unified-planning is not installed")
shortcuts = pytest.importorskip("unified_planning.shortcuts", reason="unified-planning is not installed")


def test_names_that_are_legal_stay():
    theirs, names = to_unified_planning(kitchen())
    assert [a.name for a in theirs.actions] == [op.name for op in kitchen().operators]
    assert {f.name for f in theirs.fluents} >= {p.name for p in kitchen().predicates}
    assert names.domain(kitchen()) == kitchen()
    assert not theirs.goals


@pytest.mark.parametrize("dialect", ["strips", "negative", "costs"])
def test_our_plan_is_valid_for_their_problem(dialect):
    theirs, names = to_unified_planning(kitchen(), covered_egg(), dialect=dialect)
    plan = names.plan(Builtin().solve(kitchen(), covered_egg()).unwrap())
    steps = [
        plans.ActionInstance(
            theirs.action(name), [theirs.environment.expression_manager.ObjectExp(theirs.object(a)) for a in args]
        )
        for name, args in plan.steps
    ]
    with shortcuts.PlanValidator(problem_kind=theirs.kind) as validator:
        assert validator.validate(theirs, plans.SequentialPlan(steps))
        assert not validator.validate(theirs, plans.SequentialPlan(steps[1:]))


def test_the_temporal_dialect_has_durations():
    theirs, _ = to_unified_planning(kitchen(), covered_egg(), dialect="temporal")
    assert [float(a.duration.lower.constant_value()) for a in theirs.actions] == [op.cost for op in kitchen().operators]


def test_names_that_are_not_legal_come_back():
    """Upper case, a digit first, a keyword, and an object named like a predicate: each renamed, and the plan comes back."""
    put = Operator("3 Put!", (), frozenset(), frozenset(), frozenset())
    domain = replace(
        kitchen(),
        types=(*kitchen().types, Type("Object")),
        predicates=(*kitchen().predicates, Predicate("when")),
        operators=(*kitchen().operators, put),
    )
    egg = covered_egg()
    renamed = {"egg": "food-in-pan"}

    def rename(state):
        return frozenset(replace(a, args=tuple(renamed.get(x, x) for x in a.args)) for a in state)

    problem = replace(
        egg, objects=tuple((renamed.get(o, o), t) for o, t in egg.objects), init=rename(egg.init), goal=rename(egg.goal)
    )
    theirs, names = to_unified_planning(domain, problem)
    assert theirs.name
    assert names.inverse().domain(names.domain(domain)) == domain
    assert names.inverse().problem(names.problem(problem)) == problem
    plan = Builtin().solve(domain, problem).unwrap()
    assert all(theirs.has_action(name) and all(map(theirs.has_object, args)) for name, args in names.plan(plan).steps)
    back = names.inverse().plan(names.plan(plan))
    assert back == plan
    validate(domain, problem, back)
