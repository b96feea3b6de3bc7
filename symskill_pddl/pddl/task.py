"""A planning task as somebody wrote it: two texts, kept byte for byte, and what a reader knows of them.

Planners that read PDDL are given the texts. Our own model (`symbols`) is for those that need one, see `compiled`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from symskill_pddl.pddl.sections import FileReader
from symskill_pddl.pddl.syntax import (
    Arithmetic,
    Beyond,
    Change,
    Compare,
    Domain,
    Each,
    Not,
    Or,
    Place,
    Problem,
    Quantified,
    Same,
    Value,
    When,
    parts_of,
)

Kinds = tuple[str, ...]


@dataclass(frozen=True)
class Task:
    """A domain and a problem. The texts decide what it means; the trees are read from them."""

    domain_text: str
    problem_text: str
    domain: Domain
    problem: Problem
    sources: tuple[str, str] = ("<domain>", "<problem>")

    @cached_property
    def objects(self) -> dict[str, Kinds]:
        """Every constant and object with its types."""
        return {**dict(self.domain.vocabulary.constants), **dict(self.problem.objects)}

    @cached_property
    def features(self) -> tuple[tuple[str, str, Place], ...]:
        """What the texts use beyond typed STRIPS: a phrase in the plural, and where it stands first."""
        found: dict[str, tuple[str, Place]] = {}
        for source, what, place in (*self._of_domain(), *self._of_problem()):
            found.setdefault(what, (source, place))
        return tuple((what, source, place) for what, (source, place) in found.items())

    @cached_property
    def beyond(self) -> tuple[tuple[str, str, Place], ...]:
        """Those of the features that have no meaning here: a plan with them cannot be validated by `evaluate`."""
        parts = [(s, p) for s, p in self._parts() if isinstance(p, Beyond)]
        sections = [(self.sources[0], b) for b in self.domain.beyond] + [(self.sources[1], b) for b in self.problem.beyond]
        return tuple((b.what, source, b.at) for source, b in (*sections, *parts))

    @property
    def remarks(self) -> tuple[str, ...]:
        """Lines about what is not quite as it should be, each with its place."""
        both = zip(self.sources, (self.domain.remarks, self.problem.remarks), strict=True)
        return tuple(f"{source}:{r.at[0]}:{r.at[1]}: {r.what}" for source, remarks in both for r in remarks)

    def uses(self, *phrases: str) -> bool:
        return any(what in phrases for what, _, _ in self.features)

    def _parts(self) -> Iterator[tuple[str, object]]:
        for action in self.domain.actions:
            for _, node in (*action.conditions, *action.effects):
                yield from ((self.sources[0], part) for part in parts_of(node))
        for rule in self.domain.rules:
            yield from ((self.sources[0], part) for part in parts_of(rule.condition))
        yield from ((self.sources[1], part) for part in parts_of(self.problem.goal))

    def _of_domain(self) -> Iterator[tuple[str, str, Place]]:
        source = self.sources[0]
        for action in self.domain.actions:
            if action.duration is not None:
                yield source, "durative actions", action.at
            if any(len(p.types) > 1 for p in action.parameters):
                yield source, "'either' types", action.at
        for rule in self.domain.rules:
            yield source, "derived predicates", rule.at
        for part in self.domain.beyond:
            yield source, part.what, part.at

    def _of_problem(self) -> Iterator[tuple[str, str, Place]]:
        for source, part in self._parts():
            if what := _feature(part):
                yield source, what, getattr(part, "at", (1, 1))
        source, problem = self.sources[1], self.problem
        if problem.timed:
            yield source, "facts that come true at a time", problem.timed[0][1].at
        if problem.metric is not None:
            yield source, "metrics" if problem.metric.minimize else "metrics to maximize", problem.metric.at
        for beyond in problem.beyond:
            yield source, beyond.what, beyond.at


def _feature(part: object) -> str:
    match part:
        case Or():
            return "disjunctive conditions"
        case Quantified(every=False):
            return "existential conditions"
        case Quantified():
            return "universal conditions"
        case Not():
            return "negative conditions"
        case Same():
            return "equality"
        case When():
            return "conditional effects"
        case Each():
            return "universal effects"
        case Compare():
            return "numeric conditions"
        case Change(target=Value(function="total-cost")):
            return "action costs"
        case Change() | Arithmetic():
            return "numeric effects"
        case Beyond(what=what):
            return what
        case _:
            return ""


def read_task(domain_text: str, problem_text: str, domain_source: str = "<domain>", problem_source: str = "<problem>") -> Task:
    """Read both texts; the mark that some editors put before the first byte is left out, for planners stumble over it.

    Raises
    ------
    ParseError
        With line and column: the text is no PDDL, or a name is unknown or has the wrong number of arguments.
    """
    domain = FileReader(domain_source).domain(domain_text)
    problem = FileReader(problem_source).problem(problem_text, domain.name, domain.vocabulary)
    first, second = domain_text.removeprefix("\ufeff"), problem_text.removeprefix("\ufeff")
    return Task(first, second, domain, problem, (domain_source, problem_source))
