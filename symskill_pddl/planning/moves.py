"""Ground operators as moves over bits, for what `shorten` does with plans."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from symskill_pddl.errors import InputError
from symskill_pddl.planning.shorten import Move, without_detours
from symskill_pddl.symbols import Atom, Domain, GroundOperator, Operator, State


class Numbered:
    """Atoms by number; those of a plan and its goal come first, so that few bits are looked at."""

    def __init__(self) -> None:
        self._bits: dict[Atom, int] = {}
        self.atoms: list[Atom] = []

    def mask(self, atoms: Iterable[Atom]) -> int:
        """Atoms that were not seen before get new bits."""
        found = 0
        for atom in atoms:
            bit = self._bits.get(atom)
            if bit is None:
                bit = self._bits[atom] = 1 << len(self.atoms)
                self.atoms.append(atom)
            found |= bit
        return found

    def known(self, state: State) -> int:
        """Bits of those atoms of a state that have any; the others are of no concern to any move so far."""
        return sum(bit for atom, bit in self._bits.items() if atom in state)

    def move(self, step: GroundOperator) -> Move[GroundOperator]:
        return Move(self.mask(step.pre), self.mask(step.absent), self.mask(step.delete), self.mask(step.add), step.cost, step)


class Alternatives:
    """Ground operators of a domain by what they add; see `shorten.Replacement`.

    Parameters
    ----------
    numbered : Numbered
        Knows all atoms of the plan and of the state that it starts from.
    """

    def __init__(self, domain: Domain, objects: Mapping[str, str], numbered: Numbered) -> None:
        self._domain, self._objects, self._numbered = domain, objects, numbered
        self._index: dict[tuple[str, int, str], list[tuple[Atom, int]]] = {}
        """Atoms and their bits by predicate and one argument; all of a predicate at (predicate, -1, "")."""

    def __call__(self, wanted: int, state: int) -> Move[GroundOperator] | None:
        wants = [self._numbered.atoms[i] for i in range(wanted.bit_length()) if wanted >> i & 1]
        first = wants[0]
        for op in self._domain.operators:
            for effect in sorted(a for a in op.add if a.predicate == first.predicate and len(op.add) >= len(wants)):
                binding = _matched(effect, first, {})
                if binding is not None:
                    for step in self._bindings(op, binding, sorted(op.pre), state):
                        move = self._numbered.move(step)
                        if wanted & move.add == wanted and move.applicable(state):
                            return move
        return None

    def _bindings(self, op: Operator, binding: dict[str, str], todo: list[Atom], state: int) -> Iterator[GroundOperator]:
        """Ground operators whose preconditions hold in the state."""
        if not todo:
            if all(p.name in binding for p in op.parameters):
                try:
                    yield self._domain.ground(op, tuple(binding[p.name] for p in op.parameters), self._objects)
                except InputError:  # not of the right types, or one object for what has to differ
                    return
            return
        atom = max(todo, key=lambda a: sum(x in binding or not x.startswith("?") for x in a.args) - len(a.args))
        rest = [a for a in todo if a is not atom]
        for fact, bit in self._fitting(atom, binding):
            if state & bit and (extended := _matched(atom, fact, binding)) is not None:
                yield from self._bindings(op, extended, rest, state)

    def _fitting(self, atom: Atom, binding: Mapping[str, str]) -> list[tuple[Atom, int]]:
        """Atoms that hold at the start or that the plan adds, with one argument as the binding has it."""
        if not self._index:
            for i, fact in enumerate(self._numbered.atoms):
                for key in ((fact.predicate, -1, ""), *((fact.predicate, k, arg) for k, arg in enumerate(fact.args))):
                    self._index.setdefault(key, []).append((fact, 1 << i))
        bound = [(k, binding.get(x, x)) for k, x in enumerate(atom.args) if x in binding or not x.startswith("?")]
        keys = [(atom.predicate, k, arg) for k, arg in bound] or [(atom.predicate, -1, "")]
        return min((self._index.get(key, []) for key in keys), key=len)


def _matched(pattern: Atom, fact: Atom, binding: Mapping[str, str]) -> dict[str, str] | None:
    """The binding, extended so that the pattern is the fact; None where that cannot be."""
    found = dict(binding)
    for variable, arg in zip(pattern.args, fact.args, strict=True):
        if (found.setdefault(variable, arg) if variable.startswith("?") else variable) != arg:
            return None
    return found


def shortened(
    domain: Domain, objects: Mapping[str, str], steps: Iterable[GroundOperator], init: State, goal: State
) -> tuple[GroundOperator, ...]:
    """A plan from `init` to `goal` without detours; see `shorten`."""
    numbered = Numbered()
    moves, wanted, start = [numbered.move(step) for step in steps], numbered.mask(goal), numbered.mask(init)
    return tuple(m.of for m in without_detours(moves, start, wanted, Alternatives(domain, objects, numbered)))
