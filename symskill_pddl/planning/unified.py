"""`unified-planning:ENGINE`: any engine that unified-planning knows, by name.

Imported when first asked for, which takes a second.
"""

from __future__ import annotations

import io
import time
import warnings
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import Any, NamedTuple

from symskill_pddl.errors import InputError, MissingDependencyError, alternatives
from symskill_pddl.pddl.export import write_domain, write_problem
from symskill_pddl.pddl.names import Names
from symskill_pddl.pddl.plan import read_plan
from symskill_pddl.planning.engine import Engine, proven
from symskill_pddl.planning.protocol import Limits, PlanResult, Status
from symskill_pddl.symbols import Domain, Plan, Problem, check_problem, validate

_UNSOLVABLE = ("UNSOLVABLE_PROVEN",)
_SOLVED = ("SOLVED_SATISFICING", "SOLVED_OPTIMALLY")


def _unified() -> Any:
    try:
        return import_module("unified_planning.shortcuts")
    except ImportError:
        raise MissingDependencyError("unified-planning is not installed; pip install unified-planning") from None


def engines() -> tuple[str, ...]:
    """Names of the installed engines that make plans."""
    with warnings.catch_warnings():
        # an engine's package may use what setuptools calls deprecated; no user can do anything about it
        warnings.simplefilter("ignore")
        factory = _unified().get_environment().factory
        return tuple(sorted(name for name in factory.engines if factory.engine(name).is_oneshot_planner()))


class Unified(NamedTuple):
    """An object of unified-planning, and the way back."""

    problem: Any
    """A `unified_planning.model.Problem`."""
    names: Names
    """From our names to those in the object; ``names.inverse().plan(...)`` brings a plan back."""


def to_unified_planning(domain: Domain, problem: Problem | None = None, *, dialect: str = "negative") -> Unified:
    """The domain, with a problem of it, as an object of unified-planning.

    Parameters
    ----------
    problem : Problem, optional
        Without one the object has no objects, initial values or goals.
    dialect : str
        What of the domain to bring along: see `pddl.dialect`; the temporal one becomes durative actions.

    Returns
    -------
    Unified
        Its names are PDDL names; where ours are already, nothing is renamed.

    Raises
    ------
    InputError
        The problem does not fit the domain, or the dialect cannot say it.
    MissingDependencyError
        unified-planning is not installed.
    """
    _unified()
    whole = problem or Problem("empty", domain.name, (), frozenset(), frozenset())
    names = Names.of(domain, whole.object_types)
    exported = names.domain(domain)
    texts = [write_domain(exported, dialect=dialect), write_problem(names.problem(whole), exported, dialect=dialect)]
    reader = import_module("unified_planning.io").PDDLReader()
    return Unified(reader.parse_problem_string(*(texts if problem else texts[:1])), names)


@dataclass(frozen=True)
class UnifiedPlanning(Engine):
    """One engine. Of `dialects` it gets the first that it says it supports, so what it cannot read is compiled down for it."""

    engine: str
    licence: str = "Apache-2.0 (unified-planning); see the engine's own"
    dialects: tuple[str, ...] = ("costs", "negative", "strips")

    @classmethod
    def checked(cls, engine: str) -> UnifiedPlanning:
        """The engine, if it is installed; raises `InputError` with the engines there are."""
        if engine not in (known := engines()):
            raise InputError(f"unified-planning has no engine '{engine}' installed; it has: {alternatives(known)}")
        return cls(engine)

    @property
    def name(self) -> str:
        return f"unified-planning:{self.engine}"

    @property
    def version(self) -> str:
        try:
            return version("unified-planning")
        except PackageNotFoundError:
            return "unknown"

    def plan(self, domain: Domain, problem: Problem, limits: Limits) -> PlanResult:
        start = time.monotonic()

        def result(status: Status, plan: Plan | None = None, *more: str) -> PlanResult:
            return PlanResult(status, plan, time.monotonic() - start, more, self.name)

        check_problem(domain, problem)
        if problem.goal <= problem.init:
            return result(Status.SOLVED, Plan((), 0.0), "the goal holds already")
        names = Names.of(domain, problem.object_types)
        exported_domain, exported_problem = names.domain(domain), names.problem(problem)
        refused: list[str] = []
        answer: Any = None
        for dialect in self.dialects:
            try:
                texts = (
                    write_domain(exported_domain, dialect=dialect),
                    write_problem(exported_problem, exported_domain, dialect=dialect),
                )
            except InputError as error:
                if dialect != "strips":
                    raise
                refused.append(str(error))
                continue
            try:
                answer = self._ask(*texts, limits.time_s)
            except Exception as error:  # noqa: BLE001 - engines raise whatever they like; the status says that they failed
                return result(Status.FAILED, None, f"{type(error).__name__}: {' '.join(str(error).split())}")
            if answer is not None:
                break
            refused.append(f"the engine '{self.engine}' does not support the dialect '{dialect}' of this domain")
        if answer is None:
            return result(Status.FAILED, None, *refused)
        status = answer.status.name
        if status in _SOLVED and answer.plan is not None:
            text = "\n".join(
                "(" + " ".join((step.action.name, *map(str, step.actual_parameters))) + ")" for step in answer.plan.actions
            )
            try:
                plan = names.inverse().plan(read_plan(text, exported_domain, exported_problem.object_types, self.name))
                validate(domain, problem, plan)
            except InputError as error:
                return result(Status.FAILED, None, f"what {self.name} gives is not a plan: {error}")
            return result(Status.SOLVED, Plan(plan.steps, sum(s.cost for s in plan.ground(domain, problem.object_types))))
        if status in _UNSOLVABLE:
            return proven(result(Status.UNSOLVABLE), domain, dialect)
        if status == "TIMEOUT":
            return result(Status.TIMEOUT, None, f"the time limit of {limits.time_s:g} s passed")
        return result(Status.FAILED, None, f"the engine ended with the status {status}")

    def _ask(self, domain_text: str, problem_text: str, time_s: float) -> Any:
        """What the engine answers, or None where it does not support the problem."""
        shortcuts = _unified()
        shortcuts.get_environment().credits_stream = None
        translated = import_module("unified_planning.io").PDDLReader().parse_problem_string(domain_text, problem_text)
        with warnings.catch_warnings(), shortcuts.OneshotPlanner(name=self.engine) as engine:
            warnings.simplefilter("ignore")  # engines that know no time limit say so on every call
            if not engine.supports(translated.kind):
                return None
            return engine.solve(translated, timeout=time_s, output_stream=io.StringIO())
