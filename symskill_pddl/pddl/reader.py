"""The grammar that every part of a PDDL text shares: words, typed lists, terms, and errors with their place.

What is not PDDL is an error. What most planners let pass, though the standard does not (an object that is declared twice, an
argument of another type), is a remark: the text is read, and whoever needs it in order says so.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field

from symskill_pddl.errors import ParseError, alternatives
from symskill_pddl.pddl.lexer import Group, Node, Word
from symskill_pddl.pddl.syntax import Beyond, Remark, Variable, Vocabulary
from symskill_pddl.symbols import ROOT_TYPE, Atom

Kinds = tuple[str, ...]
"""Types, one unless it is an ``either``."""
Scope = Mapping[str, Kinds]
"""The variables and objects that may stand somewhere, with their types."""


@dataclass(frozen=True)
class Reader:
    """Reads from `source`, which stands at the head of every error."""

    source: str
    remarks: list[Remark] = field(default_factory=list)

    def error(self, node: Node, message: str) -> ParseError:
        return ParseError(message, source=self.source, line=node.line, column=node.column)

    def remark(self, node: Node, message: str, *, harmless: bool = False) -> None:
        self.remarks.append(Remark(message, (node.line, node.column), harmless))

    def beyond(self, node: Node, what: str) -> Beyond:
        return Beyond(what, str(node), (node.line, node.column))

    def group(self, node: Node, what: str) -> Group:
        if isinstance(node, Word):
            raise self.error(node, f"expected {what} in parentheses, got '{node}'")
        return node

    def word(self, node: Node, what: str) -> str:
        if isinstance(node, Group):
            raise self.error(node, f"expected {what}, got '('")
        return node.text

    def new(self, node: Node, what: str, names: Iterable[str]) -> None:
        if str(node) in set(names):
            raise self.error(node, f"{what} '{node}' is declared a second time")

    def typed(self, items: tuple[Node, ...], what: str) -> list[tuple[Word, tuple[Word, ...]]]:
        """``a b - t c - (either t u)`` as pairs of a name and its types."""
        pairs: list[tuple[Word, tuple[Word, ...]]] = []
        waiting: list[Word] = []
        rest = [part for item in items for part in _apart(item)][::-1]
        while rest:
            node = rest.pop()
            if isinstance(node, Group):
                raise self.error(node, f"expected {what}, got '{node}'")
            if node.text != "-":
                waiting.append(node)
                continue
            if not waiting:
                raise self.error(node, f"expected {what} before '-'")
            if not rest:
                raise self.error(node, "expected a type after '-'")
            kinds = self._kinds(rest.pop())
            pairs += [(name, kinds) for name in waiting]
            waiting = []
        return pairs + [(name, (Word(ROOT_TYPE, name.line, name.column),)) for name in waiting]

    def _kinds(self, node: Node) -> tuple[Word, ...]:
        if isinstance(node, Word):
            return (node,)
        words = tuple(item for item in node.items[1:] if isinstance(item, Word))
        if node.head != "either" or not words or len(words) != len(node.items) - 1:
            raise self.error(node, "expected a type")
        return words

    def known_types(self, kinds: Iterable[Word], types: Collection[str]) -> Kinds:
        for kind in kinds:
            if kind.text != ROOT_TYPE and kind.text not in types:
                raise self.error(kind, f"unknown type '{kind}'; declared: {alternatives({ROOT_TYPE, *types})}")
        return tuple(dict.fromkeys(kind.text for kind in kinds))

    def variables(self, items: tuple[Node, ...], types: Collection[str]) -> tuple[Variable, ...]:
        found: list[Variable] = []
        for word, kinds in self.typed(items, "a variable"):
            if not word.text.startswith("?") or word.text == "?":
                raise self.error(word, f"expected a variable like '?x', got '{word}'")
            known = self.known_types(kinds, types)
            self.new(word, "variable", (v.name for v in found))
            found.append(Variable(word.text, known, (word.line, word.column)))
        return tuple(found)

    def atom(self, group: Group, vocabulary: Vocabulary, scope: Scope) -> Atom:
        if not group.items:
            raise self.error(group, "expected an atom, got '()'")
        name = self.word(group.items[0], "a predicate")
        if name not in vocabulary.predicates:
            raise self.error(group, f"unknown predicate '{name}'; the domain has: {alternatives(vocabulary.predicates)}")
        args = tuple(self.word(item, "a name") for item in group.items[1:])
        self.arguments(group, args, vocabulary, vocabulary.predicates[name], scope)
        return Atom(name, args)

    def arguments(self, group: Group, args: Kinds, vocabulary: Vocabulary, declared: tuple[Kinds, ...], scope: Scope) -> None:
        """Raise where a predicate or function has the wrong number of arguments or one that is not there."""
        if len(args) != len(declared):
            signature = " ".join((group.head, *(_either(kinds) for kinds in declared)))
            raise self.error(group, f"({signature}) takes {len(declared)} arguments, got {len(args)}: {group}")
        for arg, wanted in zip(args, declared, strict=True):
            if arg not in scope:
                what = "variable" if arg.startswith("?") else "object"
                raise self.error(group, f"{group} names the unknown {what} '{arg}'; there are: {alternatives(scope)}")
            if not vocabulary.fits(scope[arg], wanted):
                kinds = _either(scope[arg])
                self.remark(group, f"{group} needs the type {_either(wanted)} where '{arg}' is of type {kinds}")


def _either(kinds: Kinds) -> str:
    return kinds[0] if len(kinds) == 1 else f"(either {' '.join(kinds)})"


def _apart(node: Node) -> tuple[Node, ...]:
    """``-type``, as some write it, as the two words that it stands for."""
    if isinstance(node, Word) and node.text.startswith("-") and node.text != "-":
        return Word("-", node.line, node.column), Word(node.text[1:], node.line, node.column + 1)
    return (node,)
