"""`Library`: all that learning produces, and nothing else. Saved as `library.json` + `skills/*.npz`."""

from __future__ import annotations

import hashlib
import io
import json
import re
import zipfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, ValidationError

from symskill_pddl.abstraction import Classifier, GripperRule
from symskill_pddl.errors import FormatError, InputError, SymSkillError, alternatives
from symskill_pddl.files import write_atomic
from symskill_pddl.geometry import Pose
from symskill_pddl.skills import Skill
from symskill_pddl.symbols import GRIPPER_OPEN, Absent, Atom, Domain, Operator, Parameter, Predicate, Type

INDEX, SKILLS = "library.json", "skills"
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

    def save(self, path: str | Path) -> None:
        """Write the folder `path`: `library.json` and `skills/*.npz`; same library, same bytes.

        The arrays carry their checksum in their name and `library.json` is replaced last, so a crash leaves the old library or
        the new one.

        Raises
        ------
        InputError
            If the folder cannot be written.
        """
        folder = Path(path)
        try:
            (folder / SKILLS).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"cannot make the folder '{folder / SKILLS}': {error.strerror or error}") from error
        files = {}
        for name, skill in sorted(self.skills.items()):
            content = _npz(skill.arrays())
            sha = hashlib.sha256(content).hexdigest()
            files[name] = _SkillFile(file=f"{name}.{sha[:12]}.npz", sha256=sha)
            write_atomic(folder / SKILLS / files[name].file, content)
        document = _Document.model_validate(_as_json(self) | {"skills": {n: f.model_dump() for n, f in files.items()}})
        write_atomic(folder / INDEX, (json.dumps(document.model_dump(), indent=1) + "\n").encode())
        for stale in sorted({p.name for p in (folder / SKILLS).glob("*.npz")} - {f.file for f in files.values()}):
            (folder / SKILLS / stale).unlink(missing_ok=True)

    @classmethod
    def load(cls, path: str | Path) -> Library:
        """Read what `save` wrote.

        Raises
        ------
        FormatError
            If a file is missing, damaged, of another version, or does not belong to the others; the message names it.
        """
        folder = Path(path)
        index = folder / INDEX
        document = _read_document(index)
        skills = {name: _read_skill(folder / SKILLS / entry.file, entry.sha256) for name, entry in document.skills.items()}
        try:
            library = _from_json(document, skills)
            domain = library.domain()
            for learned in library.operators:
                _check_operator(learned, domain, skills)
        except (SymSkillError, ValueError, np.linalg.LinAlgError) as error:
            raise FormatError(f"'{index}' holds what does not fit together: {error}") from None
        return library

    def learned(self, name: str) -> LearnedOperator:
        """The learned operator of that name."""
        for learned in self.operators:
            if learned.operator.name == name:
                return learned
        known = alternatives(o.operator.name for o in self.operators)
        raise InputError(f"unknown operator '{name}'; the library has: {known}")


# --- the file: what `library.json` holds, as pydantic checks it on the way in and out

_Atom = tuple[str, tuple[str, ...]]
_Pair = tuple[str, str]
_Vector = tuple[float, float, float]
_Matrix = tuple[_Vector, _Vector, _Vector]


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class _SkillFile(_Model):
    file: str
    sha256: str


class _Predicate(_Model):
    name: str
    types: tuple[str, ...]
    child: str
    parent: str
    position_m: _Vector
    orientation_wxyz: tuple[float, float, float, float]
    cov_position: _Matrix
    cov_rotation: _Matrix
    enter_position: float
    enter_rotation: float
    leave_factor: float
    free_axis: _Vector | None


class _Evidence(_Model):
    demo: str
    start_s: float
    stop_s: float
    binding: tuple[_Pair, ...]


class _Absent(_Model):
    atom: _Atom
    over: tuple[_Pair, ...]


