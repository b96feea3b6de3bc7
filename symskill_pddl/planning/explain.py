"""Why a goal cannot be reached, in words, by delete relaxation; and which part of it can. See also `conflicts`."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import replace
from itertools import combinations

from symskill_pddl.errors import alternatives
from symskill_pddl.planning.conflicts import exclusions, forbidden
from symskill_pddl.planning.grounding import OutOfTimeError, TooLargeError, reachable
from symskill_pddl.planning.protocol import Limits, Planner, Status
from symskill_pddl.symbols import Atom, Domain, Operator, Problem, State

_CLOSEST = 3
"""How many nearly applicable steps an explanation names for one atom."""


def explain(domain: Domain, problem: Problem, limits: Limits = Limits()) -> tuple[str, ...]:
    """One or more lines for each goal atom that stands in the way; empty where the relaxation finds nothing wrong.

    The relaxation never deletes, so what it cannot reach, no plan can. What it reaches may still be out of reach: then the goal
    atoms exclude one another, and `why_not` says which.

    Raises
    ------
    InputError
        The problem does not fit the domain.
    """
    try:
        steps, reached = reachable(domain, problem, deadline=time.monotonic() + limits.time_s, limit=limits.ground_operators)
    except (OutOfTimeError, TooLargeError):
        return ("the problem is too large to be explained within the limits",)
    lines: list[str] = []
    asked: set[Atom] = set()
    for atom in sorted(problem.goal - reached.keys()):
        lines += _why(domain, problem, reached, atom, "goal", asked)
    return tuple(lines or forbidden(steps, problem.init, problem.goal))


def _why(domain: Domain, problem: Problem, reached: dict[Atom, int], atom: Atom, role: str, asked: set[Atom]) -> Iterable[str]:
    if atom in asked:
        return
    asked.add(atom)
    adders = [(op, effect) for op in domain.operators for effect in sorted(op.add) if effect.predicate == atom.predicate]
    if not adders:
        yield f"{role} {atom}: no operator adds '{atom.predicate}', and it does not hold at the start"
        return
    attempts = []
    for op, effect in adders:
        if (found := _closest(domain, problem, reached, op, effect, atom)) is not None:
            attempts.append(found)
    if not attempts:
        names = alternatives({op.name for op, _ in adders})
        if len(set(atom.args)) != len(atom.args):
            yield f"{role} {atom}: it names one object twice, and {names} takes a different one for each parameter"
            return
        yield f"{role} {atom}: no binding of {names} adds it, there are no objects of the right types for the other parameters"
        return
    attempts.sort(key=lambda found: (len(found[1]), found[0]))
    fewest = len(attempts[0][1])
    missing_next: set[Atom] = set()
    for step, missing in attempts[:_CLOSEST]:
        if len(missing) > fewest:
            break
        needs = " and ".join(map(str, missing))
        yield f"{role} {atom}: {step} would add it, but needs {needs}, which cannot be reached"
        missing_next.update(missing)
    for needed in sorted(missing_next):
        yield from _why(domain, problem, reached, needed, "needed", asked)


def _closest(
    domain: Domain, problem: Problem, reached: dict[Atom, int], op: Operator, effect: Atom, atom: Atom
) -> tuple[str, tuple[Atom, ...]] | None:
    """The binding of `op` that adds `atom` with the fewest unreachable preconditions, found parameter by parameter."""
    binding: dict[str, str] = {}
    for variable, arg in zip(effect.args, atom.args, strict=True):
        if binding.setdefault(variable, arg) != arg:
            return None
    objects = problem.object_types
    kinds = {p.name: p.type for p in op.parameters}
    if len(set(binding.values())) != len(binding) or any(not domain.is_a(objects[o], kinds[v]) for v, o in binding.items()):
        return None
    for parameter in op.parameters:
        if parameter.name in binding:
            continue
        pool = [o for o, t in problem.objects if domain.is_a(t, parameter.type) and o not in binding.values()]
        if not pool:
            return None
        scored = [(len(_missing(op, {**binding, parameter.name: o}, reached)), i, o) for i, o in enumerate(pool)]
        binding[parameter.name] = min(scored)[2]
    step = "(" + " ".join((op.name, *(binding[p.name] for p in op.parameters))) + ")"
    return step, tuple(_missing(op, binding, reached))


def _missing(op: Operator, binding: dict[str, str], reached: dict[Atom, int]) -> list[Atom]:
    """Preconditions that no reached atom fulfils; variables that are still free match anything."""
    missing = []
    for atom in sorted(op.pre):
        ground = atom.substitute(binding)
        if ground.variables:
            fits = any(
                fact.predicate == ground.predicate
                and all(a == b or a.startswith("?") for a, b in zip(ground.args, fact.args, strict=True))
                for fact in reached
            )
        else:
            fits = ground in reached
        if not fits:
            missing.append(ground)
    return missing


def nearest_goal(domain: Domain, problem: Problem, planner: Planner, limits: Limits = Limits(time_s=2.0)) -> frozenset[Atom]:
    """A largest part of the goal that the planner solves within the limits, which are for all calls together; possibly empty.

    Subsets are tried from large to small up to eight goal atoms; longer goals are built up greedily, atom by atom.
    """
    deadline = time.monotonic() + limits.time_s
    try:
        _, reached = reachable(domain, problem, deadline=deadline, limit=limits.ground_operators)
    except (OutOfTimeError, TooLargeError):
        return frozenset()
    atoms = sorted(a for a in problem.goal if a in reached)

    def solved(goal: Iterable[Atom]) -> bool:
        left = deadline - time.monotonic()
        if left <= 0.0:
            return False
        return planner.solve(domain, replace(problem, goal=frozenset(goal)), replace(limits, time_s=left)).status is Status.SOLVED

    if len(atoms) <= 8:
        for size in range(len(atoms), 0, -1):
            for subset in combinations(atoms, size):
                if solved(subset):
                    return frozenset(subset)
        return frozenset()
    kept: list[Atom] = []
    for atom in atoms:
        if solved([*kept, atom]):
            kept.append(atom)
    return frozenset(kept)


def why_not(domain: Domain, problem: Problem, planner: Planner, limits: Limits = Limits(time_s=2.0)) -> tuple[str, ...]:
    """The lines of `explain`, and what the nearest reachable goal is; for a goal that a planner found unsolvable."""
    lines = list(explain(domain, problem, limits))
    nearest = nearest_goal(domain, problem, planner, limits)
    left = problem.goal - nearest
    if not lines and left:
        lines += _excluded(domain, problem, nearest, limits)
    if not lines and left:
        lines.append(
            f"each goal atom could be reached by deletion-free steps, but {_listed(left)} not together with {_listed(nearest)}: "
            "deletes or negative conditions stand against it"
        )
    if nearest:
        lines.append(f"the nearest goal that can be reached: {_listed(nearest)}")
    return tuple(lines)


def _excluded(domain: Domain, problem: Problem, nearest: State, limits: Limits) -> Iterable[str]:
    deadline = time.monotonic() + limits.time_s
    try:
        steps, _ = reachable(domain, problem, deadline=deadline, limit=limits.ground_operators)
    except (OutOfTimeError, TooLargeError):
        return ()
    return exclusions(steps, problem.init, nearest, problem.goal - nearest, deadline)


def _listed(atoms: Iterable[Atom]) -> str:
    return " ".join(map(str, sorted(atoms))) or "anything"
