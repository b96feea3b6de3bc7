"""What a PDDL text says, as it says it: one tree for conditions, effects and numbers, and the two files around them.

It holds what people write, not what our own model can hold: `evaluate` gives it its meaning directly, `symbolic` and `compiled`
bring it into `symbols` for those who need that. Every part that an error may be about has its place, (line, column) from 1, which
does not count in comparisons.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from symskill_pddl.symbols import ROOT_TYPE, Atom

Place = tuple[int, int]


@dataclass(frozen=True)
class Variable:
    """A variable, or an argument's place in a declaration; several types are an ``either``."""

    name: str
    types: tuple[str, ...] = (ROOT_TYPE,)
    at: Place = field(default=(1, 1), compare=False, repr=False)

    def __str__(self) -> str:
        kind = self.types[0] if len(self.types) == 1 else f"(either {' '.join(self.types)})"
        return f"{self.name} - {kind}"


@dataclass(frozen=True)
class Fact:
    """A predicate applied to terms."""

    atom: Atom
    at: Place = field(default=(1, 1), compare=False, repr=False)

    def __str__(self) -> str:
        return str(self.atom)


@dataclass(frozen=True)
class Same:
    """``(= ?a ?b)`` of two terms."""

    left: str
    right: str
    at: Place = field(default=(1, 1), compare=False, repr=False)

    def __str__(self) -> str:
        return f"(= {self.left} {self.right})"


@dataclass(frozen=True)
class Not:
    """A negated condition."""

    part: Condition
    at: Place = field(default=(1, 1), compare=False, repr=False)

    def __str__(self) -> str:
        return f"(not {self.part})"


@dataclass(frozen=True)
class And:
    """A conjunction; without parts it is true."""

    parts: tuple[Condition, ...] = ()
    at: Place = field(default=(1, 1), compare=False, repr=False)

    def __str__(self) -> str:
        return f"({' '.join(('and', *map(str, self.parts)))})"


@dataclass(frozen=True)
class Or:
    """A disjunction; ``(imply a b)`` is read as ``(or (not a) b)``."""

    parts: tuple[Condition, ...]
    at: Place = field(default=(1, 1), compare=False, repr=False)

    def __str__(self) -> str:
        return f"({' '.join(('or', *map(str, self.parts)))})"


@dataclass(frozen=True)
class Quantified:
    """``forall`` where `every`, else ``exists``."""

    every: bool
    variables: tuple[Variable, ...]
    part: Condition
    at: Place = field(default=(1, 1), compare=False, repr=False)

    def __str__(self) -> str:
        return f"({'forall' if self.every else 'exists'} ({' '.join(map(str, self.variables))}) {self.part})"


@dataclass(frozen=True)
class Number:
    """A constant."""

    value: float

    def __str__(self) -> str:
        return f"{self.value:g}"


@dataclass(frozen=True)
class Value:
    """A function applied to terms; ``?duration``, ``total-time`` and ``total-cost`` are functions without arguments."""

    function: str
    args: tuple[str, ...] = ()
    at: Place = field(default=(1, 1), compare=False, repr=False)

    def __str__(self) -> str:
        return "(" + " ".join((self.function, *self.args)) + ")"


@dataclass(frozen=True)
class Arithmetic:
    """``+ - * /`` of two or more numbers, or ``-`` of one."""

    symbol: str
    parts: tuple[Expression, ...]

    def __str__(self) -> str:
        return f"({' '.join((self.symbol, *map(str, self.parts)))})"


@dataclass(frozen=True)
class Compare:
    """``< <= = >= >`` of two numbers."""

    symbol: str
    left: Expression
    right: Expression
    at: Place = field(default=(1, 1), compare=False, repr=False)

    def __str__(self) -> str:
        return f"({self.symbol} {self.left} {self.right})"


@dataclass(frozen=True)
class Beyond:
    """Something that is read over and handed on, but has no meaning here; `what` names it in the plural."""

    what: str
    text: str = ""
    at: Place = field(default=(1, 1), compare=False, repr=False)

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Remark:
    """A sentence about what is not quite as it should be, though most planners take it."""

    what: str
    at: Place = field(default=(1, 1), compare=False, repr=False)
    harmless: bool = False
    """Whether it can mean one thing only; the rest is refused where the text is to become our own model."""
    broken: bool = False
    """Whether the text is not whole: it is read, for what can be said of it, and nothing is planned with it."""


Expression = Number | Value | Arithmetic
Condition = Fact | Same | Not | And | Or | Quantified | Compare | Beyond


@dataclass(frozen=True)
class Set:
    """An atom becomes true, or false."""

    atom: Atom
    value: bool = True
    at: Place = field(default=(1, 1), compare=False, repr=False)


@dataclass(frozen=True)
class Change:
    """``assign``, ``increase``, ``decrease``, ``scale-up`` or ``scale-down`` of a function's value."""

    symbol: str
    target: Value
    amount: Expression
    at: Place = field(default=(1, 1), compare=False, repr=False)