class _Operator(_Model):
    name: str
    parameters: tuple[_Pair, ...]
    pre: tuple[_Atom, ...]
    absent: tuple[_Absent, ...]
    add: tuple[_Atom, ...]
    delete: tuple[_Atom, ...]
    maintain: tuple[_Atom, ...]
    strict_pre: tuple[_Atom, ...]
    cost: float
    kind: str
    skill: str
    duration_s: tuple[float, float]
    evidence: tuple[_Evidence, ...]
    notes: tuple[str, ...]


class _Goal(_Model):
    task: str
    parameters: tuple[_Pair, ...]
    atoms: tuple[_Atom, ...]


class _Document(_Model):
    format: Literal["symskill-library"]
    schema_version: Literal[1]
    types: tuple[_Pair, ...]
    predicates: tuple[_Predicate, ...]
    operators: tuple[_Operator, ...]
    goals: tuple[_Goal, ...]
    gripper_open_m: tuple[float, float]
    extents_m: dict[str, _Vector]
    skills: dict[str, _SkillFile]


def _atoms(atoms: Iterable[Atom]) -> list[_Atom]:
    return [(a.predicate, a.args) for a in sorted(atoms)]


def _state(atoms: Iterable[_Atom]) -> frozenset[Atom]:
    return frozenset(Atom(predicate, args) for predicate, args in atoms)


def _parameters(pairs: Iterable[_Pair]) -> tuple[Parameter, ...]:
    return tuple(Parameter(name, type_) for name, type_ in pairs)


def _pairs(parameters: Iterable[Parameter]) -> list[_Pair]:
    return [(p.name, p.type) for p in parameters]


def _as_json(library: Library) -> dict[str, Any]:
    return {
        "format": "symskill-library",
        "schema_version": SCHEMA_VERSION,
        "types": [(t.name, t.parent) for t in library.types],
        "predicates": [
            {
                "name": c.predicate.name,
                "types": c.predicate.types,
                "child": c.child,
                "parent": c.parent,
                "position_m": c.T_mean.p.tolist(),
                "orientation_wxyz": c.T_mean.q.tolist(),
                "cov_position": c.cov_p.tolist(),
                "cov_rotation": c.cov_r.tolist(),
                "enter_position": c.enter_p,
                "enter_rotation": c.enter_r,
                "leave_factor": c.leave_factor,
                "free_axis": None if c.free_axis is None else c.free_axis.tolist(),
            }
            for c in library.classifiers
        ],
        "operators": [_operator_json(learned) for learned in library.operators],
        "goals": [{"task": g.task, "parameters": _pairs(g.parameters), "atoms": _atoms(g.atoms)} for g in library.goals],
        "gripper_open_m": (library.gripper.open_above, library.gripper.open_until),
        "extents_m": {t: library.extents[t] for t in sorted(library.extents)},
    }


def _operator_json(learned: LearnedOperator) -> dict[str, Any]:
    op = learned.operator
    return {
        "name": op.name,
        "parameters": _pairs(op.parameters),
        "pre": _atoms(op.pre),
        "absent": [{"atom": (a.atom.predicate, a.atom.args), "over": _pairs(a.over)} for a in sorted(op.absent)],
        "add": _atoms(op.add),
        "delete": _atoms(op.delete),
        "maintain": _atoms(op.maintain),
        "strict_pre": _atoms(learned.strict_pre),
        "cost": op.cost,
        "kind": learned.kind,
        "skill": learned.skill,
        "duration_s": learned.duration_s,
        "evidence": [{"demo": e.demo, "start_s": e.start_s, "stop_s": e.stop_s, "binding": e.binding} for e in learned.evidence],
        "notes": learned.notes,
    }


