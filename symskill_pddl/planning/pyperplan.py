"""`pyperplan`: the planner by Alkhazraji and others, in process. It reads the `strips` dialect and counts steps, not costs.

It is given text, as any planner is; only where the `strips` dialect cannot say a negative condition it gets ground steps. Its
operators are put in order before the search, so that the plan does not depend on the order of Python's sets. Its own log stays
quiet, and no file is written.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version
from math import prod
from typing import Any

from symskill_pddl.errors import InputError, MissingDependencyError, alternatives
from symskill_pddl.pddl.dialect import exported
from symskill_pddl.pddl.export import write_domain, write_problem
from symskill_pddl.pddl.names import Names
from symskill_pddl.pddl.plan import read_plan
from symskill_pddl.planning.engine import Engine
from symskill_pddl.planning.grounding import OutOfTimeError, TooLargeError, ground_task
from symskill_pddl.planning.protocol import Limits, PlanResult, Status
from symskill_pddl.symbols import Domain, Plan, Problem, check_domain, check_problem, validate

SEARCHES = ("astar", "gbf", "wastar")
HEURISTICS = ("blind", "hadd", "hff", "hmax", "lmcut")


@dataclass(frozen=True)
class Pyperplan(Engine):
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

    def plan(self, domain: Domain, problem: Problem, limits: Limits) -> PlanResult:
        """Plan; that costs are ignored a message says where it matters."""
        start = time.monotonic()
        messages: list[str] = []
        if len({op.cost for op in domain.operators}) > 1:
            messages.append("pyperplan counts steps and ignores costs; the planner 'builtin' knows them")

        def result(status: Status, plan: Plan | None = None, *more: str) -> PlanResult:
            return PlanResult(status, plan, time.monotonic() - start, (*more, *messages), self.name)

        deadline = start + limits.time_s
        try:
            if _fits(domain, problem):
                plan = self._by_text(domain, problem, limits, deadline)
            else:
                plan = self._by_ground_steps(domain, problem, limits, deadline)
                messages.append("the 'strips' dialect cannot say this domain, so pyperplan was given the ground steps")
        except OutOfTimeError:
            return result(Status.TIMEOUT, None, f"the time limit of {limits.time_s:g} s passed")
        except TooLargeError as error:
            return result(Status.FAILED, None, str(error))
        if plan is None:
            return result(Status.UNSOLVABLE)
        validate(domain, problem, plan)
        steps = plan.ground(domain, problem.object_types)
        return result(Status.SOLVED, Plan(plan.steps, sum(step.cost for step in steps)))

    def _by_text(self, domain: Domain, problem: Problem, limits: Limits, deadline: float) -> Plan | None:
        form = exported(domain, "strips").domain
        bindings = sum(
            prod(sum(form.is_a(t, p.type) for _, t in problem.objects) for p in op.parameters) for op in form.operators
        )
        if bindings > limits.ground_operators:
            raise TooLargeError(f"{bindings} ground operators, the limit is {limits.ground_operators}")
        names = Names.of(domain, problem.object_types)
        exported_domain, exported_problem = names.domain(domain), names.problem(problem)
        engine = _engine()
        parser = engine.Parser("", "")
        parser.domInput, parser.probInput = write_domain(exported_domain), write_problem(exported_problem, exported_domain)
        with _quiet():
            parsed = parser.parse_problem(parser.parse_domain(read_from_file=False), read_from_file=False)
            solution = self._search(engine, engine.grounding.ground(parsed), deadline)
        if solution is None:
            return None
        return names.inverse().plan(read_plan("\n".join(solution), exported_domain, exported_problem.object_types, "pyperplan"))

    def _by_ground_steps(self, domain: Domain, problem: Problem, limits: Limits, deadline: float) -> Plan | None:
        task = ground_task(domain, problem, extra_costs={}, deadline=deadline, limit=limits.ground_operators)
        if task.goal is None:
            return None
        engine, module = _engine(), import_module("pyperplan.task")

        def facts(mask: int) -> frozenset[str]:
            return frozenset(f"fact-{i}" for i in range(task.n_facts) if mask >> i & 1)

        actions = {f"step-{i:06d}": a for i, a in enumerate(task.actions)}
        operators = [
            module.Operator(name, facts(a.pre_mask), facts(a.add_mask), facts(a.delete_mask & ~a.add_mask))
            for name, a in actions.items()
        ]
        every = frozenset(f"fact-{i}" for i in range(task.n_facts))
        with _quiet():
            solution = self._search(
                engine, module.Task(problem.name, every, facts(task.init), facts(task.goal_mask), operators), deadline
            )
        return None if solution is None else Plan(tuple(actions[name].step for name in solution))

    def _search(self, engine: Any, task: Any, deadline: float) -> list[str] | None:
        task.operators = sorted(task.operators, key=lambda op: op.name)
        inner = engine.HEURISTICS[self.heuristic](task)

        def heuristic(node: Any) -> float:
            if time.monotonic() > deadline:
                raise OutOfTimeError
            return inner(node)

        solution = engine.SEARCHES[self.search](task, heuristic)
        return None if solution is None else [op.name for op in solution]


def _fits(domain: Domain, problem: Problem) -> bool:
    """Whether the problem can be said in the `strips` dialect, just as it is."""
    check_domain(domain)
    check_problem(domain, problem)
    try:
        form = exported(domain, "strips")
        form.problem(problem)
    except InputError:
        return False
    return not form.stated


def _engine() -> Any:
    try:
        return import_module("pyperplan.planner")
    except ImportError:
        raise MissingDependencyError("the planner 'pyperplan' is not installed; pip install pyperplan") from None


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
