from itertools import product

import pytest

from symskill_pddl.execution.causes import VIOLATIONS, cause_of, cause_of_run
from symskill_pddl.execution.monitor import Blame, Continue, EffectsHold, JumpAhead, Kind, OverTime, Stalled, Violation
from symskill_pddl.execution.outcome import Category, Cause


@pytest.mark.parametrize(
    ("verdict", "cause"),
    [
        (Violation(Kind.PRECONDITION, (), Blame.EXTERNAL, ""), Cause.PRECONDITION),
        (Violation(Kind.PROTECTED, (), Blame.EXTERNAL, ""), Cause.EXTERNAL),
        (Violation(Kind.LOST_GRASP, (), Blame.ACQUIRING, ""), Cause.GRASP),
        (Violation(Kind.EFFECTS, (), Blame.OWN, ""), Cause.GRASP),
        (Violation(Kind.EFFECTS, (), Blame.EXTERNAL, ""), Cause.EXTERNAL),
        (Stalled(""), Cause.MOTION),
        (Stalled("", blocked=True), Cause.MOTION),
        (OverTime(""), Cause.TIMEOUT),
        (Continue(""), None),
        (EffectsHold(""), None),
        (JumpAhead(2, ""), None),
    ],
)
def test_every_verdict_has_its_cause(verdict, cause):
    assert cause_of(verdict) is cause


def test_the_table_knows_every_kind_of_violation():
    assert {kind for kind, _ in VIOLATIONS} == set(Kind)
    assert set(VIOLATIONS) < set(product(Kind, Blame))


@pytest.mark.parametrize(
    ("category", "troubles", "recoveries", "cause"),
    [
        (Category.SUCCESS, [Cause.GRASP], [], None),
        (Category.UNREACHABLE, [Cause.GRASP], ["recover-observe"], Cause.PLANNING),
        (Category.UNREACHABLE, [], ["recover-observe", "recover-assume"], Cause.PERCEPTION),
        (Category.PLANNER, [Cause.MOTION], ["recover-assume"], Cause.PLANNING),
        (Category.TIME, [Cause.MOTION], [], Cause.TIMEOUT),
        (Category.REPLANS, [Cause.GRASP, Cause.MOTION, Cause.GRASP, Cause.EXTERNAL], [], Cause.GRASP),
        (Category.REPLANS, [Cause.GRASP, Cause.MOTION], [], Cause.MOTION),
        (Category.REPLANS, [], [], Cause.EXTERNAL),
        (Category.MISSED, [Cause.GRASP, Cause.GRASP, Cause.MOTION], [], Cause.MOTION),
        (Category.MISSED, [], [], Cause.EXTERNAL),
    ],
)
def test_a_run_fails_of_one_thing(category, troubles, recoveries, cause):
    assert cause_of_run(category, troubles, recoveries) is cause
