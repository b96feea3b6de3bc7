"""Which objects of a transition correspond to which variables: as many shared atoms as possible, in polynomial time.

Atoms about one context object make a linear assignment problem, which is solved exactly. Atoms between two of them make it a
quadratic one. It begins with what an object and a variable can share at best (one round of colour refinement); then one type
after the other is assigned anew, given the rest, and pairs are swapped, as long as that shares more.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.optimize import linear_sum_assignment

from symskill_pddl.symbols import Atom

Tagged = frozenset[tuple[str, Atom]]
"""Atoms with the set they belong to: 'pre', 'add', 'delete' or 'during'."""

UNKNOWN = "*"


@dataclass(frozen=True)
class Side:
    """Atoms, and the type of every name in them that is not fixed: of variables, or of objects."""

    atoms: Tagged
    types: Mapping[str, str]

    def colours(self, known: Mapping[str, str]) -> dict[str, Counter[tuple[str, ...]]]:
        """By name, the atoms that speak of it, its partners as `known` calls them, or as unknown of their type."""
        found: dict[str, Counter[tuple[str, ...]]] = defaultdict(Counter)
        for tag, atom in self.atoms:
            for own in set(atom.args) & self.types.keys():
                seen = ("" if a == own else known.get(a) or UNKNOWN + self.types.get(a, "") for a in atom.args)
                found[own][(tag, atom.predicate, *seen)] += 1
        return found


def best_match(lifted: Side, ground: Side, fixed: Mapping[str, str]) -> dict[str, str]:
    """Object -> variable: `fixed`, and a different object of its type for each variable as long as there are any.

    `lifted` are the atoms that the transitions so far share, with the types of the context variables; `ground` those of the next
    transition, with the types of the objects that are not fixed. Deterministic.
    """
    pools = {
        type_: ([v for v, t in lifted.types.items() if t == type_], sorted(o for o, t in ground.types.items() if t == type_))
        for type_ in sorted(set(lifted.types.values()))
    }
    match, arguments = dict(fixed), {v: v for v in fixed.values()}
    for variables, objects in pools.values():
        match |= _assigned(variables, objects, lifted.colours(arguments), ground.colours(fixed))
    shared, before = _shared(lifted, ground, match), -1
    while shared > before:
        before = shared
        for variables, objects in pools.values():
            for trial in _trials(variables, objects, match, lifted, ground):
                now = _shared(lifted, ground, trial)
                if now > shared:
                    match, shared = trial, now
    return match


def _shared(lifted: Side, ground: Side, match: Mapping[str, str]) -> int:
    return sum((tag, atom.substitute(match)) in lifted.atoms for tag, atom in ground.atoms)


def _trials(
    variables: Sequence[str], objects: Sequence[str], match: Mapping[str, str], lifted: Side, ground: Side
) -> Iterator[dict[str, str]]:
    """The best assignment of one type, given how all else is matched; then pairs of it swapped, where they meet in an atom."""
    every = {v: v for v in match.values()}
    rest = {o: v for o, v in match.items() if o not in objects}
    yield rest | _assigned(variables, objects, lifted.colours(every), ground.colours(match))
    if any(len(set(atom.args) & set(objects)) > 1 for _, atom in ground.atoms):
        for a, b in combinations(objects, 2):
            swapped = {**rest, **{o: match[p] for o, p in zip(objects, _swap(objects, a, b), strict=True) if p in match}}
            yield swapped


def _swap(objects: Sequence[str], a: str, b: str) -> list[str]:
    return [{a: b, b: a}.get(o, o) for o in objects]


def _assigned(
    variables: Sequence[str],
    objects: Sequence[str],
    of_variables: Mapping[str, Counter[tuple[str, ...]]],
    of_objects: Mapping[str, Counter[tuple[str, ...]]],
) -> dict[str, str]:
    """Object -> variable so that most colours agree, those with an unknown partner at half; else in alphabetical order."""
    if not variables or not objects:
        return {}
    none: Counter[tuple[str, ...]] = Counter()
    gain = np.array(
        [
            [
                sum(n * (1.0 if all(a[:1] != UNKNOWN for a in colour) else 0.5) for colour, n in (mine & other).items())
                for other in (of_objects.get(o, none) for o in objects)
            ]
            for mine in (of_variables.get(v, none) for v in variables)
        ]
    )
    order = np.abs(np.arange(len(variables))[:, None] - np.arange(len(objects))[None])
    rows, columns = linear_sum_assignment(order / (4.0 * order.size * max(order.shape)) - gain)
    return {objects[o]: variables[v] for v, o in zip(rows.tolist(), columns.tolist(), strict=True)}
