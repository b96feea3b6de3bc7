"""Reversible names: stable identifiers of the library on one side, what stands in the PDDL text on the other.

PDDL ignores case and several parsers refuse a digit at the start, a keyword, or an object that is named like a type, predicate or
action. So every exported name is lower case, starts with a letter, is no keyword, and stands for one thing only. The mapping goes
to a side-car file `names.json`, and an edited domain, a problem or a plan comes back to the identifiers through it.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from functools import cached_property, lru_cache
from itertools import count
from pathlib import Path
from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from symskill_pddl.errors import FormatError, InputError, alternatives
from symskill_pddl.reading import read_text, validated
from symskill_pddl.symbols import ROOT_TYPE, Absent, Atom, Domain, Operator, Parameter, Plan, Predicate, Problem, Type

RESERVED = frozenset(
    {
        "object",
        "either",
        "and",
        "or",
        "not",
        "imply",
        "forall",
        "exists",
        "when",
        "define",
        "domain",
        "problem",
        "requirements",
        "types",
        "constants",
        "predicates",
        "functions",
        "action",
        "durative-action",
        "derived",
        "parameters",
        "precondition",
        "condition",
        "effect",
        "duration",
        "objects",
        "init",
        "goal",
        "metric",
        "at",
        "over",
        "all",
        "start",
        "end",
        "increase",
        "decrease",
        "assign",
        "scale-up",
        "scale-down",
        "minimize",
        "maximize",
        "total-cost",
        "total-time",
        "number",
        "always",
        "sometime",
        "within",
        "at-most-once",
        "sometime-after",
        "sometime-before",
        "always-within",
        "hold-during",
        "hold-after",
        "preference",
        "is-violated",
        "length",
        "constraints",
        "undefined",
        "true",
        "false",
    }
)
_NAME = re.compile(r"[a-z][a-z0-9_-]*")
_LEGAL = re.compile(r"[a-z][a-z0-9]*(?:[-_][a-z0-9]+)*")
"""What `legal` leaves as it is, keywords apart."""
_VARIABLE = re.compile(r"\?[^\s()?]+")
_KINDS = ("types", "predicates", "operators", "objects")


_LOGIC = frozenset({"and", "or", "not", "imply", "forall", "exists", "when", "either", "define", "object"})
"""What a name can never be, for PDDL means something else there. Other words of PDDL, like `at`, are names for the standard."""


def check_name(name: str, what: str, reserved: Collection[str] = RESERVED) -> None:
    """Raise `InputError` where a name is not a lower-case PDDL name or is a reserved word."""
    if not _NAME.fullmatch(name):
        raise InputError(
            f"{what} '{name}' is not a PDDL name: lower-case letters, digits, '-' and '_', a letter first; like '{legal(name)}'"
        )
    if name in reserved:
        raise InputError(f"{what} '{name}' is a word of PDDL itself; take another, like '{legal(name)}'")


@lru_cache(maxsize=16)
def check_domain_names(domain: Domain) -> None:
    """Raise `InputError` at a name that is none for the standard, or that stands for two things of one kind.

    What several planners refuse though it is right (`at`, a predicate named like an action) is written as it is; the names that
    `Names.of` chooses are free of it.
    """
    _check_unique(_declared(domain))
    check_name(domain.name, "domain", _LOGIC)
    for op in domain.operators:
        for parameter in (*op.parameters, *(p for a in sorted(op.absent) for p in a.over)):
            check_name(parameter.name[1:], f"operator '{op.name}', parameter", _LOGIC)


def check_problem_names(problem: Problem, domain: Domain) -> None:
    """The same for a problem's objects, together with the domain's names."""
    check_name(problem.name, "problem", _LOGIC)
    if problem.domain != domain.name:
        raise InputError(f"problem '{problem.name}' is of the domain '{problem.domain}', not of '{domain.name}'")
    _check_unique([*_declared(domain), *(("object", name) for name, _ in problem.objects)])


def _declared(domain: Domain) -> list[tuple[str, str]]:
    return [
        *(("type", t.name) for t in domain.types),
        *(("predicate", p.name) for p in domain.predicates),
        *(("operator", o.name) for o in domain.operators),
    ]


def _check_unique(declared: Iterable[tuple[str, str]]) -> None:
    seen: set[tuple[str, str]] = set()
    for what, name in declared:
        check_name(name, what, _LOGIC)
        if (what, name) in seen:
            raise InputError(f"there are two of the {what} '{name}'")
        seen.add((what, name))


def legal(identifier: str) -> str:
    """The nearest PDDL name: ``Bottle Crate 2`` becomes ``bottle-crate-2``, ``3d`` becomes ``x3d``, ``object`` ``object-1``."""
    if _LEGAL.fullmatch(identifier) and identifier not in RESERVED:
        return identifier
    plain = unicodedata.normalize("NFKD", identifier).encode("ascii", "ignore").decode().lower()
    name = re.sub(r"[^a-z0-9_]+", "-", plain).strip("-_")
    if not name or not name[0].isalpha():
        name = f"x{name}"
    return f"{name}-1" if name in RESERVED else name


class Names(BaseModel):
    """Identifier to exported name, per kind; identifiers that are not listed keep their name. Made by `Names.of`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal["symskill-names"] = "symskill-names"
    version: Literal[1] = 1
    types: dict[str, str] = Field(default_factory=dict)
    predicates: dict[str, str] = Field(default_factory=dict)
    operators: dict[str, str] = Field(default_factory=dict)
    objects: dict[str, str] = Field(default_factory=dict)
    parameters: dict[str, dict[str, str]] = Field(default_factory=dict)
    """Per operator identifier: its parameters, each with the question mark."""

    @model_validator(mode="after")
    def _reversible(self) -> Self:
        exported: dict[str, str] = {}
        for kind in _KINDS:
            for identifier, name in getattr(self, kind).items():
                check_name(name, f"name of {kind[:-1]} '{identifier}':")
                if name in exported:
                    raise InputError(f"'{name}' names both {exported[name]} and {kind[:-1]} '{identifier}'")
                exported[name] = f"{kind[:-1]} '{identifier}'"
        for operator, mapping in self.parameters.items():
            for parameter, name in mapping.items():
                if not _VARIABLE.fullmatch(name):
                    raise InputError(f"operator '{operator}', parameter '{parameter}': '{name}' is no variable like '?box'")
            if len(set(mapping.values())) != len(mapping):
                raise InputError(f"operator '{operator}' has two parameters with one name")
        return self

    @classmethod
    def of(cls, domain: Domain, objects: Iterable[str] = (), renames: Mapping[str, str] | None = None) -> Names:
        """Names for everything in a domain and the given objects.

        Parameters
        ----------
        renames : mapping of str to str
            Identifier to wished name (the ``--names`` file); a wished name has to be legal and free.

        Raises
        ------
        InputError
            A rename of something that does not exist, to an illegal name, or to one that is taken.
        """
        wished = dict(renames or {})
        listed: list[tuple[str, str]] = [
            *(("types", t.name) for t in domain.types),
            *(("predicates", p.name) for p in domain.predicates),
            *(("operators", o.name) for o in domain.operators),
            *(("objects", name) for name in objects),
        ]
        if unknown := sorted(set(wished) - {identifier for _, identifier in listed}):
            raise InputError(
                f"cannot rename '{unknown[0]}', there is no such name; there are: {alternatives(n for _, n in listed)}"
            )
        chosen: dict[str, dict[str, str]] = {kind: {} for kind in _KINDS}
        taken: set[str] = set()
        for identifier, name in wished.items():
            check_name(name, f"new name of '{identifier}':")
            if name in taken:
                raise InputError(f"two things are to be renamed to '{name}'")
            taken.add(name)
        reserved = set(taken)
        for kind, identifier in listed:
            if identifier in wished and wished[identifier] in reserved:
                name = wished[identifier]
                reserved.discard(name)  # an identifier of two kinds: the first takes the wish, the next a free name like it
            else:
                name = _free(legal(wished.get(identifier, identifier)), taken)
            taken.add(name)
            chosen[kind][identifier] = name
        parameters = {}
        for op in domain.operators:
            inner: dict[str, str] = {}
            for parameter in _variables(op):
                inner[parameter] = "?" + _free(legal(parameter[1:]), {n[1:] for n in inner.values()})
            parameters[op.name] = inner
        return cls.model_validate({**chosen, "parameters": parameters})

    def inverse(self) -> Names:
        """From exported names back to identifiers. The result is not itself a valid set of PDDL names."""
        flipped = {kind: {v: k for k, v in getattr(self, kind).items()} for kind in _KINDS}
        inner = {self.operators.get(op, op): {v: k for k, v in names.items()} for op, names in self.parameters.items()}
        return Names.model_construct(None, parameters=inner, **flipped)

    @cached_property
    def same(self) -> bool:
        """Whether nothing has another name."""
        maps = (*(getattr(self, kind) for kind in _KINDS), *self.parameters.values())
        return all(key == value for mapping in maps for key, value in mapping.items())

    def domain(self, domain: Domain) -> Domain:
        """The domain under the exported names."""
        if self.same:
            return domain
        return Domain(
            domain.name,
            tuple(Type(self._type(t.name), self._type(t.parent)) for t in domain.types),
            tuple(
                Predicate(self.predicates.get(p.name, p.name), tuple(self._type(t) for t in p.types)) for p in domain.predicates
            ),
            tuple(self._operator(o) for o in domain.operators),
        )

    def problem(self, problem: Problem) -> Problem:
        """The problem under the exported names."""
        if self.same:
            return problem
        return replace(
            problem,
            objects=tuple((self.objects.get(name, name), self._type(kind)) for name, kind in problem.objects),
            init=self.atoms(problem.init),
            goal=self.atoms(problem.goal),
        )

    def atoms(self, atoms: Iterable[Atom], variables: Mapping[str, str] | None = None) -> frozenset[Atom]:
        """Atoms under the exported names; `variables` maps parameters."""
        names = self.objects if variables is None else {**self.objects, **variables}
        return frozenset(
            Atom(self.predicates.get(a.predicate, a.predicate), tuple(names.get(x, x) for x in a.args)) for a in atoms
        )

    def plan(self, plan: Plan) -> Plan:
        """The plan under the exported names."""
        if self.same:
            return plan
        steps = tuple((self.operators.get(n, n), tuple(self.objects.get(a, a) for a in args)) for n, args in plan.steps)
        return replace(plan, steps=steps)

    def _type(self, name: str) -> str:
        return ROOT_TYPE if name == ROOT_TYPE else self.types.get(name, name)

    def _operator(self, op: Operator) -> Operator:
        inner = self.parameters.get(op.name, {})

        def parameters(listed: Iterable[Parameter]) -> tuple[Parameter, ...]:
            return tuple(Parameter(inner.get(p.name, p.name), self._type(p.type)) for p in listed)

        return replace(
            op,
            name=self.operators.get(op.name, op.name),
            parameters=parameters(op.parameters),
            pre=self.atoms(op.pre, inner),
            add=self.atoms(op.add, inner),
            delete=self.atoms(op.delete, inner),
            maintain=self.atoms(op.maintain, inner),
            absent=frozenset(
                Absent(next(iter(self.atoms((a.atom,), inner))), parameters(a.over), a.at_most_one) for a in op.absent
            ),
            distinct=op.distinct and frozenset((inner.get(a, a), inner.get(b, b)) for a, b in op.distinct),
        )

    def dumps(self) -> str:
        """The side-car file's text; the same names give the same bytes."""
        return self.model_dump_json(indent=2) + "\n"


