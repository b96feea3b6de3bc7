"""PDDL text to symbols, for the fragment that `symbolic` describes. What lies outside is named in the error, with its place."""

from __future__ import annotations

from collections.abc import Mapping

from symskill_pddl.errors import ParseError
from symskill_pddl.pddl.sections import FileReader, read_atom_list
from symskill_pddl.pddl.symbolic import Symbolic
from symskill_pddl.pddl.syntax import Vocabulary
from symskill_pddl.symbols import Atom, Domain, Problem


def read_domain(text: str, source: str = "<domain>") -> Domain:
    """Parse a domain.

    Raises
    ------
    ParseError
        With line and column: the grammar is broken, a name is unknown or declared twice, or a feature is not supported.
    """
    return Symbolic(source).domain(FileReader(source).domain(text))


def read_problem(text: str, domain: Domain, source: str = "<problem>") -> Problem:
    """Parse a problem of a domain that was read before; raises `ParseError` like `read_domain`."""
    return Symbolic(source).problem(FileReader(source).problem(text, domain.name, vocabulary(domain)))


def read_atoms(text: str, domain: Domain, objects: Mapping[str, str], source: str = "<goal>") -> frozenset[Atom]:
    """Parse ``(p a b) (q c)`` or ``(and (p a b) (q c))``: ground atoms over `objects` (name to type).

    Raises
    ------
    ParseError
        With line and column: not a list of atoms, or an unknown predicate or object, wrong arity, wrong type.
    """
    atoms = read_atom_list(text, vocabulary(domain), {name: (kind,) for name, kind in objects.items()}, source)
    if not atoms:
        raise ParseError("expected at least one atom, like '(predicate object)'", source=source, line=1, column=1)
    return frozenset(atoms)


def vocabulary(domain: Domain) -> Vocabulary:
    """The names of a domain, for reading what is said in them."""
    return Vocabulary(
        {t.name: (t.parent,) for t in domain.types},
        predicates={p.name: tuple((kind,) for kind in p.types) for p in domain.predicates},
        functions={"total-cost": ()},
    )
