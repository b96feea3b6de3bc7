"""Why a step or a run failed: one table from the monitor's verdicts, one from how runs end. Standard library only."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from symskill_pddl.execution.monitor import Blame, Kind, OverTime, Stalled, Verdict, Violation
from symskill_pddl.execution.outcome import Category, Cause

VIOLATIONS = {
    (Kind.PRECONDITION, Blame.EXTERNAL): Cause.PRECONDITION,
    (Kind.PROTECTED, Blame.EXTERNAL): Cause.EXTERNAL,
    (Kind.LOST_GRASP, Blame.ACQUIRING): Cause.GRASP,
    (Kind.EFFECTS, Blame.OWN): Cause.GRASP,
    (Kind.EFFECTS, Blame.EXTERNAL): Cause.EXTERNAL,
}
"""What the monitor's violations come from. Effects that did not follow and are the step's own are those of the fingers."""

ENDINGS = {
    Category.UNREACHABLE: Cause.PLANNING,
    Category.PLANNER: Cause.PLANNING,
    Category.TIME: Cause.TIMEOUT,
    Category.WORLD: Cause.EXTERNAL,
}
"""What the endings come from that say so by themselves."""

UNPLACED = "recover-assume"
"""The recovery that is tried when an object rests in no known relation."""


def cause_of(verdict: Verdict) -> Cause | None:
    """What a verdict says went wrong with the step; None where nothing did."""
    match verdict:
        case Violation(kind=kind, blame=blame):
            return VIOLATIONS[kind, blame]
        case Stalled():
            return Cause.MOTION
        case OverTime():
            return Cause.TIMEOUT
        case _:
            return None


def cause_of_run(category: Category, troubles: Sequence[Cause], recoveries: Sequence[str]) -> Cause | None:
    """What a run failed of; None where it succeeded.

    Parameters
    ----------
    category : Category
        How the run ended.
    troubles : sequence of Cause
        What went wrong in its steps, in order.
    recoveries : sequence of str
        Names of its general recoveries.
    """
    if category is Category.SUCCESS:
        return None
    if category is Category.UNREACHABLE and UNPLACED in recoveries:
        return Cause.PERCEPTION
    if category in ENDINGS:
        return ENDINGS[category]
    if not troubles:
        return Cause.EXTERNAL  # every step did what it should, and the goal does not hold
    if category is Category.MISSED:
        return troubles[-1]  # nothing is planned again: the last trouble ended it
    count = Counter(troubles)
    return max(reversed(troubles), key=lambda cause: count[cause])
