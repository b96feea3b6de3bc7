"""What every engine that reads PDDL needs: the texts, the names both ways, and an answer that is believed only after a check.

An engine loads a domain once (`Reader.open`) and is then given problem by problem. What it says is one of the statuses of the
protocol; its plan is read strictly, brought back to our names and run by the semantics of `symbols` before anyone sees it.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec

from symskill_pddl.engines.serve import Reply
from symskill_pddl.errors import InputError, MissingDependencyError, alternatives
from symskill_pddl.pddl.export import write_domain, write_problem
from symskill_pddl.pddl.names import Names
from symskill_pddl.pddl.plan import read_plan
from symskill_pddl.planning.engine import Engine, Objects, proven
from symskill_pddl.planning.moves import shortened
from symskill_pddl.planning.protocol import Limits, PlanResult, Status
from symskill_pddl.symbols import Atom, Domain, GroundOperator, Plan, Problem, State, check_atom, check_problem, validate


@dataclass(frozen=True)
class Text:
    """A domain as text in one dialect, for problems over one set of objects; without comments, which not every reader takes."""

    original: Domain
    objects: Objects
    dialect: str

    @cached_property
    def names(self) -> Names:
        return Names.of(self.original, dict(self.objects))

    @cached_property
    def _back(self) -> Names:
        return self.names.inverse()

    @cached_property
    def exported(self) -> Domain:
        return self.names.domain(self.original)

    @cached_property
    def domain(self) -> str:
        return bare(write_domain(self.exported, dialect=self.dialect))

    def problem(self, problem: Problem) -> str:
        return bare(write_problem(self.names.problem(problem), self.exported, dialect=self.dialect))

    def plan(self, answer: str | Plan, source: str) -> Plan:
        """A plan in the text's names, in ours; raises `ParseError` where it is a text and not a plan."""
        if isinstance(answer, str):
            answer = read_plan(answer, self.exported, self._exported_objects, source)
        return self._back.plan(answer)

    @cached_property
    def _exported_objects(self) -> dict[str, str]:
        return self.names.problem(Problem("", "", self.objects, frozenset(), frozenset())).object_types


@lru_cache(maxsize=8)
def text_of(domain: Domain, objects: Objects, dialect: str) -> Text:
    """The text; the last few are kept, for who calls `solve` again and again instead of opening a session."""
    return Text(domain, objects, dialect)


@dataclass(frozen=True)
class Answer:
    """What an engine says; with SOLVED comes a plan, as text or as steps, in the names of the text that the engine was given."""

    status: Status
    plan: str | Plan = ""
    messages: tuple[str, ...] = ()


def answered(reply: Reply) -> Answer:
    """What an engine said in a process of its own."""
    plan = reply.plan if isinstance(reply.plan, str) else Plan(reply.plan or ())
    return Answer(Status(reply.status), plan, reply.messages)


Ask = Callable[[Problem, Limits], Answer]
"""Puts one problem to an engine that has the domain loaded."""