def load_names(path: Path) -> Names:
    """Read a side-car file.

    Raises
    ------
    InputError
        The file is missing or cannot be read.
    FormatError
        It is not JSON, has another version, or its names are not reversible.
    """
    return validated(Names.model_validate, read_text(path, "file of names"), str(path))


class _Renames(BaseModel):
    model_config = ConfigDict(extra="forbid")
    renames: dict[str, str]


def load_renames(path: Path) -> dict[str, str]:
    """Read a ``--names`` file: ``{"renames": {"identifier": "wished-name"}}``; raises `FormatError` like `load_names`."""
    text = read_text(path, "file of names")
    try:
        return validated(_Renames.model_validate, text, str(path)).renames
    except FormatError as error:
        raise FormatError(f'{error}; expected {{"renames": {{"identifier": "wished-name", ...}}}}') from None


def _variables(op: Operator) -> list[str]:
    """Every variable of an operator once: its parameters, then those that a negative condition quantifies over."""
    return list(dict.fromkeys([*(p.name for p in op.parameters), *(p.name for a in sorted(op.absent) for p in a.over)]))


def _free(name: str, taken: Collection[str]) -> str:
    """`name`, or the first of name-1, name-2, ... that is not taken."""
    return name if name not in taken else next(n for i in count(1) if (n := f"{name}-{i}") not in taken)