def _from_json(d: _Document, skills: Mapping[str, Skill]) -> Library:
    classifiers = tuple(
        Classifier(
            Predicate(p.name, p.types),
            p.child,
            p.parent,
            Pose(np.array(p.position_m), np.array(p.orientation_wxyz)),
            np.array(p.cov_position),
            np.array(p.cov_rotation),
            p.enter_position,
            p.enter_rotation,
            p.leave_factor,
            None if p.free_axis is None else np.array(p.free_axis),
        )
        for p in d.predicates
    )
    operators = tuple(
        LearnedOperator(
            Operator(
                name=o.name,
                parameters=_parameters(o.parameters),
                pre=_state(o.pre),
                add=_state(o.add),
                delete=_state(o.delete),
                maintain=_state(o.maintain),
                absent=frozenset(Absent(Atom(*a.atom), _parameters(a.over)) for a in o.absent),
                cost=o.cost,
            ),
            _state(o.strict_pre),
            o.skill,
            o.kind,
            tuple(Evidence(e.demo, e.start_s, e.stop_s, e.binding) for e in o.evidence),
            o.duration_s,
            o.notes,
        )
        for o in d.operators
    )
    goals = tuple(Goal(g.task, _parameters(g.parameters), _state(g.atoms)) for g in d.goals)
    types = tuple(Type(name, parent) for name, parent in d.types)
    return Library(types, classifiers, operators, dict(skills), goals, GripperRule(*d.gripper_open_m), dict(d.extents_m))


def _check_operator(learned: LearnedOperator, domain: Domain, skills: Mapping[str, Skill]) -> None:
    """Every predicate, type, skill and frame that an operator names has to exist."""
    op = learned.operator
    for atom in sorted(op.pre | op.add | op.delete | op.maintain | learned.strict_pre | {a.atom for a in op.absent}):
        if len(domain.predicate(atom.predicate).types) != len(atom.args):
            raise InputError(f"operator '{op.name}' gives {atom} a wrong number of arguments")
    for parameter in op.parameters:
        if parameter.type not in {t.name for t in domain.types}:
            raise InputError(f"operator '{op.name}' has the unknown type '{parameter.type}'")
    if learned.skill not in skills:
        raise InputError(f"operator '{op.name}' has the unknown skill '{learned.skill}'; there are: {alternatives(skills)}")
    for phase in skills[learned.skill].phases:
        if phase.frame not in {p.name for p in op.parameters}:
            raise InputError(f"the skill '{learned.skill}' lives in the frame of {phase.frame}, which '{op.name}' does not have")


def _read_document(index: Path) -> _Document:
    try:
        raw = index.read_bytes()
    except OSError as error:
        raise FormatError(
            f"cannot read '{index}': {error.strerror or error}; a library is a folder with {INDEX} and {SKILLS}/"
        ) from None
    try:
        return _Document.model_validate_json(raw)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "the document"
        raise FormatError(f"'{index}' is not a library of schema version {SCHEMA_VERSION}: {where}: {first['msg']}") from None


def _read_skill(path: Path, sha256: str) -> Skill:
    if not re.fullmatch(r"[\w.-]+\.npz", path.name):
        raise FormatError(f"'{path}' is no file name of a skill")
    try:
        content = path.read_bytes()
    except OSError as error:
        raise FormatError(f"cannot read '{path}', which {INDEX} names: {error.strerror or error}") from None
    if hashlib.sha256(content).hexdigest() != sha256:
        raise FormatError(f"'{path}' is damaged or belongs to another library: its checksum differs from the one in {INDEX}")
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
            return Skill.from_arrays({name: arrays[name] for name in arrays.files})
    except (FormatError, ValueError, OSError, zipfile.BadZipFile) as error:
        raise FormatError(f"'{path}': {error}") from None


def _npz(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """As `numpy.savez`, with sorted names and no time stamps: the same arrays give the same bytes."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name in sorted(arrays):
            member = io.BytesIO()
            np.save(member, np.asanyarray(arrays[name]), allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(f"{name}.npy", (1980, 1, 1, 0, 0, 0)), member.getvalue())
    return buffer.getvalue()
