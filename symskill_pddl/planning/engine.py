"""What our planners share: one `solve`, sessions, and what becomes of steps that failed before.

An executor gives every ground step that failed an extra cost. `builtin` adds it to the step's own. No other engine can: PDDL
gives costs to actions, not to single steps, and most of these engines look for any plan, not for the cheapest, so a cost would
not keep them from the step. They plan without such steps for one call: the domain gets a predicate ``avoid-ACTION`` for each
action concerned, which is static, holds of the steps in question and forbids them. Only where there is no such plan, or none in
half of the time, do they plan with all steps; the messages say which it was.
"""

from __future__ import annotations

import time
from abc import abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace

from symskill_pddl.pddl.dialect import exported, fresh
from symskill_pddl.planning.protocol import NO_EXTRA_COSTS, BySession, Limits, PlanResult, Session, Status, Step
from symskill_pddl.symbols import Absent, Atom, Domain, Predicate, Problem, State

Objects = tuple[tuple[str, str], ...]
"""(object, type) pairs."""
Ask = Callable[[State, State, Limits], PlanResult]
"""Plans from a state to a goal, over a domain and objects that were given before."""


class Engine(BySession):
    """A planner that knows no costs of single ground steps. It says how it plans; keeping a domain loaded is a choice.

    Ground steps with extra costs are left out where there is another way. Besides what `solve` raises otherwise, there is
    `MissingDependencyError` where the engine is not installed, and `InputError` where its dialect cannot say the problem.
    """

    @abstractmethod
    def plan(self, domain: Domain, problem: Problem, limits: Limits) -> PlanResult:
        """Plan once; raises `InputError` where the problem does not fit the domain, or the domain the engine."""

    def open(self, domain: Domain, objects: Objects) -> Ask:
        """Load a domain; an engine that keeps nothing is given all of it each time."""
        return lambda init, goal, limits: self.plan(domain, Problem("replanning", domain.name, objects, init, goal), limits)

    def session(self, domain: Domain, objects: Objects) -> Session:
        """The engine with the domain loaded."""
        return _Avoiding(self, domain, objects)


class _Avoiding:
    """See `protocol.Session`. One loaded domain for all steps, and one for the actions that steps are left out of."""

    def __init__(self, engine: Engine, domain: Domain, objects: Objects) -> None:
        self._engine, self._domain, self._objects = engine, domain, objects
        self._all = engine.open(domain, objects)
        self._barred: tuple[frozenset[str], dict[str, str], Ask] | None = None

    def solve(
        self, init: State, goal: State, limits: Limits = Limits(), extra_costs: Mapping[Step, float] = NO_EXTRA_COSTS
    ) -> PlanResult:
        """Plan from `init` to `goal`."""
        steps = sorted(step for step, extra in extra_costs.items() if extra > 0.0)
        if not steps:
            return self._all(init, goal, limits)
        start = time.monotonic()
        avoid, ask = self._without(frozenset(name for name, _ in steps))
        marks = frozenset(Atom(avoid[name], args) for name, args in steps)
        named = ", ".join("(" + " ".join((name, *args)) + ")" for name, args in steps)
        found = ask(init | marks, goal, replace(limits, time_s=limits.time_s / 2))
        said = f"left out for this call, as failed before: {named}"
        if found.status is not Status.SOLVED:
            left = max(1e-3, limits.time_s - (time.monotonic() - start))
            said = f"no plan without the steps that failed before ({found.status.value}), so none was left out: {named}"
            found = self._all(init, goal, replace(limits, time_s=left))
        return replace(found, seconds=time.monotonic() - start, messages=(*found.messages, said))

    def _without(self, operators: frozenset[str]) -> tuple[dict[str, str], Ask]:
        """The predicates that forbid steps, by operator, and the engine with a domain that has them."""
        if self._barred is None or not operators <= self._barred[0]:
            known = operators if self._barred is None else operators | self._barred[0]
            domain, avoid = barred(self._domain, known)
            self._barred = known, avoid, self._engine.open(domain, self._objects)
        return self._barred[1], self._barred[2]


def proven(found: PlanResult, domain: Domain, dialect: str) -> PlanResult:
    """What an engine found for the text in a dialect, of the domain: where the text needs more, no plan proves nothing."""
    if found.status is not Status.UNSOLVABLE or not (stated := exported(domain, dialect).stated):
        return found
    said = (
        f"no plan for the '{dialect}' text, where '{stated[0].operator}' needs {stated[0].needs} too; try the dialect 'negative'"
    )
    return replace(found, status=Status.FAILED, messages=(*found.messages, said))


def barred(domain: Domain, operators: Iterable[str]) -> tuple[Domain, dict[str, str]]:
    """The domain with a static predicate for each of the operators that forbids its steps, and their names."""
    avoid: dict[str, str] = {}
    for op in (domain.operator(name) for name in sorted(operators)):
        avoid[op.name] = fresh(f"avoid-{op.name}", domain)
        condition = Absent(Atom(avoid[op.name], tuple(p.name for p in op.parameters)))
        changed = replace(op, absent=op.absent | {condition})
        domain = replace(
            domain,
            predicates=(*domain.predicates, Predicate(avoid[op.name], tuple(p.type for p in op.parameters))),
            operators=tuple(changed if o.name == op.name else o for o in domain.operators),
        )
    return domain, avoid
