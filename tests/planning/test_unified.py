"""The domain as an object of unified-planning, and back."""

from dataclasses import replace

import numpy as np
import pytest
from random_domains import atoms, covered_egg, kitchen

from symskill_pddl.abstraction import Classifier
from symskill_pddl.geometry import Pose
from symskill_pddl.library import LearnedOperator, Library
from symskill_pddl.planning import Builtin, to_unified_planning
from symskill_pddl.scene import GRIPPER
from symskill_pddl.symbols import Atom, Operator, Parameter, Predicate, Problem, Type, validate

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


def test_a_library_offers_it_too():
    gripper = Classifier(Predicate("Holds Egg", ("egg",)), GRIPPER, "egg", Pose.identity(), np.eye(3), np.eye(3), 1.0, 1.0)
    take = Operator("3 Take!", (Parameter("?egg", "egg"),), atoms("gripper-open"), frozenset(), atoms("gripper-open"))
    take = replace(take, add=frozenset({Atom("Holds Egg", ("?egg",))}))
    library = Library((Type("egg"),), (gripper,), (LearnedOperator(take, take.pre, "", "pick", (), (1.0, 1.0)),), {})
    problem = Problem("p", "learned", (("Egg", "egg"),), atoms("gripper-open"), frozenset({Atom("Holds Egg", ("Egg",))}))
    theirs, names = library.to_unified_planning(problem)
    assert [a.name for a in theirs.actions] == ["x3-take"]
    plan = names.plan(Builtin().solve(library.domain(), problem).unwrap())
    assert plan.steps == (("x3-take", ("egg-1",)),)
    step = plans.ActionInstance(
        theirs.action("x3-take"), [theirs.environment.expression_manager.ObjectExp(theirs.object("egg-1"))]
    )
    with shortcuts.PlanValidator(problem_kind=theirs.kind) as validator:
        assert validator.validate(theirs, plans.SequentialPlan([step]))
    assert names.inverse().plan(plan).steps == (("3 Take!", ("Egg",)),)
    assert library.to_unified_planning(dialect="temporal").problem.actions[0].duration.lower.constant_value() == 1
