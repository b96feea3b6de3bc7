"""What a task means: states, conditions, effects and plans, evaluated on the tree of `syntax` as it stands.

Nothing is compiled or grounded ahead: a condition is a function of a state, an effect a list of changes, a plan is run step by
step. So this is slow and plain, and the judge of what other parts of the package, and other people's planners, come up with.
Parameters may be bound to one object unless the text says otherwise. Of an atom that is added and deleted at once, the adding
counts.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product
from operator import add, mul, sub, truediv

from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.pddl.derived import layers
from symskill_pddl.pddl.syntax import (
    Action,
    All,
    And,
    Arithmetic,
    Beyond,
    Change,
    Compare,
    Condition,
    Each,
    Effect,
    Expression,
    Fact,
    Not,
    Number,
    Or,
    Quantified,
    Same,
    Set,
    Value,
    Variable,
    When,
)
from symskill_pddl.pddl.task import Task
from symskill_pddl.symbols import Atom

Binding = Mapping[str, str]
_CLOSE = 1e-6
"""Two numbers that differ by no more, relative to their size, are equal: sums of decimal fractions are not exact."""
_ARITHMETIC = {"+": add, "-": sub, "*": mul, "/": truediv}


class NotEvaluatedError(InputError):
    """The text says something that has no meaning here."""


@dataclass(frozen=True)
class Moment:
    """A state: the facts that hold, and the values of functions."""

    facts: frozenset[Atom]
    values: Mapping[tuple[str, tuple[str, ...]], float] = field(default_factory=dict)
    closed: bool = False
    """Whether the facts that rules derive are among the facts."""


class Semantics:
    """The meaning of one task.

    Raises
    ------
    NotEvaluatedError
        The task has preferences, constraints, probabilities or the like.
    """

    def __init__(self, task: Task) -> None:
        if task.beyond:
            what, source, (line, column) = task.beyond[0]
            raise NotEvaluatedError(f"{source}:{line}:{column}: {what} are read but not evaluated")
        self.task = task
        self._pools: dict[tuple[str, ...], tuple[str, ...]] = {}
        self._layers = layers(task.domain.rules)
        self._derived = frozenset(rule.head for rule in task.domain.rules)
        self._closed: tuple[Moment, Moment] | None = None

    def initial(self) -> Moment:
        problem = self.task.problem
        values = {(v.function, v.args): number for v, number in problem.values}
        if "total-cost" in self.task.domain.vocabulary.functions:
            values.setdefault(("total-cost", ()), 0.0)
        early = {s.atom: s.value for at, s in problem.timed if at <= 0.0}
        facts = {f.atom for f in problem.init} | {a for a, value in early.items() if value}
        return Moment(frozenset(facts - {a for a, value in early.items() if not value}), values)

    def pool(self, kinds: tuple[str, ...]) -> tuple[str, ...]:
        """The objects that a variable of these types ranges over, in the order of the text."""
        if kinds not in self._pools:
            fits = self.task.domain.vocabulary.fits
            self._pools[kinds] = tuple(o for o, own in self.task.objects.items() if fits(own, kinds))
        return self._pools[kinds]

    def bindings(self, variables: Iterable[Variable], outer: Binding) -> Iterator[dict[str, str]]:
        variables = tuple(variables)
        for choice in product(*(self.pool(v.types) for v in variables)):
            yield {**outer, **dict(zip((v.name for v in variables), choice, strict=True))}

    def bind(self, action: Action, args: tuple[str, ...]) -> dict[str, str]:
        """Parameters to objects; raises `InputError` for a wrong number, an unknown object or one of the wrong type."""
        expected = " ".join(map(str, action.parameters)) or "none"
        if len(args) != len(action.parameters):
            raise InputError(f"'{action.name}' takes {len(action.parameters)} arguments ({expected}), got {len(args)}")
        for parameter, arg in zip(action.parameters, args, strict=True):
            if arg not in self.task.objects:
                raise InputError(
                    f"'{action.name}' names the unknown object '{arg}'; there are: {alternatives(self.task.objects)}"
                )
            if arg not in self.pool(parameter.types):
                fitting = alternatives(self.pool(parameter.types))
                raise InputError(f"'{action.name}' needs {parameter}, '{arg}' is none; objects that fit: {fitting}")
        return {p.name: a for p, a in zip(action.parameters, args, strict=True)}

    def holds(self, part: Condition, binding: Binding, moment: Moment) -> bool:
        match part:
            case Fact(atom=atom):
                return self._true(atom.substitute(binding), moment)
            case Same(left=left, right=right):
                return binding.get(left, left) == binding.get(right, right)
            case Not(part=inner):
                return not self.holds(inner, binding, moment)
            case And(parts=parts):
                return all(self.holds(p, binding, moment) for p in parts)
            case Or(parts=parts):
                return any(self.holds(p, binding, moment) for p in parts)
            case Quantified(every=every, variables=variables, part=inner):
                found = (self.holds(inner, b, moment) for b in self.bindings(variables, binding))
                return all(found) if every else any(found)
            case Compare():
                return compared(part.symbol, self.number(part.left, binding, moment), self.number(part.right, binding, moment))
            case Beyond():
                raise NotEvaluatedError(f"{part.what} are not evaluated")

    def number(self, part: Expression, binding: Binding, moment: Moment) -> float:
        """A value; raises `InputError` where it is not defined."""
        match part:
            case Number(value=value):
                return value
            case Value(function="?duration"):
                return float(binding["?duration"])
            case Value(function=function, args=args):
                key = (function, tuple(binding.get(a, a) for a in args))
                if key not in moment.values:
                    raise InputError(f"{Value(*key)} has no value")
                return moment.values[key]
            case Arithmetic(symbol=symbol, parts=(first, *rest)):
                value = self.number(first, binding, moment)
                if not rest:
                    return -value if symbol == "-" else value
                for other in rest:
                    by = self.number(other, binding, moment)
                    if symbol == "/" and by == 0.0:
                        raise InputError(f"{part} divides by zero")
                    value = _ARITHMETIC[symbol](value, by)
                return float(value)
        raise InputError(f"'{part}' is no number")

    def changes(self, part: Effect, binding: Binding, moment: Moment) -> Iterator[tuple[Set | Change, Binding]]:
        """What an effect changes, seen from the state before it."""
        match part:
            case All(parts=parts):
                for inner in parts:
                    yield from self.changes(inner, binding, moment)
            case When(condition=condition, effect=inner):
                if self.holds(condition, binding, moment):
                    yield from self.changes(inner, binding, moment)
            case Each(variables=variables, effect=inner):
                for wider in self.bindings(variables, binding):
                    yield from self.changes(inner, wider, moment)
            case Set() | Change():
                yield part, binding
            case Beyond():
                raise NotEvaluatedError(f"{part.what} are not evaluated")

    def after(self, changes: Iterable[tuple[Set | Change, Binding]], moment: Moment) -> Moment:
        """The state that the changes make of `moment`, all at once."""
        adds, deletes, values = set[Atom](), set[Atom](), dict(moment.values)
        for change, binding in changes:
            if isinstance(change, Set):
                (adds if change.value else deletes).add(change.atom.substitute(binding))
                continue
            key = (change.target.function, tuple(binding.get(a, a) for a in change.target.args))
            amount = self.number(change.amount, binding, moment)
            if change.symbol != "assign" and key not in values:
                raise InputError(f"{Value(*key)} has no value to {change.symbol}")
            values[key] = _changed(change.symbol, values.get(key, 0.0), amount)
        return Moment((moment.facts - deletes) | adds, values)

    def _true(self, atom: Atom, moment: Moment) -> bool:
        if atom.predicate in self._derived and not moment.closed:
            moment = self.closed(moment)
        return atom in moment.facts

    def closed(self, moment: Moment) -> Moment:
        """The state with all that the rules derive from it."""
        if self._closed is not None and self._closed[0] == moment:
            return self._closed[1]
        facts = frozenset(a for a in moment.facts if a.predicate not in self._derived)
        for rules in self._layers:
            grown: frozenset[Atom] | None = None
            while grown != facts:
                grown, here = facts, Moment(facts, moment.values, closed=True)
                facts |= frozenset(
                    Atom(rule.head, tuple(binding[p.name] for p in rule.parameters))
                    for rule in rules
                    for binding in self.bindings(rule.parameters, {})
                    if self.holds(rule.condition, binding, here)
                )
        self._closed = (moment, Moment(facts, moment.values, closed=True))
        return self._closed[1]

    def missing(self, part: Condition, binding: Binding, moment: Moment) -> str:
        """Which parts of a condition do not hold, in the words of PDDL."""
        if isinstance(part, And):
            found = (self.missing(p, binding, moment) for p in part.parts if not self.holds(p, binding, moment))
            return " ".join(found)
        return (
            " ".join(binding.get(word, word) for word in str(part).replace("(", "( ").replace(")", " )").split())
            .replace("( ", "(")
            .replace(" )", ")")
        )


def compared(symbol: str, left: float, right: float) -> bool:
    """A comparison that takes numbers for equal that differ by rounding."""
    close = abs(left - right) <= _CLOSE * max(1.0, abs(left), abs(right))
    return {"=": close, "<=": close or left < right, ">=": close or left > right, "<": left < right and not close}.get(
        symbol, left > right and not close
    )


def _changed(symbol: str, value: float, amount: float) -> float:
    match symbol:
        case "assign":
            return amount
        case "increase":
            return value + amount
        case "decrease":
            return value - amount
        case "scale-up":
            return value * amount
    if amount == 0.0:
        raise InputError("scale-down by zero")
    return value / amount
