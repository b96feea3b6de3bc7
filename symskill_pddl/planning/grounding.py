"""Ground what can be reached at all, and number it: facts become bits, states integers.

Reachability ignores deletes and negative conditions, and joins preconditions with the facts reached so far (semi-naive: each new
fact is matched once against each precondition it fits). Negative conditions are then compiled at ground level, exactly: every
forbidden atom that can change gets a complement bit, so the search sees positive STRIPS only.
"""

from __future__ import annotations

import time
from collections import defaultdict, deque
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product

from symskill_pddl.planning.protocol import Step
from symskill_pddl.symbols import Atom, Domain, GroundOperator, Operator, Problem, State, check_domain, check_problem


class OutOfTimeError(Exception):
    """The deadline passed while grounding or searching; planners turn it into `Status.TIMEOUT`."""


class TooLargeError(Exception):
    """More ground operators than the limit allows; planners turn it into `Status.FAILED`."""


@dataclass(frozen=True)
class Action:
    """A ground operator over fact numbers."""

    step: Step
    pre: tuple[int, ...]
    add: tuple[int, ...]
    pre_mask: int
    add_mask: int
    delete_mask: int
    cost: float


@dataclass(frozen=True)
class Task:
    """Positive STRIPS over numbered facts. `goal` is None where some goal atom is never reached."""

    n_facts: int
    init: int
    goal: tuple[int, ...] | None
    actions: tuple[Action, ...]

    @property
    def goal_mask(self) -> int:
        return sum(1 << i for i in self.goal or ())


def reachable(
    domain: Domain, problem: Problem, *, deadline: float = float("inf"), limit: int = 200_000, matches: float = float("inf")
) -> tuple[tuple[GroundOperator, ...], dict[Atom, int]]:
    """Ground operators whose positive preconditions can be reached, and every reached atom with its layer of discovery.

    Parameters
    ----------
    deadline : float
        On `time.monotonic` [s].
    matches : float
        Facts and choices of objects that are tried for preconditions and parameters, at most.

    Raises
    ------
    OutOfTimeError, TooLargeError
        The deadline passed, or there are more than `limit` ground operators or than `matches`.
    """
    check_domain(domain)
    check_problem(domain, problem)
    objects = problem.object_types
    kinds = {t for o in domain.operators for p in o.parameters for t in (p.type,)}
    pools = {kind: tuple(o for o, t in problem.objects if domain.is_a(t, kind)) for kind in kinds}
    members = {kind: frozenset(pool) for kind, pool in pools.items()}
    wanted: dict[str, list[tuple[Operator, Atom]]] = defaultdict(list)
    for op in domain.operators:
        for atom in sorted(op.pre):
            wanted[atom.predicate].append((op, atom))
    by_predicate: dict[str, list[Atom]] = defaultdict(list)
    index: dict[tuple[str, int, str], list[Atom]] = defaultdict(list)
    reached: dict[Atom, int] = dict.fromkeys(sorted(problem.init), 0)
    queue = deque(reached)
    ground: dict[Step, GroundOperator] = {}

    tried = 0

    def one_more() -> None:
        """A join may look at millions of facts and fire nothing."""
        nonlocal tried
        tried += 1
        if tried > matches:
            raise TooLargeError(f"more than {matches:g} facts and objects to try")
        if not tried % 256 and time.monotonic() > deadline:
            raise OutOfTimeError

    def fire(op: Operator, binding: Mapping[str, str], layer: int) -> None:
        args = tuple(binding[p.name] for p in op.parameters)
        if (op.name, args) in ground:
            return
        if len(ground) >= limit:
            raise TooLargeError(f"more than {limit} ground operators")
        if time.monotonic() > deadline:
            raise OutOfTimeError
        step = domain.ground(op, args, objects)
        ground[op.name, args] = step
        for atom in sorted(step.add):
            if atom not in reached:
                reached[atom] = layer + 1
                queue.append(atom)

    def complete(op: Operator, todo: list[Atom], binding: dict[str, str]) -> Iterator[dict[str, str]]:
        if not todo:
            free = [p for p in op.parameters if p.name not in binding]
            for choice in product(*(pools[p.type] for p in free)):
                one_more()
                whole = {**binding, **dict(zip((p.name for p in free), choice, strict=True))}
                if _different(op, whole):
                    yield whole
            return
        atom = min(todo, key=lambda a: len(_candidates(a, binding, by_predicate, index)))
        rest = [a for a in todo if a is not atom]
        for fact in tuple(_candidates(atom, binding, by_predicate, index)):
            one_more()
            if (extended := _match(op, atom, fact, binding, members)) is not None:
                yield from complete(op, rest, extended)

    for op in domain.operators:
        if not op.pre:
            for binding in complete(op, [], {}):
                fire(op, binding, 0)
    while queue:
        fact = queue.popleft()
        by_predicate[fact.predicate].append(fact)
        for i, arg in enumerate(fact.args):
            index[fact.predicate, i, arg].append(fact)
        for op, atom in wanted[fact.predicate]:
            if (start := _match(op, atom, fact, {}, members)) is not None:
                for binding in complete(op, [a for a in sorted(op.pre) if a != atom], start):
                    fire(op, binding, reached[fact])
    return tuple(ground[key] for key in sorted(ground)), reached


