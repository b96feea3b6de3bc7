"""The grammar that every part of a PDDL text shares: words, typed lists, atoms, and errors with their place."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from symskill_pddl.errors import InputError, ParseError, alternatives
from symskill_pddl.pddl.lexer import Group, Node, Word
from symskill_pddl.symbols import ROOT_TYPE, Atom, Domain, Parameter, check_atom

UNSUPPORTED = {
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


@dataclass(frozen=True)
class Reader:
    """Reads from `source`, which stands at the head of every error."""

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

    def new(self, node: Node, what: str, names: Iterable[str]) -> None:
        if str(node) in set(names):
            raise self.error(node, f"{what} '{node}' is declared a second time")

    def number(self, node: Node) -> float:
        try:
            value = float(self.word(node, "a number"))
        except ValueError:
            raise self.error(node, f"expected a number, got '{node}'") from None
        if not 0.0 <= value < float("inf"):
            raise self.error(node, f"a cost or duration is not negative and finite, got '{node}'")
        return value

    def typed(self, items: tuple[Node, ...], what: str) -> list[tuple[Word, Word]]:
        """``a b - t c`` as pairs of name and type."""
        pairs: list[tuple[Word, Word]] = []
        waiting: list[Word] = []
        rest = [part for item in items for part in _apart(item)]
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
                    self.unsupported(kind, UNSUPPORTED["either"])
                    if kind.head == "either"
                    else self.error(kind, "expected a type")
                )
            pairs += [(name, kind) for name in waiting]
            waiting = []
        return pairs + [(name, Word(ROOT_TYPE, name.line, name.column)) for name in waiting]

    def known_type(self, kind: Word, domain: Domain) -> None:
        known = {ROOT_TYPE, *(t.name for t in domain.types)}
        if kind.text not in known:
            raise self.error(kind, f"unknown type '{kind}'; declared: {alternatives(known)}")

    def parameters(self, items: tuple[Node, ...], domain: Domain) -> tuple[Parameter, ...]:
        found: list[Parameter] = []
        for word, kind in self.typed(items, "a variable"):
            if not word.text.startswith("?") or word.text == "?":
                raise self.error(word, f"expected a variable like '?x', got '{word}'")
            self.known_type(kind, domain)
            self.new(word, "variable", (p.name for p in found))
            found.append(Parameter(word.text, kind.text))
        return tuple(found)

    def atom(self, group: Group, domain: Domain, scope: Mapping[str, str]) -> Atom:
        if group.head in UNSUPPORTED:
            raise self.unsupported(group, UNSUPPORTED[group.head])
        words = ("=", "forall", "not", "and", "at", "over", "increase")
        # many domains have a predicate `at`
        if group.head in words and group.head not in {p.name for p in domain.predicates}:
            raise self.error(group, f"'{group.head}' cannot stand here, expected an atom")
        if not group.items:
            raise self.error(group, "expected an atom, got '()'")
        atom = Atom(self.word(group.items[0], "a predicate"), tuple(self.word(item, "a name") for item in group.items[1:]))
        try:
            check_atom(domain, atom, scope, "here")
        except InputError as error:
            raise self.error(group, str(error).removeprefix("here: ")) from None
        return atom


def _apart(node: Node) -> tuple[Node, ...]:
    """``-type``, as some write it, as the two words that it stands for."""
    if isinstance(node, Word) and node.text.startswith("-") and node.text != "-":
        return Word("-", node.line, node.column), Word(node.text[1:], node.line, node.column + 1)
    return (node,)
