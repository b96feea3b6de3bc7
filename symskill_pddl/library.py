"""`Library`: all that learning produces, and nothing else. Saved as `library.json` + `skills/*.npz`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from symskill_pddl.abstraction import Classifier, GripperRule
from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.skills import Skill
from symskill_pddl.symbols import GRIPPER_OPEN, Atom, Domain, Operator, Parameter, Predicate, Type


@dataclass(frozen=True)
class Evidence:
    """One episode that an operator was learned from."""

    demo: str
    """Identifier of the demonstration, ``file:demo_0``."""
    start_s: float
    stop_s: float
    binding: tuple[tuple[str, str], ...]
    """(parameter, object) pairs."""


@dataclass(frozen=True)
class LearnedOperator:
    """An operator with where it came from and the skill that brings it about.

    `operator` carries the refined preconditions; `strict_pre` the plain intersection of the paper. `skill` names an entry of the
    library's `skills`, whose phases name their frames by the operator's parameters.
    """

    operator: Operator
    strict_pre: frozenset[Atom]
    skill: str
    kind: str
    """'pick', 'place', 'reach' or 'move' (the last two for what is hinged or slides)."""
    evidence: tuple[Evidence, ...]
    duration_s: tuple[float, float]
    """Mean and maximum duration in the demonstrations."""
    notes: tuple[str, ...] = ()
    """What was dropped from or added to the preconditions, and why, a line each."""

    @property
    def support(self) -> int:
        return len(self.evidence)


@dataclass(frozen=True)
class Goal:
    """What the demonstrations of a task ended with: lifted atoms."""

    task: str
    parameters: tuple[Parameter, ...]
    atoms: frozenset[Atom]


@dataclass(frozen=True, eq=False)
class Library:
    """Types, predicates with geometry, operators, skills, and the goals of the demonstrated tasks."""

    types: tuple[Type, ...]
    classifiers: tuple[Classifier, ...]
    operators: tuple[LearnedOperator, ...]
    skills: Mapping[str, Skill]
    goals: tuple[Goal, ...] = ()
    gripper: GripperRule = field(default_factory=GripperRule)
    extents: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    """Half sizes [m] of each type's bounding box where the recordings state them (obstacles)."""

    def domain(self, name: str = "learned") -> Domain:
        """What a planner sees: every type, predicate (`gripper-open`, the built-in one, first) and operator."""
        predicates = (Predicate(GRIPPER_OPEN), *(c.predicate for c in self.classifiers))
        return Domain(name, self.types, predicates, tuple(learned.operator for learned in self.operators))

    def learned(self, name: str) -> LearnedOperator:
        """The learned operator of that name."""
        for learned in self.operators:
            if learned.operator.name == name:
                return learned
        known = alternatives(o.operator.name for o in self.operators)
        raise InputError(f"unknown operator '{name}'; the library has: {known}")
