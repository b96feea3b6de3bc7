"""Conditions, effects and numbers of a PDDL text, to the tree of `syntax`."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from symskill_pddl.errors import ParseError
from symskill_pddl.pddl.lexer import Group, Node, Word
from symskill_pddl.pddl.reader import Reader, Scope
from symskill_pddl.pddl.syntax import (
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
    Vocabulary,
    When,
)

CHANGES = ("assign", "increase", "decrease", "scale-up", "scale-down")
COMPARISONS = ("<", "<=", "=", ">=", ">")
TRAJECTORIES = (
    *("always", "sometime", "within", "at-most-once", "sometime-after", "sometime-before", "always-within"),
    *("hold-during", "hold-after"),
)
BEYOND = {
    "preference": "preferences",
    "probabilistic": "probabilistic effects",
    **dict.fromkeys(TRAJECTORIES, "constraints on the way to the goal"),
}
WORDS = frozenset({"=", "forall", "exists", "not", "and", "or", "imply", "when", *CHANGES, *COMPARISONS, *BEYOND})
"""What a condition or effect may begin with, if no predicate is called like it."""


@dataclass(frozen=True)
class ConditionReader(Reader):
    """Reads with one vocabulary."""

    def condition(self, node: Node, vocabulary: Vocabulary, scope: Scope) -> Condition:
        group = self.group(node, "a condition")
        at, head = (group.line, group.column), group.head
        if not group.items:
            return And((), at)
        if head in vocabulary.predicates:  # many domains have a predicate `at`, some one called like a word of PDDL
            return Fact(self.atom(group, vocabulary, scope), at)

        def inner(item: Node) -> Condition:
            return self.condition(item, vocabulary, scope)

        if head == "and":
            return And(tuple(map(inner, group.items[1:])), at)
        if head == "or":
            return Or(tuple(map(inner, group.items[1:])), at)
        if head == "not":
            self.count(group, 2, "(not (...))")
            return Not(inner(group.items[1]), at)
        if head == "imply":
            self.count(group, 3, "(imply (...) (...))")
            return Or((Not(inner(group.items[1]), at), inner(group.items[2])), at)
        if head in ("forall", "exists"):
            self.count(group, 3, f"({head} (?x - type) (...))")
            variables, wider = self._bound(group, vocabulary, scope)
            return Quantified(head == "forall", variables, self.condition(group.items[2], vocabulary, wider), at)
        if head in COMPARISONS:
            return self.comparison(group, vocabulary, scope)
        if head in BEYOND:
            return self.beyond(group, BEYOND[head])
        if head in ("when", *CHANGES):
            raise self.error(group, f"'{head}' cannot stand in a condition")
        return Fact(self.atom(group, vocabulary, scope), at)

    def effect(self, node: Node, vocabulary: Vocabulary, scope: Scope) -> Effect:
        group = self.group(node, "an effect")
        at, head = (group.line, group.column), group.head
        if not group.items:
            return All()
        if head in vocabulary.predicates:
            return Set(self.atom(group, vocabulary, scope), True, at)
        if head == "and":
            return All(tuple(self.effect(item, vocabulary, scope) for item in group.items[1:]))
        if head == "not":
            self.count(group, 2, "(not (...))")
            return Set(self.atom(self.group(group.items[1], "an atom"), vocabulary, scope), False, at)
        if head == "when":
            self.count(group, 3, "(when (...) (...))")
            condition = self.condition(group.items[1], vocabulary, scope)
            return When(condition, self.effect(group.items[2], vocabulary, scope), at)
        if head == "forall":
            self.count(group, 3, "(forall (?x - type) (...))")
            variables, wider = self._bound(group, vocabulary, scope)
            return Each(variables, self.effect(group.items[2], vocabulary, wider), at)
        if head in CHANGES:
            return self._change(group, vocabulary, scope)
        if head in BEYOND:
            return self.beyond(group, BEYOND[head])
        if head in WORDS:
            raise self.error(group, f"'{head}' cannot stand in an effect")
        return Set(self.atom(group, vocabulary, scope), True, at)

    def timed(
        self, node: Node, vocabulary: Vocabulary, scope: Scope, whens: Collection[str], *, effects: bool
    ) -> list[tuple[str, Condition | Effect]]:
        """The parts of a durative action's condition or effect, each with its time, which is one of `whens`."""
        group = self.group(node, "a condition or effect")
        if not group.items:
            return []
        if group.head == "and":
            return [p for item in group.items[1:] for p in self.timed(item, vocabulary, scope, whens, effects=effects)]
        at = (group.line, group.column)
        if group.head == "forall" and len(group.items) == 3:
            variables, wider = self._bound(group, vocabulary, scope)
            parts = self.timed(group.items[2], vocabulary, wider, whens, effects=effects)
            return [(w, Each(variables, p, at) if effects else Quantified(True, variables, p, at)) for w, p in parts]  # type: ignore[arg-type]
        if group.head == "when" and len(group.items) == 3 and effects:
            return self._timed_when(group, vocabulary, scope, whens)
        if group.head in ("preference", "probabilistic") or (group.head in CHANGES and effects):
            return [("all", self.beyond(group, BEYOND.get(group.head, "continuous effects")))]
        when = str(group.items[1]) if len(group.items) == 3 else ""
        if (group.head, when) not in (("at", "start"), ("at", "end"), ("over", "all")) or when not in whens:
            allowed = " or ".join(f"({'over' if w == 'all' else 'at'} {w} ...)" for w in whens)
            raise self.error(group, f"expected {allowed}, got '{group}'")
        read = self.effect if effects else self.condition
        return [(when, read(group.items[2], vocabulary, scope))]

    def _timed_when(
        self, group: Group, vocabulary: Vocabulary, scope: Scope, whens: Collection[str]
    ) -> list[tuple[str, Condition | Effect]]:
        conditions = self.timed(group.items[1], vocabulary, scope, ("start", "all", "end"), effects=False)
        effects = self.timed(group.items[2], vocabulary, scope, whens, effects=True)
        if any(c != e for c, _ in conditions for e, _ in effects):
            return [("all", self.beyond(group, "conditional effects whose condition is at another time"))]
        needed = And(tuple(c for _, c in conditions))  # type: ignore[misc]
        return [(when, When(needed, e, (group.line, group.column))) for when, e in effects]  # type: ignore[arg-type]

    def comparison(self, group: Group, vocabulary: Vocabulary, scope: Scope) -> Same | Compare:
        self.count(group, 3, f"({group.head} a b)")
        at, sides = (group.line, group.column), group.items[1:]
        if group.head == "=" and all(isinstance(s, Word) and s.text in scope for s in sides):
            return Same(str(sides[0]), str(sides[1]), at)
        if group.head == "=" and all(isinstance(s, Word) and not _number(s.text) and s.text != "?duration" for s in sides):
            wrong = next(s for s in sides if str(s) not in scope)
            raise self.error(group, f"{group} names '{wrong}', which is no parameter or object here")
        left, right = (self.expression(side, vocabulary, scope) for side in sides)
        return Compare(group.head, left, right, at)

    def expression(self, node: Node, vocabulary: Vocabulary, scope: Scope) -> Expression:
        at = (node.line, node.column)
        if isinstance(node, Word):
            if (value := _number(node.text)) is not None:
                return Number(value[0])
            if node.text in ("?duration", "total-time") or node.text in vocabulary.functions:
                return Value(node.text, (), at)
            raise self.error(node, f"expected a number, got '{node}'")
        if node.head in ("+", "-", "*", "/") and len(node.items) >= 2:
            return Arithmetic(node.head, tuple(self.expression(item, vocabulary, scope) for item in node.items[1:]))
        return self.value(node, vocabulary, scope)

    def value(self, group: Group, vocabulary: Vocabulary, scope: Scope) -> Value:
        if not group.items:
            raise self.error(group, "expected a number, got '()'")
        name = self.word(group.items[0], "a function")
        if name == "total-time" and len(group.items) == 1:
            return Value(name, (), (group.line, group.column))
        if name == "total-cost" and name not in vocabulary.functions and len(group.items) == 1:
            self.remark(group, "(total-cost) is not declared", harmless=True)
            return Value(name, (), (group.line, group.column))
        if name not in vocabulary.functions:
            raise self.error(group, f"unknown function '{name}'; the domain has: {', '.join(vocabulary.functions) or 'none'}")
        args = tuple(self.word(item, "a name") for item in group.items[1:])
        self.arguments(group, args, vocabulary, vocabulary.functions[name], scope)
        return Value(name, args, (group.line, group.column))

    def _change(self, group: Group, vocabulary: Vocabulary, scope: Scope) -> Effect:
        self.count(group, 3, f"({group.head} (function ...) NUMBER)")
        if "#t" in str(group.items[2]).replace("(", " ").replace(")", " ").split():
            return self.beyond(group, "continuous effects")
        if isinstance(group.items[1], Word) and group.items[1].text in vocabulary.functions:
            target = Value(group.items[1].text, (), (group.line, group.column))
        else:
            where = self.group(group.items[1], "a function")
            if where.head == "reward" and "reward" not in vocabulary.functions:
                return self.beyond(group, "rewards")
            target = self.value(where, vocabulary, scope)
        return Change(group.head, target, self.expression(group.items[2], vocabulary, scope), (group.line, group.column))

    def _bound(self, group: Group, vocabulary: Vocabulary, scope: Scope) -> tuple[tuple[Variable, ...], Scope]:
        variables = self.variables(self.group(group.items[1], "the variables").items, vocabulary.types)
        return variables, {**scope, **{v.name: v.types for v in variables}}

    def count(self, group: Group, items: int, expected: str) -> None:
        if len(group.items) != items:
            raise self.error(group, f"expected {expected}, got '{group}'")

    def unsupported(self, part: Beyond) -> ParseError:
        return ParseError(f"{part.what} are not supported", source=self.source, line=part.at[0], column=part.at[1])


def _number(text: str) -> tuple[float] | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return (value,) if value - value == 0.0 else None
