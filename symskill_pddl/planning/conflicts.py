"""Why no plan does what every part of the goal can have done to it alone: what is forbidden for good, and what undoes what."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence

from symskill_pddl.symbols import Atom, GroundOperator, State

_MOST = 3
"""How many steps are named for one atom."""


def forbidden(steps: Sequence[GroundOperator], init: State, goal: State) -> Iterator[str]:
    """Goal atoms that only steps can bring about which forbid what holds from the start and for ever.

    Parameters
    ----------
    steps : sequence of GroundOperator
        All that are reachable without deletes and negative conditions.
    """
    possible, lasting, reached = list(steps), init, init
    while True:
        lasting = init - {a for s in possible for a in s.delete}
        allowed = [s for s in possible if not s.absent & lasting]
        reached = _closure(init, allowed)
        allowed = [s for s in allowed if s.pre <= reached]
        if len(allowed) == len(possible):
            break
        possible = allowed  # what is not possible takes nothing away either
    asked: set[tuple[Atom, str]] = set()

    def why(atom: Atom, role: str, verb: str) -> Iterator[str]:
        if (atom, verb) in asked:
            return
        asked.add((atom, verb))
        able = [s for s in steps if atom in (s.add if verb == "add it" else s.delete)]
        able.sort(key=lambda s: (not s.absent & lasting, len(s.pre - reached), str(s)))
        needed, standing = set[Atom](), set[Atom]()
        for step in able[:_MOST]:
            would = f"{role} {atom}: {step} would {verb}, but"
            if against := step.absent & lasting:
                yield f"{would} forbids {_listed(against)}, which holds at the start and stays"
                standing |= against
            else:
                yield f"{would} needs {_listed(step.pre - reached)}, which cannot be reached"
                needed |= step.pre - reached
        for other in sorted(needed):
            yield from why(other, "needed", "add it")
        for other in sorted(standing):
            yield from why(other, "forbidden", "take it away")

    for atom in sorted(goal - reached):
        yield from why(atom, "goal", "add it")


def exclusions(steps: Sequence[GroundOperator], init: State, kept: State, left: State, deadline: float) -> Iterator[str]:
    """For atoms of `left` an atom of `kept` that they cannot hold together with, and what steps that add one do to the other.

    Pairs of atoms are followed through the steps (the heuristic h^2 of Haslum and Geffner, 2000): two atoms that no step brings
    about together, or one beside the other, never hold together. Three that exclude one another only together are not found.

    Parameters
    ----------
    deadline : float
        On `time.monotonic` [s]; nothing is said beyond it.
    """
    pairs = _pairs(steps, init, deadline)
    if pairs is None:
        return
    for atom in sorted(left):
        against = [other for other in sorted(kept) if _pair(atom, other) not in pairs]
        if against:
            yield f"{atom} and {against[0]} cannot hold together: {_spoils(steps, pairs, atom, against[0])}"


def _spoils(steps: Sequence[GroundOperator], pairs: set[frozenset[Atom]], one: Atom, two: Atom) -> str:
    """What the steps that add each do to the other, a step for each."""
    parts = []
    for atom, other in ((one, two), (two, one)):
        for step in [s for s in steps if atom in s.add][:1]:
            if other in step.delete:
                parts.append(f"{step} takes {other} away")
            elif other in step.absent:
                parts.append(f"{step} forbids {other}")
            else:
                needs = next((a for a in sorted(step.pre) if _pair(a, other) not in pairs), None)
                if needs is not None:
                    parts.append(f"{step} needs {needs}, which cannot hold together with {other} either")
    return "; ".join(parts) or "no step adds one beside the other"


def _pair(one: Atom, two: Atom) -> frozenset[Atom]:
    return frozenset((one, two))


def _pairs(steps: Sequence[GroundOperator], init: State, deadline: float) -> set[frozenset[Atom]] | None:
    """Pairs (and single atoms) that may hold together; None where the time is over."""
    known = {_pair(a, b) for a in init for b in init}
    singles, before = set(init), -1
    while len(known) != before:
        before = len(known)
        for step in steps:
            if time.monotonic() > deadline:
                return None
            if any(_pair(a, b) not in known for a in step.pre for b in step.pre):
                continue
            known |= {_pair(a, b) for a in step.add for b in step.add}
            for other in [a for a in singles if a not in step.delete and a not in step.absent]:
                if all(_pair(other, a) in known for a in step.pre):
                    known |= {_pair(other, a) for a in step.add}
            singles |= step.add
    return known


def _closure(init: State, steps: Iterable[GroundOperator]) -> State:
    """What can be reached when nothing is ever deleted."""
    reached, waiting, before = set(init), list(steps), -1
    while len(reached) != before:
        before = len(reached)
        rest = []
        for step in waiting:
            if step.pre <= reached:
                reached |= step.add
            else:
                rest.append(step)
        waiting = rest
    return frozenset(reached)


def _listed(atoms: Iterable[Atom]) -> str:
    return " ".join(map(str, sorted(atoms)))
