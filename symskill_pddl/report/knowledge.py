"""A library as tables: predicates, operators and skills in words."""

from __future__ import annotations

from dataclasses import dataclass

from symskill_pddl.describe import absent_text, geometry_lines, gripper_text, skill_lines, support_text
from symskill_pddl.library import LearnedOperator, Library
from symskill_pddl.symbols import GRIPPER_OPEN, Atom


@dataclass(frozen=True)
class PredicateView:
    """A predicate and what it means."""

    name: str
    signature: str
    meaning: tuple[str, ...]


@dataclass(frozen=True)
class OperatorView:
    """An operator with its skill and its origin."""

    name: str
    signature: str
    pre: tuple[str, ...]
    add: tuple[str, ...]
    delete: tuple[str, ...]
    maintain: tuple[str, ...]
    cost: float
    support: str
    skill: tuple[str, ...]
    notes: tuple[str, ...]
    evidence: tuple[str, ...]


@dataclass(frozen=True)
class KnowledgeView:
    """All that the page tells of a library."""

    predicates: tuple[PredicateView, ...]
    operators: tuple[OperatorView, ...]
    goals: tuple[tuple[str, str], ...]
    """(task, lifted atoms)."""


def view_library(library: Library) -> KnowledgeView:
    """Tell a library, in its own order."""
    predicates = [PredicateView(GRIPPER_OPEN, "", (gripper_text(library.gripper),))]
    predicates += [PredicateView(c.predicate.name, " ".join(c.predicate.types), geometry_lines(c)) for c in library.classifiers]
    goals = tuple((goal.task, " ".join(_sorted(goal.atoms))) for goal in library.goals)
    return KnowledgeView(tuple(predicates), tuple(_operator(library, learned) for learned in library.operators), goals)


def _operator(library: Library, learned: LearnedOperator) -> OperatorView:
    op = learned.operator
    skill = library.skills.get(learned.skill)
    return OperatorView(
        name=op.name,
        signature=" ".join(f"{p.name} - {p.type}" for p in op.parameters),
        pre=(*_sorted(op.pre), *(absent_text(a) for a in sorted(op.absent))),
        add=_sorted(op.add),
        delete=_sorted(op.delete),
        maintain=_sorted(op.maintain),
        cost=op.cost,
        support=support_text(learned),
        skill=skill_lines(skill) if skill is not None else ("not in the library",),
        notes=learned.notes,
        evidence=tuple(
            f"{e.demo}, {e.start_s:.1f} to {e.stop_s:.1f} s: {', '.join(f'{p} = {o}' for p, o in e.binding)}"
            for e in learned.evidence
        ),
    )


def _sorted(atoms: frozenset[Atom]) -> tuple[str, ...]:
    return tuple(map(str, sorted(atoms)))