class TextSession:
    """An engine with a domain loaded; see `engine.Ask`."""

    def __init__(self, planner: str, text: Text, ask: Ask, *, shorten: bool, messages: tuple[str, ...] = ()) -> None:
        self._planner, self._text, self._ask = planner, text, ask
        self._shorten, self._messages = shorten, messages
        self._objects = dict(text.objects)
        self._checked: set[Atom] = set()
        check_problem(text.original, self._problem(frozenset(), frozenset()))

    def __call__(self, init: State, goal: State, limits: Limits) -> PlanResult:
        """Plan from `init` to `goal`."""
        start = time.monotonic()

        def result(status: Status, plan: Plan | None = None, *messages: str) -> PlanResult:
            return PlanResult(status, plan, time.monotonic() - start, (*messages, *self._messages), self._planner)

        for where, atoms in (("init", init), ("goal", goal)):
            for atom in sorted(atoms - self._checked):
                check_atom(self._text.original, atom, self._objects, where)
        self._checked |= init | goal
        if goal <= init:
            return result(Status.SOLVED, Plan((), 0.0), "the goal holds already")
        problem = self._problem(init, goal)
        answer = self._ask(problem, limits)
        if answer.status is Status.TIMEOUT:
            return result(Status.TIMEOUT, None, f"the time limit of {limits.time_s:g} s passed", *answer.messages)
        if answer.status is not Status.SOLVED:
            return proven(result(answer.status, None, *answer.messages), self._text.original, self._text.dialect)
        try:
            steps = _believed(self._text.original, problem, self._text.plan(answer.plan, self._planner))
        except InputError as error:
            return result(Status.FAILED, None, f"what {self._planner} gives is not a plan: {error}")
        if self._shorten:
            steps = shortened(self._text.original, self._objects, steps, init, goal)
        plan = Plan(tuple((s.name, s.args) for s in steps), float(sum(s.cost for s in steps)))
        return result(Status.SOLVED, plan, *answer.messages)

    def _problem(self, init: State, goal: State) -> Problem:
        return Problem("replanning", self._text.original.name, self._text.objects, init, goal)


def _believed(domain: Domain, problem: Problem, plan: Plan) -> tuple[GroundOperator, ...]:
    """The ground steps of a plan that reaches the goal; raises `InputError` as `validate` does."""
    steps, state = plan.ground(domain, problem.object_types), problem.init
    for step in steps:
        if not step.applicable(state):
            break
        state = step.apply(state)
    else:
        if problem.goal <= state:
            return steps
    validate(domain, problem, plan)  # runs it again, to say what is wrong
    raise InputError("it does not reach the goal")


@dataclass(frozen=True)
class Reader(Engine):
    """Base of the engines that read PDDL text.

    `dialect` is the dialect to give; empty takes `costs` where operators differ in cost, and `negative` where they do not.
    """

    dialect: str = ""
    family: str = field(default="", init=False, repr=False)
    package: str = field(default="", init=False, repr=False)
    module: str = field(default="", init=False, repr=False)
    licence: str = field(default="", init=False, repr=False)
    dialects: tuple[str, ...] = field(default=("negative", "costs", "strips"), init=False, repr=False)
    shorten: bool = field(default=False, init=False, repr=False)

    def __post_init__(self) -> None:
        if self.dialect and self.dialect not in self.dialects:
            raise InputError(
                f"the planner '{self.family}' does not read the dialect '{self.dialect}'; it reads: {alternatives(self.dialects)}"
            )

    @classmethod
    def installed(cls) -> bool:
        return find_spec(cls.module) is not None

    @property
    def name(self) -> str:
        return f"{self.family}:{self.dialect}" if self.dialect else self.family

    @property
    def version(self) -> str:
        try:
            return version(self.package)
        except PackageNotFoundError:
            return "not installed"

    def plan(self, domain: Domain, problem: Problem, limits: Limits) -> PlanResult:
        return self.open(domain, problem.objects)(problem.init, problem.goal, limits)

    def open(self, domain: Domain, objects: Objects) -> TextSession:
        differ = len({op.cost for op in domain.operators}) > 1
        dialect = self.dialect or ("costs" if differ and "costs" in self.dialects else "negative")
        text = text_of(domain, objects, dialect)
        ignored = differ and dialect in ("strips", "negative")
        notes = (f"{self.name} counts steps and ignores costs",) if ignored else ()
        return TextSession(self.name, text, self.load(text), shorten=self.shorten, messages=notes)

    def load(self, text: Text) -> Ask:
        """Load the domain into the engine."""
        raise NotImplementedError

    def required(self) -> None:
        """Raise `MissingDependencyError` where the engine is not installed."""
        if not self.installed():
            raise MissingDependencyError(
                f"the planner '{self.family}' is not installed; pip install 'symskill-pddl[planners]' (or {self.package})"
            )


def bare(text: str) -> str:
    """Without comments."""
    return re.sub(r";[^\n]*", "", text)
