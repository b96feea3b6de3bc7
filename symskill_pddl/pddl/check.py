"""What a person changed in an exported domain, in words, and whether each action still has a skill.

Renaming, reordering, more or fewer preconditions, other costs and subtypes are a person's right. An action that no skill belongs
to, a parameter that a skill needs and is gone, and an effect that no demonstration supports are errors: the robot would do
something else than the plan says.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum

from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.pddl.dialect import Exported, exported
from symskill_pddl.pddl.export import number
from symskill_pddl.pddl.names import Names
from symskill_pddl.pddl.renamed import renamed
from symskill_pddl.symbols import Absent, Atom, Domain, Operator, Parameter, Plan


class Severity(Enum):
    """How bad a difference is."""

    NOTE = "note"
    """A change that changes nothing for the robot."""
    WARNING = "warning"
    """Allowed; the plans may become fewer, or steps may start where no demonstration did."""
    ERROR = "error"
    """The action does not run, or does not do what the domain says."""


@dataclass(frozen=True)
class Finding:
    """One difference; `where` names the operator, predicate or type."""

    severity: Severity
    where: str
    message: str

    def __str__(self) -> str:
        return f"{self.severity.value}: {self.where}: {self.message}"


@dataclass(frozen=True)
class Binding:
    """The learned operator behind an edited action."""

    action: str
    operator: str
    """Identifier in the library."""
    order: tuple[int, ...]
    """For each parameter of the learned operator, the position of the edited action's argument that goes there."""


@dataclass(frozen=True)
class Comparison:
    """All differences, in the order of the edited file, and what each edited action that runs is bound to."""

    findings: tuple[Finding, ...]
    bindings: tuple[Binding, ...]
    form: Exported
    """The learned domain in the dialect and under the names that the edited one was compared in."""
    names: Names

    @property
    def runs(self) -> bool:
        """Whether there is no error."""
        return all(f.severity is not Severity.ERROR for f in self.findings)

    def plan(self, plan: Plan, names: Names | None = None) -> Plan:
        """A plan of the edited domain as steps of the learned operators; `names` brings the objects back to their identifiers.

        Raises
        ------
        InputError
            A step whose action is bound to no skill.
        """
        bound = {b.action: b for b in self.bindings}
        back = {name: identifier for identifier, name in names.objects.items()} if names else {}
        steps = []
        for action, args in plan.steps:
            if action not in bound:
                raise InputError(f"the plan uses '{action}', which no skill belongs to; actions with one: {alternatives(bound)}")
            chosen = (args[i] for i in bound[action].order)
            steps.append((bound[action].operator, tuple(back.get(arg, arg) for arg in chosen)))
        return replace(plan, steps=tuple(steps))


def compare(learned: Domain, edited: Domain, *, dialect: str = "strips", names: Names | None = None) -> Comparison:
    """Compare an edited domain with the learned one it was exported from.

    Parameters
    ----------
    learned : Domain
        With the library's identifiers.
    edited : Domain
        As read from the file.
    dialect : str
        What it was exported as; the learned domain is brought to the same form first.
    names : Names, optional
        The side-car of the export; without it, the names that an export without renames gives.

    Raises
    ------
    InputError
        The learned domain does not fit the dialect.
    """
    names = names or Names.of(learned)
    names, words = renamed(exported(names.domain(learned), dialect).domain, edited, names)
    form = exported(names.domain(learned), dialect)
    reference = form.domain
    identifiers = {exported_name: identifier for identifier, exported_name in names.operators.items()}
    findings = [Finding(Severity.NOTE, f"{kind} '{new}'", f"was '{old}', known by its uses") for kind, old, new in words]
    findings += _vocabulary("type", {t.name: t.parent for t in reference.types}, {t.name: t.parent for t in edited.types})
    findings += _vocabulary(
        "predicate",
        {p.name: " ".join(p.types) for p in reference.predicates},
        {p.name: " ".join(p.types) for p in edited.predicates},
    )
    known = {op.name: op for op in reference.operators}
    present = {op.name for op in edited.operators}
    missing = {name: op for name, op in known.items() if name not in present}
    bindings: list[Binding] = []
    for op in edited.operators:
        where = f"action '{op.name}'"
        old = known.get(op.name)
        if old is None:
            twins = [old for old in known.values() if _renamed_parameters(edited, old, op, all_effects=True) is not None]
            # a new name for an action that is gone, or else a second action of a skill
            twins = [old for old in twins if old.name in missing] or twins
            if len(twins) != 1:
                findings.append(
                    Finding(Severity.ERROR, where, f"no skill belongs to it; skills there are: {alternatives(known)}")
                )
                continue
            old = twins[0]
            was = "was" if missing.pop(old.name, None) else "a second action of the skill of"
            findings.append(Finding(Severity.NOTE, where, f"{was} '{old.name}', known by its effects"))
        moved = _renamed_parameters(edited, old, op, all_effects=False)
        if moved is not None:
            pairs = " ".join(f"{a} -> {b}" for a, b in moved.items())
            findings.append(Finding(Severity.NOTE, where, f"parameters renamed: {pairs}; bound by position"))
            old = _rename(old, moved)
        found = [Finding(severity, where, message) for severity, message in _operator(reference, edited, old, op)]
        findings += found
        if all(f.severity is not Severity.ERROR for f in found):
            position = {p.name: i for i, p in enumerate(op.parameters)}
            bindings.append(
                Binding(op.name, identifiers.get(old.name, old.name), tuple(position[p.name] for p in old.parameters))
            )
    for name in missing:
        findings.append(Finding(Severity.NOTE, f"action '{name}'", "removed; its skill will not be used"))
    return Comparison(tuple(findings), tuple(bindings), form, names)


