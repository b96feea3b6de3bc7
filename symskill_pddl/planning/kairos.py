"""`kairos`: the planner Kairos, in process. Fast on large problems; its plans are cleared of detours before they are returned.

It is asked for one plan: as an anytime planner, which it is by default, it would use up the whole time limit on better ones.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from symskill_pddl.planning.protocol import Limits, Status
from symskill_pddl.planning.text import Answer, Ask, Reader, Text
from symskill_pddl.symbols import Plan, Problem

_STATUS = {"SOLVED": Status.SOLVED, "UNSOLVABLE": Status.UNSOLVABLE, "TIMEOUT": Status.TIMEOUT}


@dataclass(frozen=True)
class Kairos(Reader):
    """The first plan that Kairos finds. It proves unsolvability where it can, and says why."""

    family: str = field(default="kairos", init=False, repr=False)
    package: str = field(default="kairos-planner", init=False, repr=False)
    module: str = field(default="kairos", init=False, repr=False)
    licence: str = field(default="Apache-2.0", init=False, repr=False)
    dialects: tuple[str, ...] = field(default=("negative", "costs", "strips", "temporal"), init=False, repr=False)
    shorten: bool = field(default=True, init=False, repr=False)

    def load(self, text: Text) -> Ask:
        kairos = self.engine()
        try:
            domain = kairos.parse_domain(text.domain)
        except kairos.PddlError as refused:
            why = f"kairos does not read the domain: {' '.join(str(refused).split())}"
            return lambda _problem, _limits: Answer(Status.FAILED, messages=(why,))

        def ask(problem: Problem, limits: Limits) -> Answer:
            try:
                parsed = kairos.parse_problem(text.problem(problem), domain)
            except kairos.PddlError as error:
                return Answer(Status.FAILED, messages=(f"kairos does not read the problem: {' '.join(str(error).split())}",))
            # `start` and `wait_first` wake up at once; `solve` looks every five milliseconds
            search = kairos.Planner().start(
                parsed, timeout=limits.time_s, anytime=False, threads=1, memory_limit_mb=limits.memory_mb
            )
            plan = search.wait_first(limits.time_s)
            if plan is not None:  # not `if plan`: a plan without steps is false
                return Answer(Status.SOLVED, _steps(plan))
            search.stop()
            found = search.wait()
            if found.plan is not None:
                return Answer(Status.SOLVED, _steps(found.plan))
            status = found.status.name
            why = tuple(" ".join(str(d).split()) for d in found.diagnostics)
            if status == "CANCELLED":
                return Answer(Status.TIMEOUT)
            return Answer(_STATUS.get(status, Status.FAILED), messages=(f"kairos says '{status.lower()}'", *why))

        return ask


def _steps(plan: Any) -> Plan:
    """In order of their start, where the plan is temporal."""
    steps = sorted(plan.steps, key=lambda step: step.time) if plan.temporal else plan.steps
    return Plan(tuple((step.name, tuple(step.args)) for step in steps))
