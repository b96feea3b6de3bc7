"""Several plans for one task: each does without a step that the ones before it have.

The planner is asked again and again, with single steps forbidden: after each new plan, once for every step of it, beside the
steps that were forbidden already. So plans differ in at least one step, the first is the planner's own, the next lie near it.
Orders of the same steps are not told apart, and that no further plan is found proves nothing.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator
from dataclasses import replace

from symskill_pddl.errors import InputError
from symskill_pddl.pddl.compiled import compiled
from symskill_pddl.pddl.task import Task
from symskill_pddl.pddl.validate import validate_plan
from symskill_pddl.planning.engine import barred
from symskill_pddl.planning.protocol import Limits, Planner, PlanResult, Step
from symskill_pddl.symbols import Atom, Domain, Plan, Problem


def diverse(planner: Planner, task: Task, count: int, limits: Limits = Limits()) -> Iterator[PlanResult]:
    """Up to `count` results with different plans; the first may have none, and says why.

    Parameters
    ----------
    limits : Limits
        For all plans together.

    Raises
    ------
    BeyondModelError
        Our own model cannot hold the task, so single steps cannot be forbidden.
    InputError
        A count below one.
    """
    if count < 1:
        raise InputError(f"at least one plan has to be wanted, got {count}")
    model = compiled(task)
    start, seen = time.monotonic(), set[frozenset[Step]]()
    todo: deque[frozenset[Step]] = deque([frozenset()])
    tried = set(todo)
    first = True
    while todo and len(seen) < count:
        left = limits.time_s - (time.monotonic() - start)
        if left <= 0.0 and not first:
            return
        forbidden = todo.popleft()
        domain, problem = without(model.domain, model.problem, forbidden)
        found = planner.solve(domain, problem, replace(limits, time_s=max(1e-3, left)))
        if found.plan is None:
            if first:
                yield found
                return
            continue
        first = False
        for step in dict.fromkeys(found.plan.steps):
            if (more := forbidden | {step}) not in tried:
                tried.add(more)
                todo.append(more)
        plan = model.back(found.plan)
        if frozenset(plan.steps) not in seen:
            seen.add(frozenset(plan.steps))
            yield replace(found, plan=_priced(task, plan))


def without(domain: Domain, problem: Problem, steps: frozenset[Step]) -> tuple[Domain, Problem]:
    """The same, but for single ground steps that are not possible."""
    if not steps:
        return domain, problem
    changed, avoid = barred(domain, {name for name, _ in steps})
    return changed, replace(problem, init=problem.init | {Atom(avoid[name], args) for name, args in steps})


def _priced(task: Task, plan: Plan) -> Plan:
    """With what it costs by the texts, once it is sure that it is a plan for them."""
    if task.domain.timed:  # the model knows the order of the steps and not their times
        return plan
    return replace(plan, cost=validate_plan(task, plan))
