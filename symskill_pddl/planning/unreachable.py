"""What steps that would add an atom need and cannot have, where deletes and negative conditions are left aside."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Generator, Iterable, Iterator

from symskill_pddl.errors import alternatives
from symskill_pddl.planning.grounding import TooLargeError
from symskill_pddl.symbols import Atom, Domain, Operator, Problem

_CLOSEST = 3
"""How many nearly applicable steps an explanation names for one atom."""


class Unreachable:
    """What stands in the way of atoms that cannot be reached; each is spoken of once.

    Parameters
    ----------
    reached : iterable of Atom
        All that can be reached.
    work : int
        Reached facts that are looked at, at most.
    """

    def __init__(self, domain: Domain, problem: Problem, reached: Iterable[Atom], work: int) -> None:
        self._domain, self._problem = domain, problem
        self._objects = problem.object_types
        self._reached = frozenset(reached)
        self._facts: dict[str, list[Atom]] = defaultdict(list)
        for atom in sorted(self._reached):
            self._facts[atom.predicate].append(atom)
        self._left = work
        self._asked: set[Atom] = set()

    def why(self, atom: Atom, role: str) -> Iterator[str]:
        """Lines about an atom that cannot be reached, and about what it would need.

        Raises
        ------
        TooLargeError
            That is more work.
        """
        waiting = [(atom, role)]
        while waiting:
            atom, role = waiting.pop()
            if atom not in self._asked:
                self._asked.add(atom)
                needed = yield from self._one(atom, role)
                waiting += [(other, "needed") for other in sorted(needed, reverse=True)]

    def _one(self, atom: Atom, role: str) -> Generator[str, None, set[Atom]]:
        """Lines about the atom itself; returns what it would need."""
        adders = [(op, add) for op in self._domain.operators for add in sorted(op.add) if add.predicate == atom.predicate]
        if not adders:
            yield f"{role} {atom}: no operator adds '{atom.predicate}', and it does not hold at the start"
            return set()
        attempts = [found for op, effect in adders if (found := self._closest(op, effect, atom)) is not None]
        if not attempts:
            names = alternatives({op.name for op, _ in adders})
            if len(set(atom.args)) != len(atom.args):
                yield f"{role} {atom}: it names one object twice, and {names} takes a different one for each parameter"
            else:
                objects = "there are no objects of the right types for the other parameters"
                yield f"{role} {atom}: no binding of {names} adds it, {objects}"
            return set()
        attempts.sort(key=lambda found: (len(found[1]), found[0]))
        fewest = len(attempts[0][1])
        needed: set[Atom] = set()
        for step, missing in attempts[:_CLOSEST]:
            if len(missing) == fewest:
                needs = " and ".join(map(str, missing))
                yield f"{role} {atom}: {step} would add it, but needs {needs}, which cannot be reached"
                needed.update(missing)
        return needed

    def _closest(self, op: Operator, effect: Atom, atom: Atom) -> tuple[str, tuple[Atom, ...]] | None:
        """The binding of `op` that adds `atom` with the fewest unreachable preconditions, found parameter by parameter."""
        binding: dict[str, str] = {}
        for variable, arg in zip(effect.args, atom.args, strict=True):
            if binding.setdefault(variable, arg) != arg:
                return None
        domain, objects = self._domain, self._objects
        kinds = {p.name: p.type for p in op.parameters}
        pairs = op.distinct_pairs

        def taken(variable: str, name: str) -> bool:
            """Whether a parameter that has to be another is bound to the object."""
            return any(binding.get(b if variable == a else a) == name for a, b in pairs if variable in (a, b))

        if any(taken(v, o) or not domain.is_a(objects[o], kinds[v]) for v, o in binding.items()):
            return None
        for parameter in op.parameters:
            if parameter.name in binding:
                continue
            pool = [o for o, t in self._problem.objects if domain.is_a(t, parameter.type) and not taken(parameter.name, o)]
            if not pool:
                return None
            scored = [(len(self._missing(op, {**binding, parameter.name: o})), i, o) for i, o in enumerate(pool)]
            binding[parameter.name] = min(scored)[2]
        step = "(" + " ".join((op.name, *(binding[p.name] for p in op.parameters))) + ")"
        return step, tuple(self._missing(op, binding))

    def _missing(self, op: Operator, binding: dict[str, str]) -> list[Atom]:
        """Preconditions that no reached atom fulfils; variables that are still free match anything."""
        return [ground for atom in sorted(op.pre) if not self._fits(ground := atom.substitute(binding))]

    def _fits(self, atom: Atom) -> bool:
        if not atom.variables:
            self._look()
            return atom in self._reached
        for fact in self._facts[atom.predicate]:
            self._look()
            if all(a == b or a.startswith("?") for a, b in zip(atom.args, fact.args, strict=True)):
                return True
        return False

    def _look(self) -> None:
        self._left -= 1
        if self._left < 0:
            raise TooLargeError("too many facts are to be looked at")
