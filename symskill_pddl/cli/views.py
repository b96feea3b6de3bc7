"""A library as tables and as JSON."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from symskill_pddl.cli.operators import COLUMNS, operator_rows
from symskill_pddl.describe import absent_text, atoms_text, geometry_text, gripper_text, skill_lines
from symskill_pddl.library import LearnedOperator, Library
from symskill_pddl.symbols import GRIPPER_OPEN, Atom

Rows = list[tuple[str, ...]]
Table = tuple[str, tuple[str, ...], Rows]
"""Title, columns, rows."""


def library_tables(library: Library) -> Iterator[Table]:
    """Title, columns and rows of each table."""
    yield "Predicates", ("predicate", "meaning"), predicate_rows(library)
    yield operator_table(library)
    yield "Skills", ("skill", "phases"), skill_rows(library)
    if library.goals:
        goals: Rows = [
            (g.task, " ".join(f"{p.name} - {p.type}" for p in g.parameters), atoms_text(g.atoms)) for g in library.goals
        ]
        yield "Goals", ("task", "parameters", "atoms"), goals


def predicate_rows(library: Library) -> Rows:
    """Predicate and geometry, the built-in one first."""
    rows: Rows = [(f"({GRIPPER_OPEN})", gripper_text(library.gripper))]
    for classifier in library.classifiers:
        signature = " ".join((classifier.predicate.name, *classifier.predicate.types))
        rows.append((f"({signature})", geometry_text(classifier)))
    return rows


def operator_table(library: Library) -> Table:
    """The operators in the form of the paper's table."""
    return "Operators", COLUMNS, list(operator_rows(library))


def skill_rows(library: Library) -> Rows:
    """Skill, and its phases in order."""
    return [(name, "\n".join(skill_lines(skill))) for name, skill in library.skills.items()]


def library_json(library: Library) -> dict[str, Any]:
    """Everything the tables say, for programs. Times in seconds."""
    return {
        "types": {t.name: t.parent for t in library.types},
        "predicates": [
            {"name": GRIPPER_OPEN, "types": [], "learned": False, "meaning": gripper_text(library.gripper)},
            *(
                {
                    "name": c.predicate.name,
                    "types": list(c.predicate.types),
                    "learned": True,
                    "meaning": geometry_text(c),
                }
                for c in library.classifiers
            ),
        ],
        "operators": [operator_json(learned) for learned in library.operators],
        "skills": {
            name: {
                "phases": [
                    {"frame": p.frame, "close_gripper": p.close_gripper, "duration_s": round(p.duration_s, 3)}
                    for p in skill.phases
                ],
                "close_gripper_at_end": skill.close_gripper_at_end,
            }
            for name, skill in library.skills.items()
        },
        "goals": {
            g.task: {"parameters": {p.name: p.type for p in g.parameters}, "atoms": _texts(g.atoms)} for g in library.goals
        },
    }


def operator_json(learned: LearnedOperator) -> dict[str, Any]:
    """One operator, for programs."""
    op = learned.operator
    return {
        "name": op.name,
        "kind": learned.kind,
        "parameters": {p.name: p.type for p in op.parameters},
        "pre": _texts(op.pre),
        "absent": [absent_text(a) for a in sorted(op.absent)],
        "add": _texts(op.add),
        "delete": _texts(op.delete),
        "maintain": _texts(op.maintain),
        "protected": _texts(op.protected),
        "strict_pre": _texts(learned.strict_pre),
        "cost": op.cost,
        "skill": learned.skill,
        "support": learned.support,
        "demonstrations": [e.demo for e in learned.evidence],
        "duration_s": {"mean": round(learned.duration_s[0], 3), "max": round(learned.duration_s[1], 3)},
        "notes": list(learned.notes),
        "experience": {"tries": learned.experience.tries, "successes": learned.experience.successes},
    }


def _texts(atoms: frozenset[Atom]) -> list[str]:
    return [str(a) for a in sorted(atoms)]
