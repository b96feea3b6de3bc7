"""The two files of a PDDL task, to the tree of `syntax`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from symskill_pddl.errors import ParseError, alternatives
from symskill_pddl.pddl.conditions import ConditionReader
from symskill_pddl.pddl.lexer import Group, Node, Word, read_groups
from symskill_pddl.pddl.reader import Kinds, Scope
from symskill_pddl.pddl.syntax import (
    Action,
    And,
    Beyond,
    Compare,
    Condition,
    Domain,
    Effect,
    Fact,
    Metric,
    Not,
    Problem,
    Remark,
    Rule,
    Set,
    Value,
    Vocabulary,
)
from symskill_pddl.symbols import ROOT_TYPE, Atom

REQUIREMENTS = frozenset(
    {
        *(":strips", ":typing", ":equality", ":adl", ":negative-preconditions", ":disjunctive-preconditions"),
        *(":existential-preconditions", ":universal-preconditions", ":quantified-preconditions", ":conditional-effects"),
        *(":universal-effects", ":domain-axioms", ":derived-predicates", ":action-costs", ":goal-utilities"),
        *(":fluents", ":numeric-fluents", ":object-fluents", ":durative-actions", ":durative-inequalities"),
        *(":duration-inequalities", ":continuous-effects", ":timed-initial-literals", ":timed-initial-fluents"),
        *(":preferences", ":constraints", ":time", ":probabilistic-effects", ":rewards", ":mdp", ":multi-agent"),
    }
)
_BEYOND = {":constraints": "constraints", ":process": "processes", ":event": "events", ":axiom": "axioms", ":length": "lengths"}
_ACTIONS = (":action", ":durative-action")
_KNOWN = {
    "domain": (":requirements", ":types", ":constants", ":predicates", ":functions", ":derived", *_ACTIONS),
    "problem": (":domain", ":requirements", ":objects", ":init", ":goal", ":metric"),
}


@dataclass(frozen=True)
class FileReader(ConditionReader):
    """Adds the sections."""

    def domain(self, text: str) -> Domain:
        name, sections = self._define(text, "domain")
        requirements = tuple(
            self._requirement(item) for section in self._find(sections, ":requirements") for item in section.items[1:]
        )
        types = self._types(self._find(sections, ":types"))
        constants: dict[str, Kinds] = {}
        for section in self._find(sections, ":constants"):
            self._objects(section.items[1:], types, constants)
        predicates = self._predicates(self._find(sections, ":predicates"), types)
        functions: dict[str, tuple[Kinds, ...]] = {}
        beyond = [self.beyond(s, _BEYOND[s.head]) for s in sections if s.head in _BEYOND and s.head != ":length"]
        for section in self._find(sections, ":functions"):
            beyond += self._functions(section, types, functions)
        vocabulary = Vocabulary(types, tuple(constants.items()), predicates, functions)
        actions: list[Action] = []
        for section in (s for s in sections if s.head in _ACTIONS):
            if len(section.items) < 2:
                raise self.error(section, "expected the action's name")
            self.word(section.items[1], "the action's name")
            self.new(section.items[1], "action", (a.name for a in actions))
            actions.append(self._action(section, vocabulary))
        rules = tuple(self._rule(s, vocabulary) for s in sections if s.head == ":derived")
        return Domain(name, vocabulary, tuple(actions), rules, requirements, tuple(beyond), tuple(self.remarks))

    def problem(self, text: str, domain: str, vocabulary: Vocabulary) -> Problem:
        name, sections = self._define(text, "problem")
        named = domain
        for section in self._find(sections, ":domain"):
            named = str(section.items[-1])
            if len(section.items) != 2 or named != domain:
                self.remark(section, f"the problem is of the domain '{named}', not of '{domain}'")
        for section in self._find(sections, ":requirements"):
            for item in section.items[1:]:
                self._requirement(item)
        scope: dict[str, Kinds] = dict(vocabulary.constants)
        for section in self._find(sections, ":objects"):
            self._objects(section.items[1:], vocabulary.types, scope)
        init: list[Fact] = []
        values: list[tuple[Value, float]] = []
        timed: list[tuple[float, Set]] = []
        beyond = [self.beyond(s, _BEYOND[s.head]) for s in sections if s.head in _BEYOND and s.head != ":length"]
        for section in self._find(sections, ":init"):
            for item in section.items[1:]:
                self._fact(self.group(item, "an atom"), vocabulary, scope, init, values, timed, beyond)
        goals = self._find_goal(sections)
        constants = dict(vocabulary.constants)
        return Problem(
            name,
            named,
            tuple((o, kinds) for o, kinds in scope.items() if o not in constants),
            tuple(init),
            self.condition(goals, vocabulary, scope),
            tuple(values),
            tuple(timed),
            self._metric(sections, vocabulary, scope),
            tuple(beyond),
            tuple(self.remarks),
        )

    def _requirement(self, item: Node) -> str:
        word = self.word(item, "a requirement")
        if word not in REQUIREMENTS:
            self.remark(item, f"the requirement '{item}' is not known; known are: {alternatives(REQUIREMENTS)}", harmless=True)
        return word

    def _types(self, sections: Sequence[Group]) -> dict[str, Kinds]:
        found: dict[str, Kinds] = {}
        places: dict[str, Word] = {}
        for section in sections:
            listed = self.typed(section.items[1:], "a type")
            known = {ROOT_TYPE, *(word.text for word, _ in listed)}
            for word, parents in listed:
                if word.text == ROOT_TYPE:
                    continue  # some write it out; it exists anyway
                if word.text in found:
                    self.remark(word, f"type '{word}' is declared a second time")
                for parent in parents:
                    if parent.text not in known:
                        self.remark(parent, f"type '{word}' has the unknown parent '{parent}'; declared: {alternatives(known)}")
                        found.setdefault(parent.text, (ROOT_TYPE,))
                names = tuple(p.text for p in parents)
                before = tuple(p for p in found.get(word.text, ()) if p != ROOT_TYPE)
                found[word.text] = tuple(dict.fromkeys((*before, *names)))
                places[word.text] = word
        if cycle := _cycle(found):
            raise self.error(places[cycle[0]], f"the type '{cycle[0]}' is below itself: {' - '.join(cycle)}")
        return found

    def _objects(self, items: tuple[Node, ...], types: Mapping[str, Kinds], into: dict[str, Kinds]) -> None:
        declared = set[str]()
        for word, kinds in self.typed(items, "an object"):
            known = self.known_types(kinds, types)
            if word.text.startswith("?"):
                raise self.error(word, f"an object's name does not start with '?': '{word}'")
            if word.text in into:
                if word.text in declared and into[word.text] != known:
                    self.new(word, "object", into)
                self.remark(word, f"object '{word}' is declared a second time")
            declared.add(word.text)
            into[word.text] = known

    def _predicates(self, sections: Sequence[Group], types: Mapping[str, Kinds]) -> dict[str, tuple[Kinds, ...]]:
        found: dict[str, tuple[Kinds, ...]] = {}
        for node in (item for section in sections for item in section.items[1:]):
            group = self.group(node, "a predicate")
            if not group.items:
                raise self.error(group, "expected a predicate's name, got '()'")
            head = self.word(group.items[0], "a predicate's name")
            self.new(group.items[0], "predicate", found)
            if head == "=":  # some declare it, though it needs no declaration
                self.remark(group, "'=' needs no declaration", harmless=True)
                continue
            found[head] = tuple(v.types for v in self.variables(group.items[1:], types))
        return found

    def _functions(self, section: Group, types: Mapping[str, Kinds], into: dict[str, tuple[Kinds, ...]]) -> list[Beyond]:
        """``(f ?x - t) (g) - number``; functions whose values are objects are beyond."""
        beyond, items = [], list(section.items[1:])
        while items:
            node = items.pop(0)
            group = self.group(node, "a function")
            if not group.items:
                raise self.error(group, "expected a function's name, got '()'")
            head = self.word(group.items[0], "a function's name")
            self.new(group.items[0], "function", into)
            into[head] = tuple(v.types for v in self.variables(group.items[1:], types))
            if items and isinstance(items[0], Word) and items[0].text.startswith("-"):
                dash = items.pop(0)
                kind = dash.text[1:] if str(dash) != "-" else str(items.pop(0)) if items else ""  # type: ignore[union-attr]
                if not kind:
                    raise self.error(dash, "expected a type after '-'")
                if kind != "number":
                    beyond.append(self.beyond(group, "functions whose values are objects"))
        return beyond

    def _parts(self, section: Group, known: Sequence[str]) -> dict[str, Node]:
        parts: dict[str, Node] = {}
        for i in range(2, len(section.items), 2):
            key = section.items[i]
            if str(key) not in known:
                raise self.error(key, f"an action has no '{key}'; supported are: {alternatives(known)}")
            if i + 1 == len(section.items):
                raise self.error(key, f"expected something after '{key}'")
            if str(key) in parts:
                raise self.error(key, f"'{key}' stands here a second time")
            parts[str(key)] = section.items[i + 1]
        return parts

    def _action(self, section: Group, vocabulary: Vocabulary) -> Action:
        timed = section.head == ":durative-action"
        condition = ":condition" if timed else ":precondition"
        name = self.word(section.items[1], "the action's name")
        parts = self._parts(section, (":parameters", condition, ":effect", *((":duration",) if timed else ())))
        if timed and ":duration" not in parts:
            raise self.error(section, f"action '{name}' has no :duration")
        if ":effect" not in parts:
            raise self.error(section, f"action '{name}' has no :effect")
        listed = parts.get(":parameters", Group((), section.line, section.column))
        parameters = self.variables(self.group(listed, "the parameters").items, vocabulary.types)
        scope: Scope = {**dict(vocabulary.constants), **{p.name: p.types for p in parameters}}
        at = (section.line, section.column)
        if timed:
            conditions = parts.get(condition)
            needed = self.timed(conditions, vocabulary, scope, ("start", "all", "end"), effects=False) if conditions else []
            done = self.timed(parts[":effect"], vocabulary, scope, ("start", "end"), effects=True)
            duration = self._duration(parts[":duration"], vocabulary, scope)
            return Action(name, parameters, tuple(needed), tuple(done), duration, at)  # type: ignore[arg-type]
        before: tuple[tuple[str, Condition], ...] = ()
        if condition in parts:
            before = (("now", self.condition(parts[condition], vocabulary, scope)),)
        after: tuple[tuple[str, Effect], ...] = (("now", self.effect(parts[":effect"], vocabulary, scope)),)
        return Action(name, parameters, before, after, None, at)

    def _duration(self, node: Node, vocabulary: Vocabulary, scope: Scope) -> tuple[Compare, ...]:
        group = self.group(node, "the duration")
        if not group.items:
            return ()
        if group.head == "and":
            return tuple(c for item in group.items[1:] for c in self._duration(item, vocabulary, scope))
        if group.head == "at" and len(group.items) == 3:
            return self._duration(group.items[2], vocabulary, scope)
        if group.head not in ("=", "<=", ">=", "<", ">") or len(group.items) != 3 or str(group.items[1]) != "?duration":
            raise self.error(group, f"expected (= ?duration NUMBER), got '{group}'")
        left, right = (self.expression(item, vocabulary, scope) for item in group.items[1:])
        return (Compare(group.head, left, right, (group.line, group.column)),)

    def _rule(self, section: Group, vocabulary: Vocabulary) -> Rule:
        self.count(section, 3, "(:derived (predicate ?x - type) (...))")
        head = self.group(section.items[1], "an atom")
        name = self.word(head.items[0], "a predicate") if head.items else ""
        if name not in vocabulary.predicates:
            raise self.error(head, f"unknown predicate '{name}'; the domain has: {alternatives(vocabulary.predicates)}")
        parameters = self.variables(head.items[1:], vocabulary.types)
        declared = vocabulary.predicates[name]
        if len(parameters) != len(declared):
            raise self.error(head, f"'{name}' takes {len(declared)} arguments, got {len(parameters)}: {head}")
        at = (section.line, section.column)
        narrow = tuple(
            v if v.types != (ROOT_TYPE,) else type(v)(v.name, kinds, v.at) for v, kinds in zip(parameters, declared, strict=True)
        )
        scope: Scope = {**dict(vocabulary.constants), **{v.name: v.types for v in narrow}}
        return Rule(name, narrow, self.condition(section.items[2], vocabulary, scope), at)

    def _fact(
        self,
        group: Group,
        vocabulary: Vocabulary,
        scope: Scope,
        init: list[Fact],
        values: list[tuple[Value, float]],
        timed: list[tuple[float, Set]],
        beyond: list[Beyond],
    ) -> None:
        at = (group.line, group.column)
        if group.head in vocabulary.predicates and not self._clock(group):
            init.append(Fact(self.atom(group, vocabulary, scope), at))
        elif group.head == "=":
            self.count(group, 3, "(= (function ...) NUMBER)")
            try:
                value = float(self.word(group.items[2], "a number"))
            except (ValueError, ParseError):
                if isinstance(group.items[2], Word) and group.items[2].text in scope:
                    beyond.append(self.beyond(group, "functions whose values are objects"))
                    return
                raise self.error(group.items[2], f"expected a number, got '{group.items[2]}'") from None
            first = group.items[1]
            where = first if isinstance(first, Group) else Group((first,), first.line, first.column)
            values.append((self.value(where, vocabulary, scope), value))
        elif self._clock(group):
            self.count(group, 3, "(at TIME (...))")
            effect = self.effect(group.items[2], vocabulary, scope)
            if isinstance(effect, Set):
                timed.append((float(str(group.items[1])), effect))
            else:
                beyond.append(self.beyond(group, "numbers that change at a time"))
        elif group.head == "not":
            self.count(group, 2, "(not (...))")
            denied = self.atom(self.group(group.items[1], "an atom"), vocabulary, scope)  # it does not hold anyway
            self.remark(group, "a negative initial fact says what leaving it out says", harmless=True)
            init[:] = [fact for fact in init if fact.atom != denied]
        elif group.head == "and" or not group.items:
            for item in group.items[1:]:
                self._fact(self.group(item, "an atom"), vocabulary, scope, init, values, timed, beyond)
        elif group.head == "probabilistic":
            beyond.append(self.beyond(group, "probabilistic initial facts"))
        else:
            init.append(Fact(self.atom(group, vocabulary, scope), at))

    def _clock(self, group: Group) -> bool:
        """Whether it is ``(at 5 (...))``."""
        if group.head != "at" or len(group.items) < 2 or not isinstance(group.items[1], Word):
            return False
        return len(group.items) == 3 and isinstance(group.items[2], Group)

    def _find_goal(self, sections: tuple[Group, ...]) -> Node:
        goals = tuple(s for s in sections if s.head == ":goal")
        if len(goals) != 1 or len(goals[0].items) != 2:
            raise self.error(goals[-1] if goals else Word("", 1, 1), "expected one (:goal (and ...))")
        return goals[0].items[1]

    def _metric(self, sections: tuple[Group, ...], vocabulary: Vocabulary, scope: Scope) -> Metric | None:
        for section in self._find(sections, ":metric"):
            at = (section.line, section.column)
            if len(section.items) != 3 or str(section.items[1]) not in ("minimize", "maximize"):
                raise self.error(section, f"expected (:metric minimize (...)), got '{section}'")
            what = section.items[2]
            minimize = str(section.items[1]) == "minimize"
            if "is-violated" in str(what) or str(what) in ("(reward)", "reward"):
                return Metric(minimize, self.beyond(what, "preferences or rewards in a metric"), at)
            return Metric(minimize, self.expression(what, vocabulary, scope), at)
        return None

    def _define(self, text: str, what: str) -> tuple[str, tuple[Group, ...]]:
        unclosed: list[Word] = []
        nodes = read_groups(text, self.source, unclosed)
        for opening in unclosed:
            self.remarks.append(Remark("this '(' is never closed", (opening.line, opening.column), broken=True))
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
        for section in sections:
            if section.head not in _KNOWN[what] and section.head not in _BEYOND:
                raise self.error(
                    section, f"a {what} has no section '{section.head}'; supported are: {alternatives(_KNOWN[what])}"
                )
        return self.word(title.items[1], f"the {what}'s name"), sections

    def _find(self, sections: Iterable[Group], head: str) -> tuple[Group, ...]:
        found = tuple(s for s in sections if s.head == head)
        if len(found) > 1:
            raise self.error(found[1], f"the section '{head}' stands here a second time")
        return found


def _cycle(parents: Mapping[str, Kinds]) -> list[str]:
    """The way from the first type that is below itself back to it, or nothing; every type is looked at once."""
    done = set[str]()
    for first in parents:
        way = {first: None}  # in order, and quickly asked
        open_ways = [iter(parents[first])] if first not in done else []
        while open_ways:
            above = next(open_ways[-1], None)
            if above is None:
                open_ways.pop()
                done.add(way.popitem()[0])
            elif above in way:
                names = list(way)
                return [*names[names.index(above) :], above]
            elif above not in done:
                way[above] = None
                open_ways.append(iter(parents.get(above, ())))
    return []


def read_atom_list(text: str, vocabulary: Vocabulary, scope: Scope, source: str) -> tuple[Atom, ...]:
    """Ground atoms, one after another or in an ``and``; see `parse.read_atoms`."""
    reader, atoms = FileReader(source), list[Atom]()

    def gather(condition: Condition) -> None:
        if isinstance(condition, And):
            for part in condition.parts:
                gather(part)
        elif isinstance(condition, Fact):
            atoms.append(condition.atom)
        else:
            what = "negative goals and initial facts" if isinstance(condition, Not) else "disjunctions and the like in a list"
            raise reader.unsupported(Beyond(what, str(condition), condition.at))

    for node in read_groups(text, source):
        gather(reader.condition(reader.group(node, "an atom"), vocabulary, scope))
    if not atoms:
        raise ParseError("expected at least one atom, like '(predicate object)'", source=source, line=1, column=1)
    if reader.remarks:
        first = reader.remarks[0]
        raise ParseError(first.what, source=source, line=first.at[0], column=first.at[1])
    return tuple(atoms)
