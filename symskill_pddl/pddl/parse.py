"""PDDL text to symbols, for the fragment that this package writes and a little around it.

Understood: typing, negative preconditions (plain and under `forall`), inequalities, action costs that are numbers, durative actions with
a constant duration. Everything else of PDDL is named in the error, with line and column, and not skipped. Operators bind distinct
parameters to distinct objects, so inequalities between parameters are implied and dropped.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from symskill_pddl.errors import InputError, ParseError, alternatives
from symskill_pddl.pddl.lexer import Group, Node, Word, read_groups
from symskill_pddl.symbols import (
    ROOT_TYPE,
    Absent,
    Atom,
    Domain,
    Operator,
    Parameter,
    Predicate,
    Problem,
    Type,
    check_atom,
)

T = TypeVar("T")
_REQUIREMENTS = frozenset(
    ":strips :typing :negative-preconditions :universal-preconditions :quantified-preconditions :equality :action-costs :adl "
    ":durative-actions".split()
)
_UNSUPPORTED = {
    "or": "disjunctive conditions",
    "imply": "implications",
    "exists": "existential conditions",
    "when": "conditional effects",
    "preference": "preferences",
    "decrease": "numeric effects",
    "assign": "numeric effects",
    "<": "numeric conditions",
    ">": "numeric conditions",
    "<=": "numeric conditions",
    ">=": "numeric conditions",
    "either": "'either' types",
    ":constants": "constants",
    ":derived": "derived predicates",
    ":axiom": "axioms",
    ":constraints": "constraints",
    ":process": "processes",
    ":event": "events",
}


def read_domain(text: str, source: str = "<domain>") -> Domain:
    """Parse a domain.

    Raises
    ------
    ParseError
        With line and column: the grammar is broken, a name is unknown or declared twice, or a feature is not supported.
    """
    return _Reader(source).domain(text)


def read_problem(text: str, domain: Domain, source: str = "<problem>") -> Problem:
    """Parse a problem of a domain that was read before; raises `ParseError` like `read_domain`."""
    return _Reader(source).problem(text, domain)


def read_atoms(text: str, domain: Domain, objects: Mapping[str, str], source: str = "<goal>") -> frozenset[Atom]:
    """Parse ``(p a b) (q c)`` or ``(and (p a b) (q c))``: ground atoms over `objects` (name to type).

    Raises
    ------
    ParseError
        With line and column: not a list of atoms, or an unknown predicate or object, wrong arity, wrong type.
    """
    reader = _Reader(source)
    atoms: set[Atom] = set()
    for node in read_groups(text, source):
        atoms |= reader.ground_atoms(node, domain, objects)
    if not atoms:
        raise ParseError("expected at least one atom, like '(predicate object)'", source=source, line=1, column=1)
    return frozenset(atoms)


@dataclass
class _Conditions:
    """What a precondition collects."""

    pre: set[Atom] = field(default_factory=set)
    absent: set[Absent] = field(default_factory=set)


@dataclass(frozen=True)
class _Reader:
    source: str

    def error(self, node: Node, message: str) -> ParseError:
        return ParseError(message, source=self.source, line=node.line, column=node.column)

    def unsupported(self, node: Node, what: str) -> ParseError:
        return self.error(node, f"{what} are not supported")

    def group(self, node: Node, what: str) -> Group:
        if isinstance(node, Word):
            raise self.error(node, f"expected {what} in parentheses, got '{node}'")
        return node

    def word(self, node: Node, what: str) -> str:
        if isinstance(node, Group):
            raise self.error(node, f"expected {what}, got '('")
        return node.text

    # ---- domain

    def domain(self, text: str) -> Domain:
        name, sections = self._define(text, "domain")
        types: list[Type] = []
        predicates: list[Predicate] = []
        for section in self._find(sections, ":requirements"):
            for item in section.items[1:]:
                if self.word(item, "a requirement") not in _REQUIREMENTS:
                    raise self.error(
                        item, f"the requirement '{item}' is not supported; supported are: {alternatives(_REQUIREMENTS)}"
                    )
        for section in self._find(sections, ":types"):
            listed = self._typed(section.items[1:], "a type")
            known = {ROOT_TYPE, *(word.text for word, _ in listed)}
            for word, parent in listed:
                self._new(word, "type", (t.name for t in types))
                if word.text == ROOT_TYPE:
                    continue  # some write it out; it exists anyway
                if parent.text not in known:
                    raise self.error(parent, f"type '{word}' has the unknown parent '{parent}'; declared: {alternatives(known)}")
                types.append(Type(word.text, parent.text))
        skeleton = Domain(name, tuple(types), (), ())
        for section in self._find(sections, ":predicates"):
            for node in section.items[1:]:
                group = self.group(node, "a predicate")
                if not group.items:
                    raise self.error(group, "expected a predicate's name, got '()'")
                head = self.word(group.items[0], "a predicate's name")
                self._new(group.items[0], "predicate", (p.name for p in predicates))
                parameters = self._parameters(group.items[1:], skeleton)
                predicates.append(Predicate(head, tuple(p.type for p in parameters)))
        skeleton = Domain(name, tuple(types), tuple(predicates), ())
        for section in self._find(sections, ":functions"):
            for node in section.items[1:]:
                if str(node) not in ("(total-cost)", "-", "number"):
                    raise self.error(node, f"the only function supported is (total-cost), got '{node}'")
        operators: list[Operator] = []
        for section in sections:
            if section.head in (":action", ":durative-action"):
                if len(section.items) < 2:
                    raise self.error(section, "expected the action's name")
                self.word(section.items[1], "the action's name")
                self._new(section.items[1], "action", (o.name for o in operators))
                operators.append(self._operator(section, skeleton))
        return Domain(name, tuple(types), tuple(predicates), tuple(operators))

    def _define(self, text: str, what: str) -> tuple[str, tuple[Group, ...]]:
        nodes = read_groups(text, self.source)
        expected = f"(define ({what} NAME) ...)"
        if not nodes:
            raise ParseError(f"the text is empty, expected {expected}", source=self.source, line=1, column=1)
        if len(nodes) > 1:
            raise self.error(nodes[1], f"expected one {expected}, here starts something after it")
        outer = self.group(nodes[0], expected)
        if outer.head != "define" or len(outer.items) < 2:
            raise self.error(outer, f"expected {expected}")
        title = self.group(outer.items[1], f"({what} NAME)")
        if title.head != what or len(title.items) != 2:
            raise self.error(title, f"expected ({what} NAME), got '{title}'")
        sections = tuple(self.group(node, "a section") for node in outer.items[2:])
        known = {
            "domain": (":requirements", ":types", ":predicates", ":functions", ":action", ":durative-action"),
            "problem": (":domain", ":objects", ":init", ":goal", ":metric", ":requirements"),
        }[what]
        for section in sections:
            if section.head in _UNSUPPORTED:
                raise self.unsupported(section, _UNSUPPORTED[section.head])
            if section.head not in known:
                raise self.error(section, f"a {what} has no section '{section.head}'; supported are: {alternatives(known)}")
        return self.word(title.items[1], f"the {what}'s name"), sections

    def _find(self, sections: Iterable[Group], head: str) -> tuple[Group, ...]:
        found = tuple(s for s in sections if s.head == head)
        if len(found) > 1:
            raise self.error(found[1], f"the section '{head}' stands here a second time")
        return found

    def _new(self, node: Node, what: str, names: Iterable[str]) -> None:
        if str(node) in set(names):
            raise self.error(node, f"{what} '{node}' is declared a second time")

    def _typed(self, items: tuple[Node, ...], what: str) -> list[tuple[Word, Word]]:
        """``a b - t c`` as pairs of name and type."""
        pairs: list[tuple[Word, Word]] = []
        waiting: list[Word] = []
        rest = list(items)
        while rest:
            node = rest.pop(0)
            if isinstance(node, Group):
                raise self.error(node, f"expected {what}, got '{node}'")
            if node.text != "-":
                waiting.append(node)
                continue
            if not waiting:
                raise self.error(node, f"expected {what} before '-'")
            if not rest:
                raise self.error(node, "expected a type after '-'")
            kind = rest.pop(0)
            if isinstance(kind, Group):
                raise (
                    self.unsupported(kind, _UNSUPPORTED["either"])
                    if kind.head == "either"
                    else self.error(kind, "expected a type")
                )
            pairs += [(name, kind) for name in waiting]
            waiting = []
        return pairs + [(name, Word(ROOT_TYPE, name.line, name.column)) for name in waiting]

    def _parameters(self, items: tuple[Node, ...], domain: Domain) -> tuple[Parameter, ...]:
        found: list[Parameter] = []
        for word, kind in self._typed(items, "a variable"):
            if not word.text.startswith("?") or word.text == "?":
                raise self.error(word, f"expected a variable like '?x', got '{word}'")
            self._known_type(kind, domain)
            self._new(word, "variable", (p.name for p in found))
            found.append(Parameter(word.text, kind.text))
        return tuple(found)

    def _known_type(self, kind: Word, domain: Domain) -> None:
        known = {ROOT_TYPE, *(t.name for t in domain.types)}
        if kind.text not in known:
            raise self.error(kind, f"unknown type '{kind}'; declared: {alternatives(known)}")

    # ---- actions

    def _operator(self, section: Group, domain: Domain) -> Operator:
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
        parameters = self._parameters(self.group(parts[":parameters"], "the parameters").items, domain)
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
        )

    def _durative(
        self, name: str, parameters: tuple[Parameter, ...], scope: dict[str, str], parts: Mapping[str, Node], domain: Domain
    ) -> Operator:
        duration = self.group(parts[":duration"], "the duration")
        if len(duration.items) != 3 or [str(i) for i in duration.items[:2]] != ["=", "?duration"]:
            raise self.error(duration, f"expected (= ?duration NUMBER), got '{duration}'")
        cost = self._number(duration.items[2])
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
            inner = self._parameters(self.group(group.items[1], "the variables").items, domain)
            self._condition(group.items[2], domain, {**scope, **{p.name: p.type for p in inner}}, into, (*over, *inner))
        elif group.head == "not":
            self._negative(group, domain, scope, into, over)
        elif over:
            raise self.error(group, f"under 'forall' only (not (...)) is supported, got '{group}'")
        else:
            into.pre.add(self._atom(group, domain, scope))

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
            return
        into.absent.add(Absent(self._atom(inner, domain, scope), over))

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
            delete.add(self._atom(self.group(group.items[1], "an atom"), domain, scope))
        elif group.head == "forall":
            raise self.unsupported(group, "universal effects")
        elif group.head == "increase" and costs is not None:
            if len(group.items) != 3 or str(group.items[1]) != "(total-cost)":
                raise self.error(group, f"the only numeric effect supported is (increase (total-cost) NUMBER), got '{group}'")
            costs.append(self._number(group.items[2]))
        else:
            add.add(self._atom(group, domain, scope))

    def _number(self, node: Node) -> float:
        try:
            value = float(self.word(node, "a number"))
        except ValueError:
            raise self.error(node, f"expected a number, got '{node}'") from None
        if not 0.0 <= value < float("inf"):
            raise self.error(node, f"a cost or duration is not negative and finite, got '{node}'")
        return value

    def _atom(self, group: Group, domain: Domain, scope: Mapping[str, str]) -> Atom:
        if group.head in _UNSUPPORTED:
            raise self.unsupported(group, _UNSUPPORTED[group.head])
        if group.head in ("=", "forall", "not", "and", "at", "over", "increase"):
            raise self.error(group, f"'{group.head}' cannot stand here, expected an atom")
        if not group.items:
            raise self.error(group, "expected an atom, got '()'")
        atom = Atom(self.word(group.items[0], "a predicate"), tuple(self.word(item, "a name") for item in group.items[1:]))
        try:
            check_atom(domain, atom, scope, "here")
        except InputError as error:
            raise self.error(group, str(error).removeprefix("here: ")) from None
        return atom

    # ---- problem

    def ground_atoms(self, node: Node, domain: Domain, objects: Mapping[str, str]) -> frozenset[Atom]:
        group = self.group(node, "an atom")
        if group.head == "and" or not group.items:
            return frozenset(a for item in group.items[1:] for a in self.ground_atoms(item, domain, objects))
        if group.head in ("not", "forall"):
            raise self.unsupported(group, "negative goals and initial facts")
        return frozenset({self._atom(group, domain, objects)})

    def problem(self, text: str, domain: Domain) -> Problem:
        name, sections = self._define(text, "problem")
        for section in self._find(sections, ":domain"):
            if len(section.items) != 2 or str(section.items[1]) != domain.name:
                raise self.error(section, f"the problem is of the domain '{section.items[-1]}', not of '{domain.name}'")
        objects: dict[str, str] = {}
        for section in self._find(sections, ":objects"):
            for word, kind in self._typed(section.items[1:], "an object"):
                self._known_type(kind, domain)
                self._new(word, "object", objects)
                if word.text.startswith("?"):
                    raise self.error(word, f"an object's name does not start with '?': '{word}'")
                objects[word.text] = kind.text
        init: set[Atom] = set()
        for section in self._find(sections, ":init"):
            for item in section.items[1:]:
                if isinstance(item, Group) and item.head == "=" and str(item.items[1]) == "(total-cost)":
                    continue
                init |= self.ground_atoms(item, domain, objects)
        goals = self._find(sections, ":goal")
        if not goals or len(goals[0].items) != 2:
            raise self.error(goals[0] if goals else Word("", 1, 1), "expected one (:goal (and ...))")
        goal = self.ground_atoms(goals[0].items[1], domain, objects)
        return Problem(name, domain.name, tuple(objects.items()), frozenset(init), goal)
