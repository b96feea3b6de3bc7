"""From PDDL text to nested groups of words, each with its line and column.

PDDL is case-insensitive, so words come out in lower case. A comment runs from ';' to the end of the line. A '?' begins a
variable, with or without a blank before it; the mark that some editors put before the first byte of a text is none of it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from symskill_pddl.errors import ParseError

_TOKEN = re.compile(r";[^\n]*|[()]|\??[^\s();?]+|\?")
_DEPTH = 100
"""No PDDL that a person or a planner writes is nested as deeply."""
_WORD = re.compile(r"[a-z0-9_?:=.+*/<>#@%!-]+")


@dataclass(frozen=True)
class Word:
    """A name, variable, keyword or number."""

    text: str
    line: int
    column: int

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Group:
    """Everything between a pair of parentheses."""

    items: tuple[Node, ...]
    line: int
    column: int

    @property
    def head(self) -> str:
        """The first word, or '' where the group is empty or starts with another group."""
        return self.items[0].text if self.items and isinstance(self.items[0], Word) else ""

    def __str__(self) -> str:
        return "(" + " ".join(map(str, self.items)) + ")"


Node = Word | Group


def _tokens(text: str, source: str) -> Iterator[Word]:
    for number, line in enumerate(text.removeprefix("\ufeff").splitlines(), start=1):
        for match in _TOKEN.finditer(line):
            token, column = match.group().lower(), match.start() + 1
            if token.startswith(";"):
                break
            if token not in "()" and not _WORD.fullmatch(token):
                raise ParseError(
                    f"'{match.group()}' is not a PDDL name (letters a-z, digits, '-' and '_')",
                    source=source,
                    line=number,
                    column=column,
                )
            yield Word(token, number, column)


def read_groups(text: str, source: str = "<text>", unclosed: list[Word] | None = None) -> tuple[Node, ...]:
    """All top-level words and groups of a text, in order.

    Parameters
    ----------
    unclosed : list of Word, optional
        Takes the parenthesis of a group that the text does not close, if it is an outermost one: it is read as if the text did.

    Raises
    ------
    ParseError
        A character no PDDL name has, or a parenthesis without its partner.
    """
    stack: list[tuple[Word | None, list[Node]]] = [(None, [])]
    for token in _tokens(text, source):
        if token.text == "(":
            if len(stack) > _DEPTH:
                raise ParseError(
                    f"more than {_DEPTH} '(' within one another", source=source, line=token.line, column=token.column
                )
            stack.append((token, []))
        elif token.text == ")":
            opening, items = stack.pop()
            if opening is None:
                raise ParseError("this ')' closes nothing", source=source, line=token.line, column=token.column)
            stack[-1][1].append(Group(tuple(items), opening.line, opening.column))
        else:
            stack[-1][1].append(token)
    opening, items = stack[-1]
    if opening is not None and len(stack) == 2 and unclosed is not None:
        unclosed.append(opening)
        stack.pop()
        stack[-1][1].append(Group(tuple(items), opening.line, opening.column))
        opening, items = stack[-1]
    if opening is not None:
        raise ParseError("this '(' is never closed", source=source, line=opening.line, column=opening.column)
    return tuple(items)
