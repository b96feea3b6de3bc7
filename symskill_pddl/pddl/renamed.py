"""Predicates and types that a person gave another name: known again by where they stand."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping

from symskill_pddl.errors import InputError
from symskill_pddl.pddl.names import Names
from symskill_pddl.symbols import Atom, Domain, Operator

Renamed = tuple[str, str, str]
"""Kind, old name, new name."""


def renamed(reference: Domain, edited: Domain, names: Names) -> tuple[Names, tuple[Renamed, ...]]:
    """Names under which what a person renamed is known again.

    A type that is gone and one that is new are taken for the same where they are the types of the same parameters of the same
    actions; a predicate, where it stands in the same effects (or, where no action changes it, in the same conditions). What two
    could be is taken for neither.

    Parameters
    ----------
    reference : Domain
        The learned domain as `names` export it.
    """
    found: list[Renamed] = []
    shared = {o.name for o in reference.operators} & {o.name for o in edited.operators}
    uses = (_type_uses, _predicate_uses)
    for kind, used, old, new in zip(
        ("type", "predicate"),
        uses,
        ({t.name for t in reference.types}, {p.name for p in reference.predicates}),
        ({t.name for t in edited.types}, {p.name for p in edited.predicates}),
        strict=True,
    ):
        before, after = used(reference, shared, old - new), used(edited, shared, new - old)
        for name, where in sorted(before.items()):
            same = [n for n, w in after.items() if w == where]
            if len(same) == 1 and list(before.values()).count(where) == 1:
                found.append((kind, name, same[0]))
    if not found:
        return names, ()
    changed = {f"{kind}s": dict(getattr(names, f"{kind}s")) for kind, _, _ in found}
    for kind, name, new_name in found:
        mapping = changed[f"{kind}s"]
        identifier = next((i for i, exported in mapping.items() if exported == name), name)
        mapping[identifier] = new_name
    try:
        return Names.model_validate({**names.model_dump(), **changed}), tuple(found)
    except InputError:  # a name that no export would give: the comparison says what is the matter
        return names, ()


def _type_uses(domain: Domain, shared: set[str], names: set[str]) -> dict[str, Hashable]:
    found: dict[str, set[tuple[str, int]]] = {name: set() for name in names}
    for op in (o for o in domain.operators if o.name in shared):
        for i, parameter in enumerate(op.parameters):
            if parameter.type in found:
                found[parameter.type].add((op.name, i))
    return {name: frozenset(uses) for name, uses in found.items() if uses}


def _predicate_uses(domain: Domain, shared: set[str], names: set[str]) -> dict[str, Hashable]:
    operators = [o for o in domain.operators if o.name in shared]
    effects = _standing(operators, names, ("add", "delete"))
    conditions = _standing(operators, names - effects.keys(), ("pre",))
    return {**effects, **conditions}


def _standing(operators: Iterable[Operator], names: set[str], sets: tuple[str, ...]) -> Mapping[str, Hashable]:
    found: dict[str, set[Hashable]] = {}
    for op in operators:
        order = {p.name: i for i, p in enumerate(op.parameters)}
        for which in sets:
            atoms: Iterable[Atom] = getattr(op, which)
            for atom in atoms:
                if atom.predicate in names:
                    found.setdefault(atom.predicate, set()).add((op.name, which, tuple(order.get(a, -1) for a in atom.args)))
    return {name: frozenset(uses) for name, uses in found.items()}
