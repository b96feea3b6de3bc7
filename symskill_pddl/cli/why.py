"""Where an operator or a predicate comes from, and why it is as it is: for people and for programs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from symskill_pddl.abstraction import Classifier
from symskill_pddl.cli.views import operator_json
from symskill_pddl.describe import (
    absent_text,
    atoms_text,
    experience_lines,
    geometry_lines,
    gripper_text,
    skill_lines,
    support_text,
)
from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.library import Evidence, LearnedOperator, Library
from symskill_pddl.scene import GRIPPER
from symskill_pddl.symbols import GRIPPER_OPEN

CLOSE_CALL = 0.1
"""Scores of references run to about 2.5; a smaller lead than this could have gone the other way."""


@dataclass(frozen=True)
class Reasons:
    """The same, as lines and as a JSON document."""

    lines: tuple[str, ...]
    document: dict[str, Any]


def why(library: Library, name: str) -> Reasons:
    """The reasons behind an operator or a predicate.

    Raises
    ------
    InputError
        If the library has neither of that name; the message lists what it has.
    """
    for learned in library.operators:
        if learned.operator.name == name:
            return Reasons(tuple(_operator(library, learned)), _operator_document(library, learned))
    for classifier in library.classifiers:
        if classifier.predicate.name == name:
            return Reasons(tuple(_predicate(library, classifier)), _predicate_document(library, classifier))
    if name == GRIPPER_OPEN:
        text = gripper_text(library.gripper)
        return Reasons((f"({GRIPPER_OPEN}), a predicate", f"  {text}"), {"predicate": name, "learned": False, "meaning": [text]})
    operators, predicates = (o.operator.name for o in library.operators), (c.predicate.name for c in library.classifiers)
    raise InputError(
        f"'{name}' is neither an operator nor a predicate of the library; it has the operators {alternatives(operators)} "
        f"and the predicates {alternatives([GRIPPER_OPEN, *predicates])}"
    )


def _operator(library: Library, learned: LearnedOperator) -> Iterator[str]:
    op = learned.operator
    yield f"{op.name} ({' '.join(f'{p.name} - {p.type}' for p in op.parameters)}), an operator"
    yield f"  {support_text(learned)}"
    yield from (f"  {line}" for line in experience_lines(learned))
    yield "seen in"
    yield from (f"  {_evidence(e)}" for e in learned.evidence)
    yield "needs"
    yield from (f"  {atom}" for atom in sorted(op.pre))
    yield from (f"  {absent_text(condition)}" for condition in sorted(op.absent))
    yield "does"
    yield from (f"  adds {atom}" for atom in sorted(op.add))
    yield from (f"  ends {atom}" for atom in sorted(op.delete))
    yield "why so"
    yield from (f"  {note}" for note in learned.notes or ("all of it is what its demonstrations have in common",))
    if only := learned.strict_pre - op.pre:
        yield f"  true at the beginning of every demonstration, but not needed: {atoms_text(only)}"
    used = sorted({a.predicate for a in op.pre | op.add | op.delete})
    if margins := [line for name in used if (line := _margin(library, name, long=True))]:
        yield "references"
        yield from (f"  {line}" for line in margins)
    yield f"skill {learned.skill}"
    yield from (f"  {line}" for line in skill_lines(library.skills[learned.skill]))


def _predicate(library: Library, classifier: Classifier) -> Iterator[str]:
    name = classifier.predicate.name
    yield f"({' '.join((name, *classifier.predicate.types))}), a predicate"
    yield from (f"  {line}" for line in geometry_lines(classifier))
    if classifier.parent != GRIPPER and (margin := _margin(library, name)):
        yield f"  {margin}"
    for title, uses in _uses(library, name).items():
        if uses:
            yield title
        for learned in uses:
            yield f"  {learned.operator.name}"
            if title != "needed by":
                yield from (f"    {_evidence(e)}" for e in learned.evidence)


def _uses(library: Library, name: str) -> dict[str, list[LearnedOperator]]:
    """Operators by what the predicate is to them."""

    def those(field: str) -> list[LearnedOperator]:
        return [o for o in library.operators if name in {a.predicate for a in getattr(o.operator, field)}]

    absent = [o for o in library.operators if name in {c.atom.predicate for c in o.operator.absent}]
    needed = [o for o in library.operators if o in those("pre") or o in absent]
    return {"brought about by": those("add"), "ended by": those("delete"), "needed by": needed}


def _margin(library: Library, name: str, *, long: bool = False) -> str | None:
    classifier = next((c for c in library.classifiers if c.predicate.name == name), None)
    if classifier is None or classifier.child == GRIPPER:
        return None
    subject = f"{name}: the {classifier.parent}" if long else f"reference: the {classifier.parent}"
    if name not in library.margins:
        return f"{subject}, the only candidate or chosen without a recorded margin"
    margin = library.margins[name]
    return f"{subject}, whose score leads the next candidate's by {margin:.2f}{' (a close call)' if margin < CLOSE_CALL else ''}"


def _evidence(e: Evidence) -> str:
    bound = ", ".join(f"{variable} = {obj}" for variable, obj in e.binding)
    return f"{e.demo} from {e.start_s:.2f} s to {e.stop_s:.2f} s: {bound}"


def _operator_document(library: Library, learned: LearnedOperator) -> dict[str, Any]:
    used = {a.predicate for a in learned.operator.pre | learned.operator.add | learned.operator.delete}
    return {
        "operator": learned.operator.name,
        **operator_json(learned),
        "evidence": _evidence_documents(learned),
        "reference_margins": {p: m for p, m in library.margins.items() if p in used},
        "skill_phases": list(skill_lines(library.skills[learned.skill])),
    }


def _predicate_document(library: Library, classifier: Classifier) -> dict[str, Any]:
    name = classifier.predicate.name
    return {
        "predicate": name,
        "types": list(classifier.predicate.types),
        "learned": True,
        "meaning": list(geometry_lines(classifier)),
        "reference_margin": library.margins.get(name),
        **{title.replace(" ", "_"): [o.operator.name for o in uses] for title, uses in _uses(library, name).items()},
        "evidence": {
            title.replace(" ", "_"): [e for o in uses for e in _evidence_documents(o)]
            for title, uses in _uses(library, name).items()
            if title != "needed by"
        },
    }


def _evidence_documents(learned: LearnedOperator) -> list[dict[str, Any]]:
    return [{"demo": e.demo, "start_s": e.start_s, "stop_s": e.stop_s, "binding": dict(e.binding)} for e in learned.evidence]
