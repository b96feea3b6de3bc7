"""A task's texts as our own model, where it can hold them, and the way back of its plans.

First one to one (`symbolic`). What that cannot say is compiled: a disjunction into an operator for each way to fulfil it, a
conditional effect into one for each case, ``exists`` and constants into further parameters, a goal that is no conjunction of
facts into a last operator, ``either`` and equality into static predicates. A plan of the model is a plan of the texts once the
operators' further names and parameters are dropped, and the reverse.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from symskill_pddl.pddl.symbolic import BeyondModelError, Symbolic
from symskill_pddl.pddl.task import Task
from symskill_pddl.pddl.variants import Compiler
from symskill_pddl.symbols import Domain, Plan, Problem


@dataclass(frozen=True)
class Compiled:
    """The model."""

    domain: Domain
    problem: Problem
    actions: Mapping[str, tuple[str, int]] = field(default_factory=dict)
    """Of an operator that is not the action of its name: that action and how many of the arguments it takes; none has no name."""
    remarks: tuple[str, ...] = ()

    def back(self, plan: Plan) -> Plan:
        """A plan of the model as a plan of the texts; its cost is another matter."""
        steps = []
        for name, args in plan.steps:
            action, count = self.actions.get(name, (name, len(args)))
            if action:
                steps.append((action, args[:count]))
        return replace(plan, steps=tuple(steps), cost=None)


def compiled(task: Task) -> Compiled:
    """The task as a model.

    Raises
    ------
    BeyondModelError
        With the place of what the model cannot hold: numbers, time, derived predicates, preferences; or too many cases.
    """
    try:
        domain = Symbolic(task.sources[0]).domain(task.domain)
        return Compiled(domain, Symbolic(task.sources[1]).problem(task.problem))
    except BeyondModelError:
        domain, problem, actions, remarks = Compiler(task).result()
        return Compiled(domain, problem, actions, remarks)
