"""Asking a planner from a robot that waits: whatever the planner does, there is an answer in time, or a reason why not."""

from __future__ import annotations

from collections.abc import Callable
from threading import Event, Thread
from time import monotonic

from symskill_pddl.errors import InputError, SymSkillError
from symskill_pddl.planning import PlanResult
from symskill_pddl.symbols import Domain, Problem, validate


class BrokenPlannerError(SymSkillError):
    """The planner hung, crashed, or answered with what is no plan."""


def ask(
    solve: Callable[[], PlanResult],
    domain: Domain,
    problem: Problem,
    *,
    limit_s: float,
    wait: Callable[[], None] | None = None,
    period_s: float = 0.05,
) -> PlanResult:
    """The planner's answer, checked.

    The planner runs in a thread of its own. A thread cannot be ended from outside: one that hangs is left behind, asleep or
    busy, until the process ends. (A planner that is a program is ended by its own limits.)

    Parameters
    ----------
    solve : callable
        Asks the planner about `problem`.
    limit_s : float
        What the planner was told it may use [s]; it has half as long again, and half a second, to come back.
    wait : callable, optional
        Called every `period_s` while the planner thinks.

    Raises
    ------
    BrokenPlannerError
        No answer in time, an exception, no `PlanResult`, or a plan that is none by the semantics of `symbols.validate`.
    SymSkillError
        What the planner itself says of bad input.
    """
    answer: list[object] = []
    done = Event()

    def work() -> None:
        try:
            answer.append(solve())
        except BaseException as error:  # noqa: BLE001 - whatever breaks in a planner, the robot has to hear of it
            answer.append(error)
        done.set()

    begin, patience = monotonic(), 1.5 * limit_s + 0.5
    Thread(target=work, daemon=True, name="planner").start()
    while not done.wait(period_s):
        if monotonic() - begin >= patience:
            raise BrokenPlannerError(f"the planner hangs: no answer {patience:.1f} s after it was given {limit_s:g} s")
        if wait is not None:
            wait()
    (found,) = answer
    if isinstance(found, SymSkillError):
        raise found
    if isinstance(found, BaseException):
        raise BrokenPlannerError(f"the planner crashed: {type(found).__name__}: {found}") from found
    if not isinstance(found, PlanResult):
        raise BrokenPlannerError(f"the planner answers with a {type(found).__name__} in place of a result")
    if found.plan is not None:
        try:
            validate(domain, problem, found.plan)
        except InputError as error:
            raise BrokenPlannerError(f"what the planner gives is not a plan: {error}") from None
    return found
