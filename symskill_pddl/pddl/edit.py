"""An edited domain in the terms of the library that it was exported from: what the robot plans and watches with.

The export is undone: names come back to identifiers, parameters to the names that the skills know, complement predicates to
negative conditions, `different` and the free arm to what the semantics of `symbols` say anyway. Effects need no way back, because
an action whose effects differ from its skill's is refused by `check`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

from symskill_pddl.errors import InputError
from symskill_pddl.pddl.check import Binding, Comparison, Severity
from symskill_pddl.pddl.dialect import COST_SCALE, Complement, Exported, unifiable
from symskill_pddl.pddl.names import Names
from symskill_pddl.symbols import ROOT_TYPE, Absent, Atom, Domain, Operator, Parameter, Predicate, Type


@dataclass(frozen=True)
class Edited:
    """A domain under the library's identifiers, and the learned operator behind each of its own."""

    domain: Domain
    operators: Mapping[str, str]
    """Name in `domain` to identifier in the library; an action that the person renamed has the person's name."""


def undone(comparison: Comparison, learned: Domain, edited: Domain) -> Edited:
    """Bring an edited domain back to the library's terms.

    Conditions, costs and parameter types are the edit's; effects and the maintained set are the library's, less what the person
    dropped from the preconditions. A dialect without costs keeps the library's, unless the person wrote some.

    Raises
    ------
    InputError
        An action that does not run; all findings are in `comparison`.
    """
    errors = [f for f in comparison.findings if f.severity is Severity.ERROR]
    if errors:
        more = f" (and {len(errors) - 1} more, see symskill check)" if len(errors) > 1 else ""
        raise InputError(f"{errors[0].where}: {errors[0].message}{more}")
    form, back = comparison.form, comparison.names.inverse()
    actions = {op.name: op for op in edited.operators}
    written = any(op.cost != 1.0 for op in edited.operators)
    pairs = {op.name: _distinct(form, edited, op) for op in edited.operators}
    operators, behind = [], {}
    for binding in comparison.bindings:
        old, new = learned.operator(binding.operator), actions[binding.action]
        cost = old.cost if form.dialect in ("strips", "negative") and not written else new.cost
        new = replace(new, distinct=pairs[new.name], cost=cost / COST_SCALE if form.dialect == "costs" else cost)
        op = _operator(form, back, binding, old, new)
        operators.append(op)
        behind[op.name] = old.name
    helpers = {*(c.name for c in form.complements), form.different, form.arm}
    types = tuple(Type(_type(back, t.name), _type(back, t.parent)) for t in edited.types)
    predicates = tuple(
        Predicate(back.predicates.get(p.name, p.name), tuple(_type(back, t) for t in p.types))
        for p in edited.predicates
        if p.name not in helpers
    )
    return Edited(Domain(learned.name, types, predicates, tuple(operators)), behind)


def _distinct(form: Exported, edited: Domain, op: Operator) -> frozenset[tuple[str, str]] | None:
    """The inequalities that an action states, by `=` or by the predicate; None where it states all that its types leave open."""
    order = [p.name for p in op.parameters]
    said = {tuple(sorted(a.args, key=order.index)) for a in op.pre if a.predicate == form.different}
    said |= set(op.distinct_pairs)
    missing = set(unifiable(edited, replace(op, distinct=None))) - said
    return frozenset((a, b) for a, b in said) if missing else None


def _operator(form: Exported, back: Names, binding: Binding, old: Operator, new: Operator) -> Operator:
    variables = {new.parameters[i].name: p.name for i, p in zip(binding.order, old.parameters, strict=True)}
    for parameter in new.parameters:
        if parameter.name not in variables:
            variables[parameter.name] = _fresh(parameter.name, variables.values())
    pre, absent = set[Atom](), set(new.absent)
    denied = {c.name: c for c in form.complements}
    for atom in new.pre:
        if atom.predicate in denied:
            absent.add(_absence(denied[atom.predicate], atom))
        elif atom.predicate not in (form.different, form.arm):
            pre.add(atom)
    kept = back.atoms(pre, variables)
    maintain = old.maintain
    if form.dialect == "temporal":
        maintain = back.atoms((a for a in new.maintain if a.predicate != form.arm), variables)
    return replace(
        old,
        name=back.operators.get(new.name, new.name),
        parameters=tuple(Parameter(variables[p.name], _type(back, p.type)) for p in new.parameters),
        pre=kept,
        absent=frozenset(_renamed(back, a, variables) for a in absent),
        maintain=maintain - (old.pre - kept),
        cost=new.cost,
        distinct=new.distinct and frozenset((variables[a], variables[b]) for a, b in new.distinct),
    )


def _absence(complement: Complement, atom: Atom) -> Absent:
    """What the complement stands for: `keep` are the arguments it has, the others are quantified."""
    args = dict(zip(complement.keep, atom.args, strict=True))
    over = []
    for position, kind in complement.over:
        args[position] = _fresh("?any", args.values())
        over.append(Parameter(args[position], kind))
    return Absent(Atom(complement.predicate, tuple(args[i] for i in sorted(args))), tuple(over))


def _renamed(back: Names, absent: Absent, variables: Mapping[str, str]) -> Absent:
    """Under the skill's variables; a quantified variable that is called like one of them moves aside."""
    inner = {name: to for name, to in variables.items() if name not in {p.name for p in absent.over}}
    over = []
    for parameter in absent.over:
        inner[parameter.name] = _fresh(parameter.name, inner.values())
        over.append(Parameter(inner[parameter.name], _type(back, parameter.type)))
    (atom,) = back.atoms((absent.atom,), inner)
    return Absent(atom, tuple(over))


def _fresh(name: str, taken: Collection[str]) -> str:
    """`name`, or the first of name-2, name-3, ... that is not taken."""
    return next(n for n in (name, *(f"{name}-{i}" for i in range(2, len(taken) + 3))) if n not in taken)


def _type(back: Names, name: str) -> str:
    return ROOT_TYPE if name == ROOT_TYPE else back.types.get(name, name)