def _candidates(
    atom: Atom,
    binding: Mapping[str, str],
    by_predicate: Mapping[str, list[Atom]],
    index: Mapping[tuple[str, int, str], list[Atom]],
) -> list[Atom]:
    """The shortest list of known facts that can match, by one bound argument."""
    best = by_predicate.get(atom.predicate, [])
    for i, arg in enumerate(atom.args):
        if arg in binding:
            found = index.get((atom.predicate, i, binding[arg]), [])
            best = min(best, found, key=len)
    return best


def _match(
    op: Operator, atom: Atom, fact: Atom, binding: Mapping[str, str], members: Mapping[str, frozenset[str]]
) -> dict[str, str] | None:
    """The binding that makes `atom` this `fact`, or None; parameters get objects of their types, different ones where they are to
    differ."""
    result = dict(binding)
    types = {p.name: p.type for p in op.parameters}
    for variable, arg in zip(atom.args, fact.args, strict=True):
        if variable in result:
            if result[variable] != arg:
                return None
        elif arg not in members[types[variable]]:
            return None
        else:
            result[variable] = arg
    return result if _different(op, result) else None


def _different(op: Operator, binding: Mapping[str, str]) -> bool:
    """Whether no two parameters that are to differ are bound to one object."""
    if len(set(binding.values())) == len(binding):
        return True
    return op.distinct is not None and all(binding.get(a) != binding.get(b) or a not in binding for a, b in op.distinct_pairs)


def ground_task(
    domain: Domain,
    problem: Problem,
    *,
    extra_costs: Mapping[Step, float],
    deadline: float = float("inf"),
    limit: int = 200_000,
) -> Task:
    """The reachable and relevant part of a problem as a `Task`; raises like `reachable`."""
    steps, reached = reachable(domain, problem, deadline=deadline, limit=limit)
    if not problem.goal <= reached.keys():
        return Task(0, 0, None, ())
    deleted = frozenset(a for step in steps for a in step.delete - step.add)
    possible = [s for s in steps if not any(a in problem.init and a not in deleted for a in s.absent)]
    return Grounding(possible, reached.keys()).task(problem.init, problem.goal, extra_costs)


class Grounding:
    """Ground operators with numbered facts, for any initial state within `reached` and any goal.

    What is reachable from a part of some atoms is reachable from all of them, so a grounding that was made from the atoms of
    several states serves each; the negative conditions are facts of their own and exact in every state.

    Parameters
    ----------
    steps : iterable of GroundOperator
    reached : set of Atom
        Closed under the steps.
    """

    def __init__(self, steps: Iterable[GroundOperator], reached: Iterable[Atom]) -> None:
        self.reached = frozenset(reached)
        possible = tuple(steps)
        forbidden = {a for s in possible for a in s.absent if a in self.reached}
        self._numbers: dict[tuple[Atom, bool], int] = {}
        actions = []
        for step in possible:
            gone = step.delete - step.add
            pre = self._all(step.pre) + self._all(step.absent & forbidden, positive=False)
            add = self._all(step.add - step.pre) + self._all(gone & forbidden, positive=False)
            delete = self._all(gone & self.reached) + self._all(step.add & forbidden, positive=False)
            key = (step.name, step.args)
            actions.append(Action(key, tuple(pre), tuple(add), _mask(pre), _mask(add), _mask(delete), step.cost))
        self._actions = tuple(actions)
        self._relevant: dict[State, tuple[Action, ...]] = {}

    @classmethod
    def of(cls, domain: Domain, problem: Problem, *, deadline: float = float("inf"), limit: int = 200_000) -> Grounding:
        """Everything that can be reached from the problem's initial state; raises like `reachable`."""
        steps, reached = reachable(domain, problem, deadline=deadline, limit=limit)
        return cls(steps, reached)

    def task(self, init: State, goal: State, extra_costs: Mapping[Step, float]) -> Task:
        """The part that is relevant for the goal, from a state that lies within `reached`."""
        if not goal <= self.reached:
            return Task(0, 0, None, ())
        numbers = tuple(self._all(goal))
        if goal not in self._relevant:
            self._relevant[goal] = _relevant(self._actions, numbers)
        actions = self._relevant[goal]
        if extra_costs:
            actions = tuple(replace(a, cost=a.cost + extra_costs[a.step]) if a.step in extra_costs else a for a in actions)
        holding = [i for (atom, positive), i in self._numbers.items() if (atom in init) == positive]
        return Task(len(self._numbers), _mask(holding), numbers, actions)

    def _all(self, atoms: Iterable[Atom], *, positive: bool = True) -> list[int]:
        return [self._numbers.setdefault((a, positive), len(self._numbers)) for a in sorted(atoms)]


def _mask(bits: Iterable[int]) -> int:
    return sum(1 << i for i in set(bits))


def _relevant(actions: tuple[Action, ...], goal: tuple[int, ...]) -> tuple[Action, ...]:
    """Actions that add something which the goal needs, or what such an action needs."""
    needed, kept = set(goal), set[int]()
    changed = True
    while changed:
        changed = False
        for i, action in enumerate(actions):
            if i not in kept and not needed.isdisjoint(action.add):
                kept.add(i)
                needed.update(action.pre)
                changed = True
    return tuple(action for i, action in enumerate(actions) if i in kept)
