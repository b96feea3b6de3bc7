"""A library as a folder: what `library.json` holds, as pydantic checks it on the way in and out, and the files that it names."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from symskill_pddl.abstraction import Classifier, GripperRule
from symskill_pddl.arrays import read_npz, write_npz
from symskill_pddl.errors import FormatError, InputError, SymSkillError, alternatives
from symskill_pddl.files import Shape, Writer
from symskill_pddl.files import writing as writing_folder
from symskill_pddl.geometry import Pose
from symskill_pddl.library import DEMOS, INDEX, SCHEMA_VERSION, SKILLS, Evidence, Experience, Goal, LearnedOperator, Library
from symskill_pddl.reading import read_bytes, validated
from symskill_pddl.skills import Skill
from symskill_pddl.symbols import Absent, Atom, Domain, Operator, Parameter, Predicate, Type

FORMAT = "symskill-library"
FILE_NAME = re.compile(r"[\w.-]+\.(npz|hdf5)")
"""What a file in `SKILLS` or `DEMOS` may be called."""
LARGEST = 2_000_000_000
"""Bytes of one of them; it is in memory as it is on the disk."""


def save(library: Library, folder: Path, *, replace: bool = True) -> None:
    """Write a library; see `Library.save`."""
    with writing(folder, replace=replace) as write:
        write(library)


@contextmanager
def writing(folder: Path, *, replace: bool = True) -> Iterator[Callable[[Library], None]]:
    """Become the only one who writes a library into a folder; the value saves one. For who reads the old one to make the new.

    Raises
    ------
    InputError
        As `Library.save`.
    """
    with writing_folder(folder, SHAPE, replace=replace) as writer:
        yield partial(_save, writer)


def _save(writer: Writer, library: Library) -> None:
    skills = {name: write_npz(skill.arrays()) for name, skill in sorted(library.skills.items())}
    recordings = dict(sorted(library.recordings.items()))
    named = {n: _File(file=f"{n}.{_sha(c)[:12]}.npz", sha256=_sha(c)) for n, c in skills.items()}
    # a source is any file's stem, not always a name that a folder may hold
    copies = {n: _File(file=f"{_sha(c)[:16]}.hdf5", sha256=_sha(c)) for n, c in recordings.items()}
    listed = {
        "skills": {n: f.model_dump() for n, f in named.items()},
        "recordings": {n: f.model_dump() for n, f in copies.items()},
    }
    document = _Document.model_validate(_as_json(library) | listed)
    files = {f"{SKILLS}/{f.file}": skills[n] for n, f in named.items()}
    files |= {f"{DEMOS}/{f.file}": recordings[n] for n, f in copies.items()}
    writer.save(files, (json.dumps(document.model_dump(), indent=1) + "\n").encode())


def _listed(index: bytes) -> frozenset[str] | None:
    """The files that an index names, also one of another version; none if the text is no index of a library."""
    try:
        document = json.loads(index)
        if document["format"] != FORMAT:
            return None
    except (ValueError, KeyError, TypeError, RecursionError):
        return None
    found = set()
    for key, sub in (("skills", SKILLS), ("recordings", DEMOS)):
        entries = document.get(key)
        for entry in entries.values() if isinstance(entries, dict) else ():
            name = entry.get("file") if isinstance(entry, dict) else None
            if isinstance(name, str) and FILE_NAME.fullmatch(name):
                found.add(f"{sub}/{name}")
    return frozenset(found)


SHAPE = Shape("library", INDEX, (SKILLS, DEMOS), _listed)


def load(folder: Path) -> Library:
    """Read a library; see `Library.load`."""
    index = folder / INDEX
    raw = _read_index(index)
    while True:
        try:
            return _load(folder, raw)
        except FormatError:
            # somebody replaced it while it was read: the new one is whole
            again = _read_index(index)
            if again == raw:
                raise
            raw = again


def _load(folder: Path, raw: bytes) -> Library:
    index = folder / INDEX
    document = _read_document(index, raw)
    skills = {name: _read_skill(folder / SKILLS, entry) for name, entry in document.skills.items()}
    recordings = {name: _read_file(folder / DEMOS, entry) for name, entry in document.recordings.items()}
    try:
        library = _from_json(document, skills, recordings)
        domain = library.domain()
        for learned in library.operators:
            _check_operator(learned, domain, skills)
    except (SymSkillError, ValueError, np.linalg.LinAlgError) as error:
        raise FormatError(f"'{index}' holds what does not fit together: {error}") from None
    return library


def _sha(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


_Atom = tuple[str, tuple[str, ...]]
_Pair = tuple[str, str]
_Vector = tuple[float, float, float]
_Matrix = tuple[_Vector, _Vector, _Vector]


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class _File(_Model):
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
    fingers_m: tuple[float, float] | None = None
    precedence: float = 0.0


class _Evidence(_Model):
    demo: str
    start_s: float
    stop_s: float
    binding: tuple[_Pair, ...]


class _Absent(_Model):
    atom: _Atom
    over: tuple[_Pair, ...]
    at_most_one: bool = False


class _Experience(_Model):
    tries: int = Field(default=0, ge=0)
    successes: int = Field(default=0, ge=0)
    seconds: float = Field(default=0.0, ge=0.0)


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
    experience: _Experience = _Experience()


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
    skills: dict[str, _File]
    margins: dict[str, float] = {}
    recordings: dict[str, _File] = {}
    runs: tuple[str, ...] = ()
    hints: dict[str, Any] = {}


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
        "format": FORMAT,
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
                "fingers_m": c.fingers,
                "precedence": c.precedence,
            }
            for c in library.classifiers
        ],
        "operators": [_operator_json(learned) for learned in library.operators],
        "goals": [{"task": g.task, "parameters": _pairs(g.parameters), "atoms": _atoms(g.atoms)} for g in library.goals],
        "gripper_open_m": (library.gripper.open_above, library.gripper.open_until),
        "extents_m": {t: library.extents[t] for t in sorted(library.extents)},
        "margins": {p: library.margins[p] for p in sorted(library.margins)},
        "runs": library.runs,
        "hints": dict(library.hints),
    }


def _operator_json(learned: LearnedOperator) -> dict[str, Any]:
    op = learned.operator
    return {
        "name": op.name,
        "parameters": _pairs(op.parameters),
        "pre": _atoms(op.pre),
        "absent": [
            {"atom": (a.atom.predicate, a.atom.args), "over": _pairs(a.over), "at_most_one": a.at_most_one}
            for a in sorted(op.absent)
        ],
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
        "experience": asdict(learned.experience),
    }


def _from_json(d: _Document, skills: Mapping[str, Skill], recordings: Mapping[str, bytes]) -> Library:
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
            p.fingers_m,
            p.precedence,
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
                absent=frozenset(Absent(Atom(*a.atom), _parameters(a.over), a.at_most_one) for a in o.absent),
                cost=o.cost,
            ),
            _state(o.strict_pre),
            o.skill,
            o.kind,
            tuple(Evidence(e.demo, e.start_s, e.stop_s, e.binding) for e in o.evidence),
            o.duration_s,
            o.notes,
            Experience(**o.experience.model_dump()),
        )
        for o in d.operators
    )
    goals = tuple(Goal(g.task, _parameters(g.parameters), _state(g.atoms)) for g in d.goals)
    types = tuple(Type(name, parent) for name, parent in d.types)
    return Library(
        types=types,
        classifiers=classifiers,
        operators=operators,
        skills=dict(skills),
        goals=goals,
        gripper=GripperRule(*d.gripper_open_m),
        extents=dict(d.extents_m),
        margins=dict(d.margins),
        recordings=dict(recordings),
        runs=d.runs,
        hints=d.hints,
    )


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


def _read_index(index: Path) -> bytes:
    try:
        return read_bytes(index, "library")
    except InputError as error:
        raise FormatError(f"{error}; a library is a folder with {INDEX} and {SKILLS}/") from None


def _read_document(index: Path, raw: bytes) -> _Document:
    return validated(_Document.model_validate, raw, f"'{index}' is not a library of schema version {SCHEMA_VERSION}")


def _read_file(folder: Path, entry: _File) -> bytes:
    path = folder / entry.file
    if not FILE_NAME.fullmatch(entry.file):
        raise FormatError(f"'{path}' is no file name of a library")
    try:
        content = read_bytes(path, f"file that {INDEX} names", limit=LARGEST)
    except InputError as error:
        raise FormatError(str(error)) from None
    if _sha(content) != entry.sha256:
        raise FormatError(f"'{path}' is damaged or belongs to another library: its checksum differs from the one in {INDEX}")
    return content


def _read_skill(folder: Path, entry: _File) -> Skill:
    where = f"'{folder / entry.file}'"
    arrays = read_npz(_read_file(folder, entry), where)
    try:
        return Skill.from_arrays(arrays)
    except FormatError as error:
        raise FormatError(f"{where}: {error}") from None
