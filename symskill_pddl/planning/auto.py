"""`auto`: for each problem the planner that suits it best among those installed; the result says which it was, and why.

What costs a robot time is the plan, not the planning: one step takes it seconds. So `builtin` plans wherever it can plan well,
which is where the problem is small. Larger problems go to `mimir`, whose plans are short, where all operators cost the same, for
as long as its patience lasts, and then to `kairos`, which solves the largest. An engine that breaks is followed by the next, and
in the end by `builtin`.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import prod

from symskill_pddl import __version__
from symskill_pddl.planning.kairos import Kairos
from symskill_pddl.planning.mimir import Mimir
from symskill_pddl.planning.protocol import NO_EXTRA_COSTS, BySession, Limits, Planner, PlanResult, Session, Status, Step, session
from symskill_pddl.planning.search import Builtin
from symskill_pddl.symbols import Domain, State

SMALL = 100
"""Bindings of all operators to objects of their types, up to which `builtin` is as quick as anyone."""
PATIENCE = 5_000_000
"""States that `mimir` may look at, times bindings, and five thousand at least: some tenths of a second of work."""
Objects = tuple[tuple[str, str], ...]


def fast(domain: Domain, objects: Objects) -> tuple[Planner, ...]:
    """The installed engines for a large problem, best first."""
    found: list[Planner] = []
    if Mimir.installed() and len({op.cost for op in domain.operators}) <= 1:
        found.append(Mimir(max_states=max(5_000, PATIENCE // max(1, bindings(domain, objects)))))
    if Kairos.installed():
        found.append(Kairos())
    return tuple(found)


def bindings(domain: Domain, objects: Objects) -> int:
    """How many ground operators there could be, by the types alone."""
    kinds = Counter(kind for _, kind in objects)
    fitting = {
        kind: sum(n for k, n in kinds.items() if domain.is_a(k, kind))
        for kind in {p.type for op in domain.operators for p in op.parameters}
    }
    return sum(prod(fitting[p.type] for p in op.parameters) for op in domain.operators)


@dataclass(frozen=True)
class Auto(BySession):
    """The planner `auto`; see the module's text."""

    name: str = "auto"
    version: str = __version__
    licence: str = "Apache-2.0; see the engines it takes"
    dialects: tuple[str, ...] = ("strips", "negative", "costs")

    def session(self, domain: Domain, objects: Objects) -> AutoSession:
        """A session with each engine that is needed, opened when it is."""
        return AutoSession(domain, objects)


@dataclass
class AutoSession:
    """See `protocol.Session`."""

    domain: Domain
    objects: Objects
    _open: dict[str, Session] = field(default_factory=dict)
    _failed: set[tuple[str, State]] = field(default_factory=set)
    """Engines with the goals that they were too weak for; they are not asked again."""

    def solve(
        self, init: State, goal: State, limits: Limits = Limits(), extra_costs: Mapping[Step, float] = NO_EXTRA_COSTS
    ) -> PlanResult:
        """Plan with the engine that suits; a message says which and why."""
        start = time.monotonic()
        engines, why = self._choose()
        for engine in (e for e in engines if e.name == "builtin" or (e.name, goal) not in self._failed):
            left = max(1e-3, limits.time_s - (time.monotonic() - start))
            found = self._with(engine).solve(init, goal, replace(limits, time_s=left), extra_costs)
            if found.status is not Status.FAILED:
                break
            self._failed.add((engine.name, goal))
            why = f"{why}; {engine.name} failed ({found.messages[0] if found.messages else 'without a word'})"
        messages = (*found.messages, f"auto took {found.planner}: {why}")
        return PlanResult(found.status, found.plan, time.monotonic() - start, messages, found.planner)

    def _choose(self) -> tuple[tuple[Planner, ...], str]:
        """Engines to ask in turn, `builtin` last; and why."""
        number = bindings(self.domain, self.objects)
        if number <= SMALL:
            return (Builtin(),), f"the problem is small, {number} ground operators by type"
        if engines := fast(self.domain, self.objects):
            return (*engines, Builtin()), f"the problem is large, {number} ground operators by type"
        return (Builtin(),), "no faster planner is installed; pip install 'symskill-pddl[planners]'"

    def _with(self, engine: Planner) -> Session:
        if engine.name not in self._open:
            self._open[engine.name] = session(engine, self.domain, self.objects)
        return self._open[engine.name]
