"""Actions and durative actions: conditions and effects to `symbols.Operator`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from symskill_pddl.errors import alternatives
from symskill_pddl.pddl.lexer import Group, Node
from symskill_pddl.pddl.reader import Reader
from symskill_pddl.symbols import Absent, Atom, Domain, Operator, Parameter

T = TypeVar("T")


@dataclass
class _Conditions:
    """What a precondition collects."""

    pre: set[Atom] = field(default_factory=set)
    distinct: set[tuple[str, str]] = field(default_factory=set)
    absent: set[Absent] = field(default_factory=set)


@dataclass(frozen=True)
class ActionReader(Reader):
    """Adds actions to the shared grammar."""

    def operator(self, section: Group, domain: Domain) -> Operator:
        timed = section.head == ":durative-action"
        condition = ":condition" if timed else ":precondition"
        known = (":parameters", condition, ":effect", *((":duration",) if timed else ()))
        name, parts = self.word(section.items[1], "a name"), {}
        for i in range(2, len(section.items), 2):
            key = section.items[i]
            if str(key) not in known:
                raise self.error(key, f"an action has no '{key}'; supported are: {alternatives(known)}")
            if i + 1 == len(section.items):
                raise self.error(key, f"expected something after '{key}'")
            if str(key) in parts:
                raise self.error(key, f"'{key}' stands here a second time")
            parts[str(key)] = section.items[i + 1]
        for key in (":parameters", ":effect", *((":duration",) if timed else ())):
            if key not in parts:
                raise self.error(section, f"action '{name}' has no {key}")
        parameters = self.parameters(self.group(parts[":parameters"], "the parameters").items, domain)
        scope = {p.name: p.type for p in parameters}
        if timed:
            return self._durative(name, parameters, scope, parts, domain)
        conditions = _Conditions()
        if condition in parts:
            self._condition(parts[condition], domain, scope, conditions, ())
        add, delete, costs = set[Atom](), set[Atom](), list[float]()
        self._effect(parts[":effect"], domain, scope, add, delete, costs)
        return Operator(
            name,
            parameters,
            frozenset(conditions.pre),
            frozenset(add),
            frozenset(delete),
            absent=frozenset(conditions.absent),
            cost=sum(costs) if costs else 1.0,
            distinct=frozenset(conditions.distinct),
        )

    def _durative(
        self, name: str, parameters: tuple[Parameter, ...], scope: dict[str, str], parts: Mapping[str, Node], domain: Domain
    ) -> Operator:
        duration = self.group(parts[":duration"], "the duration")
        if len(duration.items) != 3 or [str(i) for i in duration.items[:2]] != ["=", "?duration"]:
            raise self.error(duration, f"expected (= ?duration NUMBER), got '{duration}'")
        cost = self.number(duration.items[2])
        start, over, end = _Conditions(), _Conditions(), _Conditions()
        for when, node in self._timed(parts.get(":condition"), {"start": start, "all": over, "end": end}):
            if when is end:
                raise self.unsupported(node, "conditions at end")
            self._condition(node, domain, scope, when, ())
        if over.absent:
            raise self.unsupported(parts[":condition"], "negative conditions over all")
        add, early, late = set[Atom](), set[Atom](), set[Atom]()
        for deleted, node in self._timed(parts[":effect"], {"start": early, "end": late}):
            before = set(add)
            self._effect(node, domain, scope, add, deleted, None)
            if deleted is early and add != before:
                raise self.unsupported(node, "add effects at start")
        maintain = frozenset(over.pre | late)
        return Operator(
            name,
            parameters,
            frozenset(start.pre),
            frozenset(add),
            frozenset(early | late),
            maintain,
            absent=frozenset(start.absent),
            cost=cost,
            distinct=frozenset(start.distinct),
        )

    def _timed(self, node: Node | None, whens: Mapping[str, T]) -> list[tuple[T, Node]]:
        """The parts of a durative action's condition or effect, each with what `whens` has for its time."""
        if node is None or not self.group(node, "a condition or effect").items:
            return []
        group = self.group(node, "a condition or effect")
        if group.head == "and":
            return [pair for item in group.items[1:] for pair in self._timed(item, whens)]
        when = str(group.items[1]) if len(group.items) == 3 else ""
        if (group.head, when) not in (("at", "start"), ("at", "end"), ("over", "all")) or when not in whens:
            allowed = " or ".join(f"({'over' if w == 'all' else 'at'} {w} ...)" for w in whens)
            raise self.error(group, f"expected {allowed}, got '{group}'")
        return [(whens[when], group.items[2])]

    def _condition(
        self, node: Node, domain: Domain, scope: Mapping[str, str], into: _Conditions, over: tuple[Parameter, ...]
    ) -> None:
        group = self.group(node, "a condition")
        if not group.items:
            return
        if group.head == "and":
            for item in group.items[1:]:
                self._condition(item, domain, scope, into, over)
        elif group.head == "forall":
            if len(group.items) != 3:
                raise self.error(group, "expected (forall (?x - type) (not (...)))")
            inner = self.parameters(self.group(group.items[1], "the variables").items, domain)
            self._condition(group.items[2], domain, {**scope, **{p.name: p.type for p in inner}}, into, (*over, *inner))
        elif group.head == "not":
            self._negative(group, domain, scope, into, over)
        elif over:
            raise self.error(group, f"under 'forall' only (not (...)) is supported, got '{group}'")
        else:
            into.pre.add(self.atom(group, domain, scope))

    def _negative(
        self, group: Group, domain: Domain, scope: Mapping[str, str], into: _Conditions, over: tuple[Parameter, ...]
    ) -> None:
        if len(group.items) != 2:
            raise self.error(group, "expected (not (...))")
        inner = self.group(group.items[1], "an atom")
        if inner.head == "=":
            if over:
                raise self.unsupported(inner, "inequalities under 'forall'")
            sides = [self.word(item, "a variable") for item in inner.items[1:]]
            if len(sides) != 2 or any(side not in scope for side in sides) or sides[0] == sides[1]:
                raise self.error(inner, f"expected (not (= ?a ?b)) of two parameters, got '{group}'")
            order = list(scope)
            into.distinct.add((min(sides, key=order.index), max(sides, key=order.index)))
            return
        into.absent.add(Absent(self.atom(inner, domain, scope), over))

    def _effect(
        self,
        node: Node,
        domain: Domain,
        scope: Mapping[str, str],
        add: set[Atom],
        delete: set[Atom],
        costs: list[float] | None,
    ) -> None:
        group = self.group(node, "an effect")
        if not group.items:
            return
        if group.head == "and":
            for item in group.items[1:]:
                self._effect(item, domain, scope, add, delete, costs)
        elif group.head == "not":
            if len(group.items) != 2:
                raise self.error(group, "expected (not (...))")
            delete.add(self.atom(self.group(group.items[1], "an atom"), domain, scope))
        elif group.head == "forall":
            raise self.unsupported(group, "universal effects")
        elif group.head == "increase":
            if costs is None:
                raise self.unsupported(group, "numeric effects of durative actions")
            if len(group.items) != 3 or str(group.items[1]) != "(total-cost)":
                raise self.error(group, f"the only numeric effect supported is (increase (total-cost) NUMBER), got '{group}'")
            costs.append(self.number(group.items[2]))
        else:
            add.add(self.atom(group, domain, scope))
