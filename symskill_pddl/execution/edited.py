"""A library whose operators are those of a domain that a person edited: the executor plans and watches with what it says."""

from __future__ import annotations

from dataclasses import replace

from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.library import LearnedOperator, Library
from symskill_pddl.pddl.edit import Edited
from symskill_pddl.symbols import GRIPPER_OPEN


def edited_library(library: Library, edited: Edited) -> Library:
    """The library under an edited domain: its types, conditions, costs and actions; the library's skills and classifiers.

    Operators, predicates and goals that the edit removed are left out.

    Raises
    ------
    InputError
        An action needs a predicate that the library has no classifier for, so no robot could see whether it holds.
    """
    domain = edited.domain
    seen = {GRIPPER_OPEN, *(c.predicate.name for c in library.classifiers)}
    operators: list[LearnedOperator] = []
    for op in domain.operators:
        for predicate in sorted({a.predicate for a in op.pre} | {a.atom.predicate for a in op.absent}):
            if predicate not in seen:
                raise InputError(
                    f"action '{op.name}' needs '{predicate}', which the library has no classifier for, so it cannot be seen; "
                    f"what can be seen: {alternatives(seen)}"
                )
        operators.append(replace(library.learned(edited.operators[op.name]), operator=op))
    kept = {p.name for p in domain.predicates}
    return replace(
        library,
        types=domain.types,
        classifiers=tuple(c for c in library.classifiers if c.predicate.name in kept),
        operators=tuple(operators),
        goals=tuple(g for g in library.goals if {a.predicate for a in g.atoms} <= kept | {GRIPPER_OPEN}),
    )
