"""`Library`: all that learning produces, and nothing else. A folder of JSON, arrays and demonstrations (`library_io`)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from symskill_pddl.abstraction import Classifier, GripperRule
from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.skills import Skill
from symskill_pddl.symbols import GRIPPER_OPEN, Atom, Domain, Operator, Parameter, Predicate, Problem, Type

if TYPE_CHECKING:
    from symskill_pddl.planning.unified import Unified

INDEX, SKILLS, DEMOS = "library.json", "skills", "demos"
SCHEMA_VERSION = 1


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
class Experience:
    """What came of carrying out an operator."""

    tries: int = 0
    successes: int = 0
    seconds: float = 0.0
    """Duration of all successes together [s]."""

    def __add__(self, other: Experience) -> Experience:
        seconds = round(self.seconds + other.seconds, 6)
        return Experience(self.tries + other.tries, self.successes + other.successes, seconds)

    @property
    def success(self) -> float:
        """How likely a try is to work, by Laplace's rule of succession."""
        return (self.successes + 1) / (self.tries + 2)


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
    experience: Experience = Experience()

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
    margins: Mapping[str, float] = field(default_factory=dict)
    """By predicate: by how much its reference scored higher than the next candidate; none where there was no other."""
    recordings: Mapping[str, bytes] = field(default_factory=dict, repr=False)
    """The demonstrations it was learned from, by source: the content of a file of demonstrations."""
    runs: tuple[str, ...] = ()
    """Checksums of the recorded runs that its operators' experience comes from."""
    hints: Mapping[str, Any] = field(default_factory=dict)
    """What a person said when it was learned (`learning.hints`): tables of texts."""

    @property
    def max_period_s(self) -> float:
        """Control periods below this [s] are certified for all skills; infinite without skills."""
        return min((skill.max_period_s for skill in self.skills.values()), default=float("inf"))

    def domain(self, name: str = "learned", *, strict: bool = False) -> Domain:
        """What a planner sees: every type, predicate (`gripper-open`, the built-in one, first) and operator.

        `strict` takes the paper's preconditions, the plain intersections, for the refined ones.
        """
        predicates = (Predicate(GRIPPER_OPEN), *(c.predicate for c in self.classifiers))
        operators = (self._strict(learned) if strict else learned.operator for learned in self.operators)
        return Domain(name, self.types, predicates, tuple(operators))

    def _strict(self, learned: LearnedOperator) -> Operator:
        types = {c.predicate.name: c.predicate.types for c in self.classifiers}
        parameters = {p.name: p for p in learned.operator.parameters}
        for atom in sorted(learned.strict_pre):
            for variable, type_ in zip(atom.args, types.get(atom.predicate, ()), strict=True):
                parameters.setdefault(variable, Parameter(variable, type_))
        return replace(learned.operator, parameters=tuple(parameters.values()), pre=learned.strict_pre, absent=frozenset())

    def to_unified_planning(self, problem: Problem | None = None, *, dialect: str = "negative", name: str = "learned") -> Unified:
        """The domain, with a problem of it, as an object of unified-planning, and the names that lead back.

        Parameters and errors as of `planning.to_unified_planning`, to which this is the one way up from this room.
        """
        from symskill_pddl.planning.unified import to_unified_planning

        return to_unified_planning(self.domain(name), problem, dialect=dialect)

    def save(self, path: str | Path, *, replace: bool = True) -> None:
        """Write the folder `path`: `library.json`, `skills/*.npz`, `demos/*.hdf5`; same library, same bytes.

        Arrays and demonstrations carry their checksum in their name and `library.json` is replaced last, so a crash leaves the
        old library or the new one, and who reads at the same time gets one of the two. Files of somebody else stay there.

        Parameters
        ----------
        replace : bool
            Whether another library that is there may be replaced.

        Raises
        ------
        InputError
            The folder is neither new, nor empty, nor a library, or is a link; there is another library and `replace` is false;
            another program is writing it; or it cannot be written.
        """
        from symskill_pddl.library_io import save

        save(self, Path(path), replace=replace)

    @classmethod
    def load(cls, path: str | Path) -> Library:
        """Read what `save` wrote.

        Raises
        ------
        FormatError
            If a file is missing, damaged, of another version, or does not belong to the others; the message names it.
        """
        from symskill_pddl.library_io import load

        return load(Path(path))

    def learned(self, name: str) -> LearnedOperator:
        """The learned operator of that name."""
        for learned in self.operators:
            if learned.operator.name == name:
                return learned
        known = alternatives(o.operator.name for o in self.operators)
        raise InputError(f"unknown operator '{name}'; the library has: {known}")
