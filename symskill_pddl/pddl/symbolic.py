"""From the tree of a PDDL text to `symbols`, one to one: each action becomes the operator of its name, nothing is rewritten.

This is the fragment that this package writes, and a little around it: typing, negative conditions (plain, and under ``forall``),
inequalities of parameters, constant costs, durative actions with a constant duration. What lies beyond is named with its place.
`compiled` brings more into the model, at the price of other operators than the text has.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from symskill_pddl.errors import ParseError
from symskill_pddl.pddl.syntax import (
    Action,
    All,
    And,
    Beyond,
    Change,
    Compare,
    Condition,
    Each,
    Effect,
    Fact,
    Not,
    Number,
    Or,
    Place,
    Quantified,
    Remark,
    Same,
    Set,
    Value,
    Variable,
    When,
    parts_of,
)
from symskill_pddl.pddl.syntax import Domain as DomainText
from symskill_pddl.pddl.syntax import Problem as ProblemText
from symskill_pddl.symbols import Absent, Atom, Domain, Operator, Parameter, Predicate, Problem, Type


class BeyondModelError(ParseError):
    """A text says something that our own model cannot hold; planners that read PDDL themselves may."""


@dataclass
class _Needed:
    """What the conditions of an action collect."""

    pre: set[Atom] = field(default_factory=set)
    absent: set[Absent] = field(default_factory=set)
    distinct: set[tuple[str, str]] = field(default_factory=set)


@dataclass
class _Done:
    """What its effects do."""

    add: set[Atom] = field(default_factory=set)
    delete: set[Atom] = field(default_factory=set)
    costs: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class Symbolic:
    """Conversion of what was read from `source`."""

    source: str

    def beyond(self, what: str, at: Place) -> BeyondModelError:
        return BeyondModelError(f"{what} are not supported by our own model", source=self.source, line=at[0], column=at[1])

    def refused(self, message: str, at: Place) -> ParseError:
        return ParseError(message, source=self.source, line=at[0], column=at[1])

    def domain(self, read: DomainText) -> Domain:
        """The domain; raises `ParseError` where it is not in order, `BeyondModelError` where the model cannot hold it."""
        self._in_order(read.remarks)
        if read.rules:
            raise self.beyond("derived predicates", read.rules[0].at)
        if read.beyond:
            raise self.beyond(read.beyond[0].what, read.beyond[0].at)
        types = []
        for name, parents in read.vocabulary.types.items():
            if len(parents) != 1:
                raise self.beyond("types with several parents", (1, 1))
            types.append(Type(name, parents[0]))
        predicates = []
        for name, declared in read.vocabulary.predicates.items():
            predicates.append(Predicate(name, tuple(self._one(kinds, (1, 1)) for kinds in declared)))
        priced = costs_counted(read)
        operators = tuple(self._operator(action, priced) for action in read.actions)
        return Domain(read.name, tuple(types), tuple(predicates), operators)

    def problem(self, read: ProblemText) -> Problem:
        """The problem, over the objects that its own text declares."""
        self._in_order(read.remarks)
        if read.beyond or read.timed:
            part = read.beyond[0] if read.beyond else Beyond("facts that come true at a time", "", read.timed[0][1].at)
            raise self.beyond(part.what, part.at)
        if other := [v for v, _ in read.values if v.function != "total-cost"]:
            raise self.beyond("numbers of functions", other[0].at)
        goal = _Needed()
        self._condition(read.goal, goal, (), ())
        if goal.absent or goal.distinct:
            raise self.beyond("negative goals", _first_negative(read.goal))
        objects = tuple((name, self._one(kinds, (1, 1))) for name, kinds in read.objects)
        return Problem(read.name, read.domain, objects, frozenset(f.atom for f in read.init), frozenset(goal.pre))

    def _in_order(self, remarks: Iterable[Remark]) -> None:
        for remark in remarks:
            if not remark.harmless:
                raise self.refused(remark.what, remark.at)

    def _one(self, kinds: tuple[str, ...], at: Place) -> str:
        if len(kinds) != 1:
            raise self.beyond("'either' types", at)
        return kinds[0]

    def _operator(self, action: Action, priced: bool) -> Operator:
        names = tuple(p.name for p in action.parameters)
        parameters = tuple(Parameter(p.name, self._one(p.types, p.at)) for p in action.parameters)
        if action.duration is not None:
            return self._durative(action, names, parameters)
        needed, done = _Needed(), _Done()
        self._condition(action.condition(), needed, names, ())
        self._effect(action.effect(), done, names)
        return Operator(
            action.name,
            parameters,
            frozenset(needed.pre),
            frozenset(done.add),
            frozenset(done.delete),
            absent=frozenset(needed.absent),
            cost=sum(done.costs) if priced else 1.0,
            distinct=frozenset(needed.distinct),
        )

    def _durative(self, action: Action, names: tuple[str, ...], parameters: tuple[Parameter, ...]) -> Operator:
        (said, *more) = action.duration or (Compare("=", Number(0), Number(0), action.at),)
        if more or said.symbol != "=" or not isinstance(said.right, Number):
            raise self.beyond("durations that are not one number", said.at)
        cost = self._amount(said.right.value, said.at)
        start, over = _Needed(), _Needed()
        for when, condition in action.conditions:
            if when == "end":
                raise self.beyond("conditions at end", _place(condition))
            self._condition(condition, start if when == "start" else over, names, ())
        if over.absent or over.distinct:
            raise self.beyond("negative conditions over all", _place(action.condition("all")))
        early, late = _Done(), _Done()
        for when, effect in action.effects:
            self._effect(effect, early if when == "start" else late, names)
            if early.costs or late.costs:
                raise self.beyond("numeric effects of durative actions", _place(effect))
            if early.add:
                raise self.beyond("add effects at start", _place(effect))
        return Operator(
            action.name,
            parameters,
            frozenset(start.pre),
            frozenset(late.add),
            frozenset(early.delete | late.delete),
            frozenset(over.pre | late.delete),
            absent=frozenset(start.absent),
            cost=cost,
            distinct=frozenset(start.distinct),
        )

    def _condition(self, part: Condition, into: _Needed, names: tuple[str, ...], over: tuple[Variable, ...]) -> None:
        match part:
            case And():
                for inner in part.parts:
                    self._condition(inner, into, names, over)
            case Quantified(every=True):
                self._condition(part.part, into, names, (*over, *part.variables))
            case Not(part=Fact(atom=atom, at=at)):
                variables = tuple(Parameter(v.name, self._one(v.types, v.at)) for v in over)
                into.absent.add(Absent(self._lifted(atom, names, at, over), variables))
            case Not(part=Same(left=left, right=right, at=at)):
                if over:
                    raise self.beyond("inequalities under 'forall'", at)
                if left not in names or right not in names or left == right:
                    raise self.beyond("inequalities of other than two parameters", at)
                into.distinct.add((left, right) if names.index(left) < names.index(right) else (right, left))
            case Fact(atom=atom, at=at):
                if over:
                    what = f"under 'forall' only (not (...)) is supported, got '{part}'"
                    raise BeyondModelError(what, source=self.source, line=at[0], column=at[1])
                into.pre.add(self._lifted(atom, names, at, ()))
            case _:
                raise self.beyond(beyond_what(part), _place(part))

    def _effect(self, part: Effect, into: _Done, names: tuple[str, ...]) -> None:
        match part:
            case All():
                for inner in part.parts:
                    self._effect(inner, into, names)
            case Set(atom=atom, value=value, at=at):
                (into.add if value else into.delete).add(self._lifted(atom, names, at, ()))
            case Change(symbol="increase", target=Value(function="total-cost"), amount=Number(value=amount), at=at):
                into.costs.append(self._amount(amount, at))
            case When(at=at):
                raise self.beyond("conditional effects", at)
            case Each(at=at):
                raise self.beyond("universal effects", at)
            case Change(at=at):
                raise self.beyond("numeric effects other than (increase (total-cost) NUMBER)", at)
            case Beyond(what=what, at=at):
                raise self.beyond(what, at)

    def _lifted(self, atom: Atom, names: tuple[str, ...], at: Place, over: tuple[Variable, ...]) -> Atom:
        if names and not set(atom.args) <= {*names, *(v.name for v in over)}:
            raise self.beyond("constants", at)
        return atom

    def _amount(self, value: float, at: Place) -> float:
        if value < 0.0:
            raise self.refused(f"a cost or duration is not negative and finite, got '{value:g}'", at)
        return value


def costs_counted(read: DomainText) -> bool:
    """Whether actions cost what their text says, nothing where it says nothing; else each counts one."""
    parts = (p for a in read.actions for _, e in a.effects for p in parts_of(e))
    return any(isinstance(p, Change) and p.target.function == "total-cost" for p in parts)


def beyond_what(part: Condition) -> str:
    """A phrase for a condition that the model cannot hold."""
    match part:
        case Or():
            return "disjunctive conditions"
        case Quantified():
            return "existential conditions"
        case Same():
            return "equality conditions"
        case Compare():
            return "numeric conditions"
        case Not():
            return "negations of compound conditions"
        case Beyond(what=what):
            return what
        case _:
            return "such conditions"


def _place(part: Condition | Effect) -> Place:
    places = [p.at for p in parts_of(part) if hasattr(p, "at") and p.at != (1, 1)]
    return min(places, default=(1, 1))


def _first_negative(goal: Condition) -> Place:
    return next(p.at for p in parts_of(goal) if isinstance(p, Not))
