"""`MODULE:NAME`: somebody's own planner class, in a process of its own, like ``my_planners:Greedy``.

The class is made without arguments, and needs one method, ``solve(domain, problem, limits, extra_costs)``, which gives a
`PlanResult`; see `protocol.Planner`. Whatever it raises is a status with a message, it is ended when its time is over, and its
plan is believed only after it was run by our own semantics.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from importlib.util import find_spec
from pathlib import Path

from symskill_pddl.errors import InputError
from symskill_pddl.planning.protocol import NO_EXTRA_COSTS, Limits, PlanResult, Status, Step
from symskill_pddl.planning.worker import Remote
from symskill_pddl.symbols import Domain, Plan, Problem, check_problem, validate


@dataclass(frozen=True)
class Own:
    """One planner class."""

    module: str
    attribute: str
    folder: str = field(default_factory=lambda: str(Path.cwd()))
    """Where modules are looked for besides Python's own path."""
    version: str = "unknown"
    licence: str = "unknown"
    dialects: tuple[str, ...] = ()
    _remote: Remote = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        where = {"module": self.module, "name": self.attribute, "folder": self.folder}
        object.__setattr__(self, "_remote", Remote("symskill_pddl.engines.own", where))

    @classmethod
    def exists(cls, module: str) -> bool:
        """Whether there is such a module, on Python's path or in the working folder."""
        top = module.partition(".")[0]
        here = Path.cwd() / top
        return here.with_suffix(".py").is_file() or here.is_dir() or find_spec(top) is not None

    @property
    def name(self) -> str:
        return f"{self.module}:{self.attribute}"

    def solve(
        self, domain: Domain, problem: Problem, limits: Limits = Limits(), extra_costs: Mapping[Step, float] = NO_EXTRA_COSTS
    ) -> PlanResult:
        """Plan; raises `InputError` where the problem does not fit the domain."""
        start = time.monotonic()
        check_problem(domain, problem)
        question = {"domain": domain, "problem": problem, "limits": limits, "extra_costs": dict(extra_costs)}
        reply = self._remote.ask(limits.time_s, limits.memory_mb, **question)
        result = PlanResult(Status.FAILED, None, time.monotonic() - start, reply.messages, self.name)
        if reply.status != Status.SOLVED.value:
            return replace(result, status=Status(reply.status))
        plan = Plan(tuple(reply.plan))
        try:
            validate(domain, problem, plan)
        except InputError as error:
            return replace(result, messages=(f"what {self.name} gives is not a plan: {error}",))
        cost = float(sum(step.cost for step in plan.ground(domain, problem.object_types)))
        return replace(result, status=Status.SOLVED, plan=Plan(plan.steps, cost))
