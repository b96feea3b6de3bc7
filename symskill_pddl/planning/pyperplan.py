"""`pyperplan`: the planner by Alkhazraji and others, in process. It reads the `strips` dialect and counts steps, not costs.

It is given text, as any planner is, and its operators are put in order before the search, so that the plan does not depend on the
order of Python's sets. Its own log stays quiet, and no file is written.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version
from math import prod
from typing import Any

from symskill_pddl.errors import InputError, MissingDependencyError, ParseError, alternatives
from symskill_pddl.pddl.dialect import exported
from symskill_pddl.pddl.export import write_domain, write_problem
from symskill_pddl.pddl.names import Names
from symskill_pddl.pddl.plan import read_plan
from symskill_pddl.planning.grounding import OutOfTimeError
from symskill_pddl.planning.protocol import NO_EXTRA_COSTS, Limits, PlanResult, Status, Step
from symskill_pddl.symbols import Domain, Plan, Problem

SEARCHES = ("astar", "gbf", "wastar")
HEURISTICS = ("blind", "hadd", "hff", "hmax", "lmcut")


@dataclass(frozen=True)
class Pyperplan:
    """A* with h_add by default: deterministic, fast, mostly shortest plans.

    ``hmax`` and ``lmcut`` are admissible, so A* with them is optimal in steps. ``hff`` breaks ties by Python's set order.
    """

    search: str = "astar"
    heuristic: str = "hadd"
    licence: str = "GPL-3.0-or-later"
    dialects: tuple[str, ...] = ("strips",)

    def __post_init__(self) -> None:
        for what, value, known in (("search", self.search, SEARCHES), ("heuristic", self.heuristic, HEURISTICS)):
            if value not in known:
                raise InputError(f"pyperplan has no {what} '{value}'; there are: {alternatives(known)}")

    @property
    def name(self) -> str:
        plain = (self.search, self.heuristic) == ("astar", "hadd")
        return "pyperplan" if plain else f"pyperplan:{self.search}:{self.heuristic}"

    @property
    def version(self) -> str:
        return version("pyperplan")

    def solve(
        self,
        domain: Domain,
        problem: Problem,
        limits: Limits = Limits(),
        extra_costs: Mapping[Step, float] = NO_EXTRA_COSTS,
    ) -> PlanResult:
        """Plan; costs are ignored, which a message says where it matters.

        Raises
        ------
        InputError
            The problem does not fit the domain, or the domain does not fit the `strips` dialect.
        MissingDependencyError
            pyperplan is not installed.
        """
        start = time.monotonic()
        messages: list[str] = []
        if any(extra_costs.values()) or len({op.cost for op in domain.operators}) > 1:
            messages.append("pyperplan counts steps and ignores costs; the planner 'builtin' knows them")

        def result(status: Status, plan: Plan | None = None, *more: str) -> PlanResult:
            return PlanResult(status, plan, time.monotonic() - start, (*more, *messages), self.name)

        form = exported(domain, "strips")
        whole = form.problem(problem)
        bindings = sum(
            prod(sum(form.domain.is_a(t, p.type) for _, t in whole.objects) for p in op.parameters)
            for op in form.domain.operators
        )
        if bindings > limits.ground_operators:
            return result(Status.FAILED, None, f"{bindings} ground operators, the limit is {limits.ground_operators}")
        names = Names.of(domain, problem.object_types)
        exported_domain, exported_problem = names.domain(domain), names.problem(problem)
        texts = write_domain(exported_domain), write_problem(exported_problem, exported_domain)
        try:
            with _quiet():
                found = self._run(*texts, start + limits.time_s)
        except OutOfTimeError:
            return result(Status.TIMEOUT, None, f"the time limit of {limits.time_s:g} s passed")
        except RecursionError:
            return result(Status.FAILED, None, "pyperplan's parser gave up: the problem is nested too deeply")
        if found is None:
            return result(Status.UNSOLVABLE)
        try:
            plan = read_plan(found, exported_domain, exported_problem.object_types, "pyperplan")
        except ParseError as error:
            return result(Status.FAILED, None, f"pyperplan's plan is not a plan of the domain: {error}")
        plan = names.inverse().plan(plan)
        steps = plan.ground(domain, problem.object_types)
        return result(Status.SOLVED, Plan(plan.steps, sum(step.cost for step in steps)))

    def _run(self, domain_text: str, problem_text: str, deadline: float) -> str | None:
        try:
            engine: Any = import_module("pyperplan.planner")
        except ImportError:
            raise MissingDependencyError("the planner 'pyperplan' is not installed; pip install pyperplan") from None
        parser = engine.Parser("", "")
        parser.domInput, parser.probInput = domain_text, problem_text
        problem = parser.parse_problem(parser.parse_domain(read_from_file=False), read_from_file=False)
        task = engine.grounding.ground(problem)
        task.operators = sorted(task.operators, key=lambda op: op.name)
        inner = engine.HEURISTICS[self.heuristic](task)

        def heuristic(node: Any) -> float:
            if time.monotonic() > deadline:
                raise OutOfTimeError
            return inner(node)

        solution = engine.SEARCHES[self.search](task, heuristic)
        return None if solution is None else "\n".join(op.name for op in solution)


@contextmanager
def _quiet() -> Iterator[None]:
    """Drop what pyperplan logs on the root logger, and keep it from configuring that logger."""
    root, handler = logging.getLogger(), logging.NullHandler()

    def drop(record: logging.LogRecord) -> bool:
        return "pyperplan" not in record.pathname.replace("\\", "/").split("/")[-4:]

    root.addHandler(handler)
    root.addFilter(drop)
    try:
        yield
    finally:
        root.removeFilter(drop)
        root.removeHandler(handler)
