"""`auto`: for each problem the engine that suits it best, of those installed; and no engine where none is needed.

What costs a robot time is the plan, not the planning: one step takes it seconds. So where the problem is small,
`builtin` plans, whose plans are the cheapest. Beyond, Kairos is the quickest, up to a hundred thousand ground
operators (docs/benchmarks-planning.md); its plans may have a step or two to spare. Its way of searching is chosen by
the number of goal atoms that do not hold: with few, its greedy search with FF's heuristic is up to three times as
quick as what it chooses itself, which takes one goal atom after the other where there are many. Without Kairos there
are Mimir, for as many states as its patience lasts, and `builtin`, which needs nothing installed. An engine that
breaks is followed by the next.

A session first looks whether what is left of the last plan still reaches the goal: then there is nothing to search for. That is
never longer than the rest of that plan, but another plan may be shorter where somebody else has helped meanwhile; the messages
say so. It is not done where a step of it has failed before.

What is taken depends on the problem and the calls before, never on how busy the machine is, as long as time does not run out.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import prod
from typing import NamedTuple

from symskill_pddl import __version__
from symskill_pddl.planning.kairos import Kairos
from symskill_pddl.planning.mimir import Mimir
from symskill_pddl.planning.moves import Numbered, shortened
from symskill_pddl.planning.protocol import NO_EXTRA_COSTS, BySession, Limits, Planner, PlanResult, Session, Status, Step, session
from symskill_pddl.planning.search import Builtin
from symskill_pddl.planning.shorten import Move, rest_of
from symskill_pddl.symbols import Atom, Domain, GroundOperator, Plan, State, check_atom

SMALL = 150
"""Bindings of all operators to objects of their types, up to which `builtin` plans: some milliseconds of work."""
FEW = 8
"""Goal atoms that do not hold, up to which greedy search goes first."""
HEAD_START = 0.25
"""Part of the time that the first of two ways to search may use. It ends sooner or never where it finds a plan."""
PATIENCE = 5_000_000
"""States that `mimir` may look at, times bindings, and five thousand at least: some tenths of a second of work."""
Objects = tuple[tuple[str, str], ...]


class Choice(NamedTuple):
    """An engine to ask, how long, and why."""

    engine: Planner
    part: float
    """Of the time that is left."""
    why: str


def choices(domain: Domain, objects: Objects, unmet: int) -> tuple[Choice, ...]:
    """The engines to ask in turn, until one has an answer.

    Parameters
    ----------
    unmet : int
        Goal atoms that do not hold.
    """
    if bindings(domain, objects) <= SMALL:
        return (Choice(Builtin(), 1.0, "a small problem, whose cheapest plan is soon found"),)
    found: list[Choice] = []
    if Kairos.installed():
        if unmet <= FEW:
            found.append(Choice(Kairos(search="ff"), HEAD_START, f"greedy search for {unmet} goal atoms"))
        found.append(Choice(Kairos(), 1.0, f"its own choice for {unmet} goal atoms"))
    elif Mimir.installed() and len({op.cost for op in domain.operators}) <= 1:
        states = max(5_000, PATIENCE // max(1, bindings(domain, objects)))
        found.append(Choice(Mimir(max_states=states), 1.0, "the quickest engine that is installed"))
    why = "no other is left" if found else "no faster planner is installed; pip install 'symskill-pddl[planners]'"
    return (*found, Choice(Builtin(), 1.0, why))


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


@dataclass(frozen=True)
class _Known:
    """The last plan; its moves are made when they are asked for, as a session may be asked only once."""

    goal: State
    plan: Plan
    planner: str
    domain: Domain
    types: Mapping[str, str]

    @cached_property
    def moves(self) -> tuple[Numbered, tuple[Move[GroundOperator], ...], int]:
        """Numbers of atoms, moves and goal."""
        numbered = Numbered()
        return numbered, tuple(numbered.move(s) for s in self.plan.ground(self.domain, self.types)), numbered.mask(self.goal)


@dataclass
class AutoSession:
    """See `protocol.Session`."""

    domain: Domain
    objects: Objects
    _open: dict[Planner, Session] = field(default_factory=dict)
    _failed: set[tuple[Planner, State]] = field(default_factory=set)
    """Engines with the goals that they were too weak for; they are not asked again."""
    _last: _Known | None = None
    _checked: set[Atom] = field(default_factory=set)

    def __post_init__(self) -> None:
        self._types = dict(self.objects)

    def solve(
        self, init: State, goal: State, limits: Limits = Limits(), extra_costs: Mapping[Step, float] = NO_EXTRA_COSTS
    ) -> PlanResult:
        """Plan with the engine that suits, if one is needed; a message says which and why."""
        start = time.monotonic()
        if (kept := self._kept(init, goal, extra_costs)) is not None:
            return replace(kept, seconds=time.monotonic() - start)
        turned_away = ""
        for choice in choices(self.domain, self.objects, len(goal - init)):
            engine, part, _ = choice
            if (engine, goal) in self._failed and not isinstance(engine, Builtin):
                continue
            left = max(1e-3, limits.time_s - (time.monotonic() - start))
            found = self._with(engine).solve(init, goal, replace(limits, time_s=part * left), extra_costs)
            if found.status is not Status.FAILED and not (found.status is Status.TIMEOUT and part < 1.0):
                break
            self._failed.add((engine, goal))
            said = found.messages[0] if found.messages else "without a word"
            turned_away += f"; {engine.name} {found.status.value} before ({said})"
        if found.plan is not None:
            self._last = _Known(goal, found.plan, found.planner, self.domain, self._types)
        messages = (*found.messages, f"auto took {found.planner}: {choice.why}{turned_away}")
        return PlanResult(found.status, found.plan, time.monotonic() - start, messages, found.planner)

    def _with(self, engine: Planner) -> Session:
        if engine not in self._open:
            self._open[engine] = session(engine, self.domain, self.objects)
        return self._open[engine]

    def _kept(self, init: State, goal: State, extra_costs: Mapping[Step, float]) -> PlanResult | None:
        """What is left of the last plan, if that is a plan from here."""
        if self._last is None or goal != self._last.goal:
            return None
        for atom in init - self._checked:
            check_atom(self.domain, atom, self._types, "init")
        self._checked |= init
        (numbered, moves, wanted), planner = self._last.moves, self._last.planner
        rest = rest_of(moves, numbered.known(init), wanted)
        if rest is None:
            return None
        steps = shortened(self.domain, self._types, (m.of for m in rest), init, goal)
        if any(extra_costs.get((s.name, s.args), 0.0) > 0.0 for s in steps):
            return None
        plan = Plan(tuple((s.name, s.args) for s in steps), float(sum(s.cost for s in steps)))
        said = f"auto asked no planner: {len(steps)} of the {len(moves)} steps that {planner} planned still reach the goal"
        return PlanResult(Status.SOLVED, plan, 0.0, (said,), planner)