def _vocabulary(what: str, old: dict[str, str], new: dict[str, str]) -> Iterator[Finding]:
    for name, content in new.items():
        if name not in old:
            if what == "predicate":
                message = "added; nothing perceives it, so it is true only where the problem says so"
                yield Finding(Severity.WARNING, f"predicate '{name}'", message)
            else:
                yield Finding(Severity.WARNING, f"{what} '{name}'", f"added, below '{content}'; nothing was learned for it alone")
        elif old[name] != content:
            message = f"was '{old[name]}', is '{content}'"
            severity = Severity.ERROR if what == "predicate" else Severity.WARNING
            yield Finding(severity, f"{what} '{name}'", message)
    for name in (n for n in old if n not in new):
        yield Finding(Severity.NOTE, f"{what} '{name}'", "removed")


def _operator(reference: Domain, edited: Domain, old: Operator, new: Operator) -> Iterator[tuple[Severity, str]]:
    before, after = {p.name: p.type for p in old.parameters}, {p.name: p.type for p in new.parameters}
    for name, kind in before.items():
        if name not in after:
            yield Severity.ERROR, f"the parameter {name} is gone, which its skill needs; it has: {alternatives(after)}"
        elif after[name] != kind:
            if edited.is_a(after[name], kind):
                yield Severity.NOTE, f"the parameter {name} was a {kind}, is a {after[name]}"
            else:
                severity = Severity.WARNING if reference.is_a(kind, after[name]) else Severity.ERROR
                yield severity, f"the parameter {name} was a {kind}, is a {after[name]}, which no demonstration shows"
    for name in after:
        if name not in before:
            yield Severity.WARNING, f"the parameter {name} is new, its skill does not know it"
    if list(before) != list(after) and sorted(before) == sorted(after):
        yield Severity.NOTE, f"the parameters were {' '.join(before)}, are {' '.join(after)}; bound by name"
    yield from _preconditions(old, new)
    for text, atoms in (("adds", (old.add, new.add)), ("deletes", (old.delete, new.delete))):
        for atom in sorted(atoms[1] - atoms[0]):
            yield Severity.ERROR, f"{text} {atom}, which no demonstration supports"
        for atom in sorted(atoms[0] - atoms[1]):
            yield Severity.ERROR, f"no longer {text} {atom}, which the demonstrations show"
    if old.cost != new.cost:
        yield Severity.NOTE, f"its cost was {number(old.cost)}, is {number(new.cost)}"


def _preconditions(old: Operator, new: Operator) -> Iterator[tuple[Severity, str]]:
    for atom in sorted(new.pre - old.pre):
        yield Severity.NOTE, f"also needs {atom}"
    for atom in sorted(old.pre - new.pre):
        yield Severity.WARNING, f"no longer needs {atom}, which held in every demonstration"
    for pair in old.distinct_pairs:
        if (
            pair not in new.distinct_pairs
            and pair[::-1] not in new.distinct_pairs
            and set(pair) <= {p.name for p in new.parameters}
        ):
            yield Severity.WARNING, f"{pair[0]} and {pair[1]} may be one object, which no demonstration shows"
    for absent in sorted(_nameless(new.absent) - _nameless(old.absent)):
        yield Severity.NOTE, f"also forbids {absent.atom}"
    for absent in sorted(_nameless(old.absent) - _nameless(new.absent)):
        yield Severity.WARNING, f"no longer forbids {absent.atom}, which held in no demonstration"


def _nameless(conditions: Iterable[Absent]) -> frozenset[Absent]:
    """Quantified variables renamed after their types, so that their names do not count."""
    found = set()
    for absent in conditions:
        binding = {p.name: f"?{p.type}{i + 1}" for i, p in enumerate(absent.over)}
        parameters = tuple(type(p)(binding[p.name], p.type) for p in absent.over)
        found.add(Absent(absent.atom.substitute(binding), parameters))
    return frozenset(found)


def _renamed_parameters(edited: Domain, old: Operator, new: Operator, *, all_effects: bool) -> dict[str, str] | None:
    """The renaming of parameters, by position, under which both operators have the same effects; None where there is none.

    With `all_effects` a renaming that renames nothing counts too; else only one under which the set of names changes.
    """
    if len(old.parameters) != len(new.parameters):
        return None
    if not all(edited.is_a(b.type, a.type) for a, b in zip(old.parameters, new.parameters, strict=True)):
        return None
    binding = {a.name: b.name for a, b in zip(old.parameters, new.parameters, strict=True)}
    if not all_effects and set(binding) == set(binding.values()):
        return None
    moved = _rename(old, binding)
    return binding if moved.add == new.add and moved.delete == new.delete else None


def _rename(op: Operator, binding: Mapping[str, str]) -> Operator:
    def moved(atoms: Iterable[Atom]) -> frozenset[Atom]:
        return frozenset(a.substitute(binding) for a in atoms)

    return replace(
        op,
        parameters=tuple(Parameter(binding[p.name], p.type) for p in op.parameters),
        pre=moved(op.pre),
        add=moved(op.add),
        delete=moved(op.delete),
        maintain=moved(op.maintain),
        absent=frozenset(Absent(a.atom.substitute(binding), a.over) for a in op.absent),
        distinct=op.distinct and frozenset((binding[a], binding[b]) for a, b in op.distinct),
    )
