"""Why no plan does what every part of the goal can have done to it alone: what is forbidden for good, and what undoes what."""

from __future__ import annotations

from collections import defaultdict
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


class Pairs:
    """Which two atoms may hold together.

    Pairs of atoms are followed through the steps (the heuristic h^2 of Haslum and Geffner, 2000): two atoms that no step brings
    about together, or one beside the other, never hold together. Three that exclude one another only together are not found.

    Parameters
    ----------
    work : int
        Steps, atoms and pairs that are looked at, at most; beyond that every pair is taken for possible.
    """

    def __init__(self, steps: Sequence[GroundOperator], init: State, work: int) -> None:
        self._steps = steps
        self._numbers: dict[Atom, int] = {}
        self._known = self._followed(init, work)

    def exclude(self, one: Atom, two: Atom) -> bool:
        """Whether two atoms, each of which can be reached, can never hold together."""
        return self._known is not None and not self._known[self._number(one)] >> self._number(two) & 1

    def _number(self, atom: Atom) -> int:
        return self._numbers.setdefault(atom, len(self._numbers))

    def _followed(self, init: State, work: int) -> dict[int, int] | None:
        """For each atom a mask of those that it may hold together with, itself among them; None where that is more work."""
        holding = self._mask(init)
        known = defaultdict[int, int](int) | dict.fromkeys(_bits(holding), holding)
        reached = holding
        masks = [tuple(map(self._mask, (s.pre, s.add, s.delete | s.absent))) for s in self._steps]
        changed = True
        while changed:
            changed = False
            for pre, add, against in masks:
                beside = reached & ~against
                for atom in _bits(pre):
                    beside &= known[atom]
                    if pre & ~known[atom]:
                        break
                else:
                    reached |= add
                    for atom in _bits(add):
                        new = (add | beside) & ~known[atom]
                        work -= 1 + new.bit_count()
                        for other in _bits(new):
                            known[atom] |= 1 << other
                            known[other] |= 1 << atom
                        changed |= bool(new)
                work -= 1 + pre.bit_count()
                if work < 0:
                    return None
        return known

    def _mask(self, atoms: Iterable[Atom]) -> int:
        return sum(1 << self._number(atom) for atom in atoms)

    def reasons(self, kept: State, left: State) -> Iterator[str]:
        """For atoms of `left` an atom of `kept` that they exclude, and what steps that add one do to the other."""
        for atom in sorted(left):
            against = [other for other in sorted(kept) if self.exclude(atom, other)]
            if against:
                yield f"{atom} and {against[0]} cannot hold together: {self._spoils(atom, against[0])}"

    def _spoils(self, one: Atom, two: Atom) -> str:
        """What the steps that add each do to the other, a step for each."""
        parts = []
        for atom, other in ((one, two), (two, one)):
            for step in [s for s in self._steps if atom in s.add][:1]:
                if other in step.delete:
                    parts.append(f"{step} takes {other} away")
                elif other in step.absent:
                    parts.append(f"{step} forbids {other}")
                else:
                    needs = next((a for a in sorted(step.pre) if self.exclude(a, other)), None)
                    if needs is not None:
                        parts.append(f"{step} needs {needs}, which cannot hold together with {other} either")
        return "; ".join(parts) or "no step adds one beside the other"


def _bits(mask: int) -> Iterator[int]:
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


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
