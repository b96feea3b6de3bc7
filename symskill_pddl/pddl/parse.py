"""PDDL text to symbols, for the fragment that this package writes and a little around it.

Understood: typing, negative preconditions (plain and under `forall`), inequalities, action costs that are numbers, durative
actions with a constant duration. Everything else of PDDL is named in the error, with line and column, and not skipped. Operators
bind distinct parameters to distinct objects, so inequalities between parameters are implied and dropped.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from symskill_pddl.errors import ParseError, alternatives
from symskill_pddl.pddl.actions import ActionReader
from symskill_pddl.pddl.lexer import Group, Node, Word, read_groups
from symskill_pddl.pddl.reader import UNSUPPORTED
from symskill_pddl.symbols import ROOT_TYPE, Atom, Domain, Operator, Predicate, Problem, Type

_REQUIREMENTS = frozenset(
    {
        ":strips",
        ":typing",
        ":negative-preconditions",
        ":universal-preconditions",
        ":quantified-preconditions",
        ":equality",
        ":action-costs",
        ":adl",
        ":durative-actions",
    }
)


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


@dataclass(frozen=True)
class _Reader(ActionReader):
    """Adds the sections of the two files."""

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
            listed = self.typed(section.items[1:], "a type")
            known = {ROOT_TYPE, *(word.text for word, _ in listed)}
            for word, parent in listed:
                self.new(word, "type", (t.name for t in types))
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
                self.new(group.items[0], "predicate", (p.name for p in predicates))
                parameters = self.parameters(group.items[1:], skeleton)
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
                self.new(section.items[1], "action", (o.name for o in operators))
                operators.append(self.operator(section, skeleton))
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
            if section.head in UNSUPPORTED:
                raise self.unsupported(section, UNSUPPORTED[section.head])
            if section.head not in known:
                raise self.error(section, f"a {what} has no section '{section.head}'; supported are: {alternatives(known)}")
        return self.word(title.items[1], f"the {what}'s name"), sections

    def _find(self, sections: Iterable[Group], head: str) -> tuple[Group, ...]:
        found = tuple(s for s in sections if s.head == head)
        if len(found) > 1:
            raise self.error(found[1], f"the section '{head}' stands here a second time")
        return found

    def ground_atoms(self, node: Node, domain: Domain, objects: Mapping[str, str]) -> frozenset[Atom]:
        group = self.group(node, "an atom")
        if group.head == "and" or not group.items:
            return frozenset(a for item in group.items[1:] for a in self.ground_atoms(item, domain, objects))
        if group.head in ("not", "forall"):
            raise self.unsupported(group, "negative goals and initial facts")
        return frozenset({self.atom(group, domain, objects)})

    def problem(self, text: str, domain: Domain) -> Problem:
        name, sections = self._define(text, "problem")
        for section in self._find(sections, ":domain"):
            if len(section.items) != 2 or str(section.items[1]) != domain.name:
                raise self.error(section, f"the problem is of the domain '{section.items[-1]}', not of '{domain.name}'")
        objects: dict[str, str] = {}
        for section in self._find(sections, ":objects"):
            for word, kind in self.typed(section.items[1:], "an object"):
                self.known_type(kind, domain)
                self.new(word, "object", objects)
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