@dataclass(frozen=True)
class When:
    """An effect that a condition of the state before decides."""

    condition: Condition
    effect: Effect
    at: Place = field(default=(1, 1), compare=False, repr=False)


@dataclass(frozen=True)
class Each:
    """``(forall (?x) effect)``."""

    variables: tuple[Variable, ...]
    effect: Effect
    at: Place = field(default=(1, 1), compare=False, repr=False)


@dataclass(frozen=True)
class All:
    """Several effects; without parts, none."""

    parts: tuple[Effect, ...] = ()


Effect = Set | Change | When | Each | All | Beyond


@dataclass(frozen=True)
class Action:
    """An action. What it needs and does stands with its time: "now", or "start", "all" and "end" of a durative action."""

    name: str
    parameters: tuple[Variable, ...]
    conditions: tuple[tuple[str, Condition], ...]
    effects: tuple[tuple[str, Effect], ...]
    duration: tuple[Compare, ...] | None = None
    """What is said of ``?duration``; None for an action that takes no time."""
    at: Place = field(default=(1, 1), compare=False, repr=False)

    def condition(self, when: str = "now") -> Condition:
        return And(tuple(c for time, c in self.conditions if time == when))

    def effect(self, when: str = "now") -> Effect:
        return All(tuple(e for time, e in self.effects if time == when))


@dataclass(frozen=True)
class Rule:
    """``(:derived (p ?x) condition)``."""

    head: str
    parameters: tuple[Variable, ...]
    condition: Condition
    at: Place = field(default=(1, 1), compare=False, repr=False)


class _Above(dict[str, frozenset[str]]):
    """Worked out for the types that are asked for: in a line of types all together have half as many as their square."""

    def __init__(self, parents: Mapping[str, tuple[str, ...]]) -> None:
        super().__init__({ROOT_TYPE: frozenset({ROOT_TYPE})})
        self._parents = parents

    def __missing__(self, name: str) -> frozenset[str]:
        seen, todo = {ROOT_TYPE, name}, list(self._parents[name])
        while todo:
            if (kind := todo.pop()) not in seen:
                seen.add(kind)
                todo += self._parents.get(kind, ())
        self[name] = frozenset(seen)
        return self[name]


@dataclass(frozen=True)
class Vocabulary:
    """The names that conditions may use. `types` has every type but `object`, with its parents."""

    types: Mapping[str, tuple[str, ...]]
    constants: tuple[tuple[str, tuple[str, ...]], ...] = ()
    predicates: Mapping[str, tuple[tuple[str, ...], ...]] = field(default_factory=dict)
    functions: Mapping[str, tuple[tuple[str, ...], ...]] = field(default_factory=dict)

    @cached_property
    def above(self) -> Mapping[str, frozenset[str]]:
        """Of each type, itself and all that it is below."""
        return _Above(self.types)

    def fits(self, kinds: Iterable[str], wanted: Iterable[str]) -> bool:
        """Whether what is of one of `kinds`, and nobody knows which, is always one of `wanted`."""
        return all(any(w in self.above[kind] for w in wanted) for kind in kinds)


@dataclass(frozen=True)
class Domain:
    """A domain's text, read."""

    name: str
    vocabulary: Vocabulary
    actions: tuple[Action, ...]
    rules: tuple[Rule, ...] = ()
    requirements: tuple[str, ...] = ()
    beyond: tuple[Beyond, ...] = ()
    """Whole sections without a meaning here."""
    remarks: tuple[Remark, ...] = ()

    def action(self, name: str) -> Action | None:
        return next((a for a in self.actions if a.name == name), None)

    @property
    def timed(self) -> bool:
        return any(a.duration is not None for a in self.actions)


@dataclass(frozen=True)
class Metric:
    """What a good plan has little of, or much."""

    minimize: bool
    expression: Expression | Beyond
    at: Place = field(default=(1, 1), compare=False, repr=False)


@dataclass(frozen=True)
class Problem:
    """A problem's text, read."""

    name: str
    domain: str
    objects: tuple[tuple[str, tuple[str, ...]], ...]
    """Name and types; the domain's constants are not among them."""
    init: tuple[Fact, ...]
    goal: Condition
    values: tuple[tuple[Value, float], ...] = ()
    timed: tuple[tuple[float, Set], ...] = ()
    """Facts that become true or false at a time."""
    metric: Metric | None = None
    beyond: tuple[Beyond, ...] = ()
    remarks: tuple[Remark, ...] = ()


def parts_of(node: Condition | Effect | Expression) -> Iterator[Condition | Effect | Expression]:
    """A node and everything below it."""
    todo: list[Condition | Effect | Expression] = [node]
    while todo:
        yield (here := todo.pop())
        match here:
            case And() | Or() | All() | Arithmetic():
                todo += here.parts
            case Not() | Quantified():
                todo.append(here.part)
            case When():
                todo += (here.condition, here.effect)
            case Each():
                todo.append(here.effect)
            case Compare():
                todo += (here.left, here.right)
            case Change():
                todo += (here.target, here.amount)
            case _:
                pass
