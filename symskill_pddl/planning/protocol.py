"""What a planner is: a domain, a problem and limits in; a status and a plan out."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from types import MappingProxyType
from typing import Protocol, runtime_checkable

from symskill_pddl.errors import InputError, NoPlanError
from symskill_pddl.symbols import Domain, Plan, Problem, State

Step = tuple[str, tuple[str, ...]]
"""A ground step as plans hold it: operator name and arguments."""
NO_EXTRA_COSTS: Mapping[Step, float] = MappingProxyType({})


@dataclass(frozen=True)
class Limits:
    """What a call may use up."""

    time_s: float = 10.0
    """Wall-clock time [s]."""
    ground_operators: int = 200_000
    """Ground operators; beyond that the planner gives up with `Status.FAILED` before memory runs out."""

    memory_mb: int = 4096
    """Memory of a planner that is a program of its own [MiB]."""

    def __post_init__(self) -> None:
        if self.memory_mb < 1:
            raise InputError(f"a planner needs memory, got the limit {self.memory_mb} MiB")
        if not self.time_s > 0.0:
            raise InputError(f"a planner needs a time limit above zero, got {self.time_s:g} s")
        if self.ground_operators < 1:
            raise InputError(f"a planner needs at least one ground operator, got the limit {self.ground_operators}")


class Status(Enum):
    """How a call ended. Raw planners mix these up; here they are four different things."""

    SOLVED = "solved"
    """There is a plan; it has no steps where the goal holds already."""
    UNSOLVABLE = "unsolvable"
    """Proved: no plan exists."""
    TIMEOUT = "timeout"
    FAILED = "failed"
    """The planner could not take the problem, or broke; `messages` say why."""


@dataclass(frozen=True)
class PlanResult:
    """The answer of a planner. `plan` is there if and only if the status is SOLVED."""

    status: Status
    plan: Plan | None = None
    seconds: float = 0.0
    """Wall-clock time of the call [s]."""
    messages: tuple[str, ...] = ()
    planner: str = ""

    def __post_init__(self) -> None:
        if (self.plan is not None) != (self.status is Status.SOLVED):
            raise InputError(f"a result with the status '{self.status.value}' has {'no' if self.plan is None else 'a'} plan")

    def unwrap(self) -> Plan:
        """The plan; raises `NoPlanError` with the status and the first message where there is none."""
        if self.plan is None:
            why = f": {self.messages[0]}" if self.messages else ""
            raise NoPlanError(f"planner '{self.planner}' found no plan, {self.status.value} after {self.seconds:.2f} s{why}")
        return self.plan


class Planner(Protocol):
    """A planning engine. `solve` raises `InputError` for an ill-formed problem and nothing else."""

    @property
    def name(self) -> str:
        """What `planning.get` knows it by."""

    @property
    def version(self) -> str:
        """Of the engine."""

    @property
    def licence(self) -> str:
        """SPDX identifier of the engine's licence."""

    @property
    def dialects(self) -> tuple[str, ...]:
        """Dialects of exported text that it reads."""

    def solve(
        self, domain: Domain, problem: Problem, limits: Limits = ..., extra_costs: Mapping[Step, float] = ...
    ) -> PlanResult:
        """Plan from `problem.init` to `problem.goal`; `extra_costs` come on top of the operator's cost, per ground step."""


class Session(Protocol):
    """A planner that has a domain and its objects loaded, for one state after another while a robot waits."""

    def solve(self, init: State, goal: State, limits: Limits = ..., extra_costs: Mapping[Step, float] = ...) -> PlanResult:
        """As `Planner.solve` over the session's objects."""


@runtime_checkable
class Warm(Protocol):
    """What planners have that keep more between two calls than their name."""

    def session(self, domain: Domain, objects: tuple[tuple[str, str], ...]) -> Session:
        """Load a domain and the objects, (object, type) pairs, of the problems to come."""


class BySession(ABC):
    """A planner whose `solve` is a session's that is asked once."""

    @abstractmethod
    def session(self, domain: Domain, objects: tuple[tuple[str, str], ...]) -> Session:
        """See `Warm`."""

    def solve(
        self, domain: Domain, problem: Problem, limits: Limits = Limits(), extra_costs: Mapping[Step, float] = NO_EXTRA_COSTS
    ) -> PlanResult:
        """Plan; raises `InputError` where the problem does not fit the domain, and what opening a session raises."""
        start = time.monotonic()
        found = self.session(domain, problem.objects).solve(problem.init, problem.goal, limits, extra_costs)
        return replace(found, seconds=time.monotonic() - start)


@dataclass(frozen=True)
class _Cold:
    """A session that keeps nothing, for planners that cannot."""

    planner: Planner
    domain: Domain
    objects: tuple[tuple[str, str], ...]

    def solve(
        self, init: State, goal: State, limits: Limits = Limits(), extra_costs: Mapping[Step, float] = NO_EXTRA_COSTS
    ) -> PlanResult:
        problem = Problem("replanning", self.domain.name, self.objects, init, goal)
        return self.planner.solve(self.domain, problem, limits, extra_costs)


def session(planner: Planner, domain: Domain, objects: tuple[tuple[str, str], ...]) -> Session:
    """A session with any planner: warm where it can keep something, and plain calls of `solve` where it cannot."""
    return planner.session(domain, objects) if isinstance(planner, Warm) else _Cold(planner, domain, objects)
