"""Symbols to PDDL text. What each dialect can say is decided in `dialect`; here it is only written down."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined

from symskill_pddl.pddl.dialect import COST_SCALE, Exported, Stated, exported, parameter_list, requirements, unifiable
from symskill_pddl.pddl.names import check_domain_names, check_problem_names
from symskill_pddl.symbols import Absent, Domain, Operator, Predicate, Problem


@cache
def _environment() -> Environment:
    return Environment(
        loader=PackageLoader("symskill_pddl.pddl"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,  # PDDL is no markup
    )


def write_domain(
    domain: Domain,
    *,
    dialect: str = "strips",
    comments: Mapping[str, Sequence[str]] | None = None,
    header: Sequence[str] = (),
) -> str:
    """The domain as PDDL text.

    Parameters
    ----------
    domain : Domain
        With names that PDDL can take, see `names.Names`.
    dialect : str
        One of `dialect.DIALECTS`.
    comments : mapping of str to sequence of str
        Lines to stand above the declaration of a type, predicate or operator, by its name.
    header : sequence of str
        Lines to stand at the top.

    Raises
    ------
    InputError
        The domain is ill-formed, a name is not a PDDL name, or the dialect cannot say what an operator asks for.
    """
    check_domain_names(domain)
    form = exported(domain, dialect)
    lines = defaultdict(tuple, {name: tuple(_comment(text)) for name, text in (comments or {}).items()})
    for complement in form.complements:
        lines[complement.name] = (_meaning(form, complement.name), *lines[complement.name])
    if form.different:
        lines[form.different] = ("true of every two different objects", *lines[form.different])
    if form.arm:
        lines[form.arm] = ("the arm does one thing at a time", *lines[form.arm])
    for stated in form.stated:
        lines[stated.operator] = (*lines[stated.operator], _statement(stated))
    top = [*_comment(header)]
    if dialect == "costs":
        top.append(f"costs are in 1/{COST_SCALE} of the unit that they were learned in")
    return (
        _environment()
        .get_template("domain.pddl.j2")
        .render(
            domain=form.domain,
            requirements=requirements(form),
            comments=lines,
            header=top,
            costs=dialect == "costs",
            temporal=dialect == "temporal",
            signature=signature,
            parameters=parameter_list,
            number=number,
            conditions=lambda op: list(_conditions(form, op)),
            effects=lambda op: list(_effects(form, op)),
        )
    )


def write_problem(problem: Problem, domain: Domain, *, dialect: str = "strips", header: Sequence[str] = ()) -> str:
    """The problem as PDDL text that belongs to ``write_domain(domain, dialect=dialect)``.

    Raises
    ------
    InputError
        A name is not a PDDL name, the problem does not fit the domain, or its initial state cannot be said in the dialect.
    """
    check_domain_names(domain)
    check_problem_names(problem, domain)
    form = exported(domain, dialect)
    whole = form.problem(problem)
    return (
        _environment()
        .get_template("problem.pddl.j2")
        .render(
            problem=whole,
            init=sorted(whole.init),
            goal=sorted(whole.goal),
            header=[*_comment(header)],
            costs=dialect == "costs",
            temporal=dialect == "temporal",
        )
    )


def signature(predicate: Predicate) -> str:
    """Arguments named after their types: ``?food - food ?cabinet - cabinet``, numbered where a type stands twice."""
    names = [
        f"?{kind}{1 + predicate.types[:i].count(kind)}" if predicate.types.count(kind) > 1 else f"?{kind}"
        for i, kind in enumerate(predicate.types)
    ]
    if len(set(names)) != len(names):  # types 'a', 'a' and 'a1'
        names = [f"?x{i + 1}" for i in range(len(names))]
    return " ".join(f"{name} - {kind}" for name, kind in zip(names, predicate.types, strict=True))


def number(value: float) -> str:
    """Without a fraction where there is none, never with an exponent."""
    return str(int(value)) if value == int(value) else f"{value:.6f}".rstrip("0")


def _conditions(form: Exported, op: Operator) -> Iterator[str]:
    start = "(at start {})" if form.dialect == "temporal" else "{}"
    for atom in sorted(op.pre):
        yield start.format(atom)
    for absent in sorted(op.absent):
        yield start.format(_negative(absent))
    if form.dialect != "strips":
        for a, b in unifiable(form.domain, op):
            yield start.format(f"(not (= {a} {b}))")
    if form.dialect == "temporal":
        for atom in sorted(op.protected):
            yield f"(over all {atom})"


def _effects(form: Exported, op: Operator) -> Iterator[str]:
    if form.dialect == "temporal":
        for atom in sorted(op.delete - op.maintain):
            yield f"(at start (not {atom}))"
        for atom in sorted(op.add):
            yield f"(at end {atom})"
        for atom in sorted(op.delete & op.maintain):
            yield f"(at end (not {atom}))"
        return
    for atom in sorted(op.add):
        yield str(atom)
    for atom in sorted(op.delete):
        yield f"(not {atom})"
    if form.dialect == "costs":
        yield f"(increase (total-cost) {number(op.cost)})"


def _negative(absent: Absent) -> str:
    if not absent.over:
        return f"(not {absent.atom})"
    return f"(forall ({parameter_list(absent.over)}) (not {absent.atom}))"


def _meaning(form: Exported, name: str) -> str:
    complement = next(c for c in form.complements if c.name == name)
    if not complement.over:
        return f"where {complement.predicate} is false"
    return f"where {complement.predicate} is false for every {' and '.join(kind for _, kind in complement.over)}"


def _statement(stated: Stated) -> str:
    kinds = " and ".join(kind for _, kind in stated.complement.over)
    return f"stated: at most one {kinds} with {stated.effect} at a time, as in all demonstrations, so {stated.needs} is needed"


def _comment(lines: Sequence[str]) -> Iterator[str]:
    """No line of a comment can end it and become PDDL."""
    for text in lines:
        yield from text.splitlines()
