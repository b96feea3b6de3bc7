"""What planners print: the plans in it, told from the talk around them.

A step is ``(pick a b)``, ``pick(a, b)``, ``pick a b (1)`` or, behind a number, ``pick a b``, in any case, on a line of its own. A
time or number may stand before it (``0.000:``, ``1e+00:``, ``step 3:``, ``3.``), a duration or more behind it (``[1.0]``,
``[D:1.00; C:0.10]``). So the outputs of Fast Downward and LAMA, FF, LPG, POPF and OPTIC, ENHSP and unified-planning are read. All
other lines are talk. A line that is meant for a step, because it begins with an action's name in parentheses or stands among
steps in parentheses, and is none, is an error and not talk.

Plans end where talk, a comment on a new plan, or a number that begins anew stands between two steps.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from itertools import pairwise

from symskill_pddl.errors import ParseError

_NUMBER = r"[0-9]+(?:\.[0-9]*)?(?:e[+-]?[0-9]+)?"
_BEFORE = re.compile(rf"(?P<step>step\s*)?(?P<start>{_NUMBER})\s*(?P<mark>[:.)])\s*", re.IGNORECASE)
_BEHIND = re.compile(r"\s*\[(?P<inside>[^\]]*)\]\)?\s*$")
_LENGTH = re.compile(rf"\s*(?:D\s*:)?\s*(?P<length>{_NUMBER})", re.IGNORECASE)
_STEP = re.compile(r"\(([^()]*)\)")
_CALL = re.compile(r"([^\s()]+)\(([^()]*)\)")
_WORDS = re.compile(r"([^()]+?)(?:\s*\([0-9.]+\))?")
_COST = re.compile(rf";?\s*(?:plan\s+)?cost\s*[=:]\s*(?P<cost>{_NUMBER})(?![0-9.])", re.IGNORECASE)
_NEW = re.compile(r";.*\b(?:solution|plan|metric|cost|makespan)\b", re.IGNORECASE)
_WAITING = re.compile(r"-+\s*waiting\s*-+", re.IGNORECASE)


@dataclass(frozen=True)
class Line:
    """A step as it is printed: words in lower case, and where they stand."""

    words: tuple[str, ...]
    at: tuple[int, int]
    start: float | None = None
    length: float | None = None


@dataclass
class Block:
    """One plan."""

    lines: list[Line] = field(default_factory=list)
    cost: float | None = None
    clock: bool = False
    """Whether the numbers before the steps are times and not a count."""
    closed: bool = False


def blocks(text: str, actions: Collection[str], source: str) -> tuple[Block, ...]:
    """Every plan in a text, in its order. A text without a step is the empty plan, if it is empty or has only comments.

    Parameters
    ----------
    actions : collection of str
        Names of the actions, in lower case.

    Raises
    ------
    ParseError
        With the line: something that is meant for a step and is none; or talk without any step.
    """
    found, talk = [Block()], None
    for number, line in enumerate(text.removeprefix("\ufeff").splitlines(), start=1):
        step, clock = _step(line, number, actions, source, among=bool(found[-1].lines) and not found[-1].closed)
        here = found[-1]
        if step is not None:
            if here.lines and (_anew(here.lines[-1], step, clock) or (here.closed and not _goes_on(here.lines[-1], step))):
                found.append(here := Block())
            here.closed, here.clock = False, here.clock or clock
            here.lines.append(step)
            continue
        stripped = line.strip()
        if cost := _COST.match(stripped):
            here.cost = float(cost["cost"])
        comment = stripped.startswith(";")
        if stripped and not comment and talk is None:
            talk = (number, line.index(stripped[0]) + 1, stripped)
        if here.lines and stripped and (not comment or _NEW.match(stripped)):
            here.closed = True
    plans = tuple(block for block in found if block.lines)
    if not plans and (unknown := _unknown(text)):
        return (Block([unknown]),)
    if not plans and talk is not None:
        line_number, column, said = talk
        expected = f"there is no plan: no line is a step like '(pick apple table)', the first is '{_short(said)}'"
        raise ParseError(expected, source=source, line=line_number, column=column)
    return plans or (found[0],)


def holds_plan(text: str, actions: Collection[str]) -> bool:
    """Whether a text has a line that is a step, or is meant for one."""
    try:
        known = {a.lower() for a in actions}
        return any(line.words[0] in known for block in blocks(text, known, "") for line in block.lines)
    except ParseError as error:
        return "there is no plan" not in str(error)


def _unknown(text: str) -> Line | None:
    """The first line that has the form of a step, for a text without one of a known action."""
    for number, line in enumerate(text.splitlines(), start=1):
        if (match := _STEP.fullmatch(line.strip())) and match[1].split():
            return Line(tuple(match[1].lower().split()), (number, line.index("(") + 1))
    return None


def _step(line: str, number: int, actions: Collection[str], source: str, *, among: bool) -> tuple[Line | None, bool]:
    """The step on a line, if there is one, and whether the number before it is a time."""
    code = line.strip()
    if not code or code.startswith(";"):
        return None, False
    column = line.index(code[0]) + 1
    before = _BEFORE.match(code)
    rest = code[before.end() :] if before else code
    behind = _BEHIND.search(rest.partition(";")[0] if "[" not in rest.partition(";")[0] else rest)
    length = None
    if behind:
        rest, inside = rest[: behind.start()], _LENGTH.match(behind["inside"])
        length = float(inside["length"]) if inside else None
    rest = rest.partition(";")[0].strip()
    if _WAITING.fullmatch(rest):
        return None, False
    words = _words(rest, actions, numbered=before is not None)
    if words is None:
        first = rest.lstrip("(").partition("(")[0].lower().split()[:1]
        meant = rest.startswith("(") and (among or (first and first[0] in actions))
        if meant or (among and first and first[0] in actions):
            raise ParseError(
                f"expected a step like '(pick apple table)', got '{_short(code)}'", source=source, line=number, column=column
            )
        return None, False
    if not words:
        raise ParseError("expected an operator's name, got '()'", source=source, line=number, column=column)
    if words[0] not in actions and not among and not (before and behind):
        return None, False
    start = float(before["start"]) if before else None
    clock = before is not None and not before["step"] and before["mark"] == ":" and (length is not None or "." in before["start"])
    return Line(words, (number, column), start, length), clock


def _words(rest: str, actions: Collection[str], *, numbered: bool) -> tuple[str, ...] | None:
    """Name and arguments, in one of the ways to write them; None where it is no step."""
    if match := _STEP.fullmatch(rest):
        return tuple(match[1].lower().split())
    if match := _CALL.fullmatch(rest):
        return (match[1].lower(), *match[2].lower().replace(",", " ").split()) if match[1].lower() in actions else None
    match = _WORDS.fullmatch(rest)
    words = tuple(match[1].lower().split()) if match else ()
    priced = match is not None and match[1] != rest
    return words if words and words[0] in actions and (numbered or priced) else None


def _anew(last: Line, step: Line, clock: bool) -> bool:
    """Whether the count begins again; times may stand in any order."""
    return not clock and step.start is not None and last.start is not None and step.start < last.start and step.start <= 1.0


def _goes_on(last: Line, step: Line) -> bool:
    """Whether the numbers say that talk stands within one plan."""
    return step.start is not None and last.start is not None and last.start < step.start == last.start + 1.0


def _short(text: str) -> str:
    return text if len(text) <= 80 else text[:77] + "..."


def together(lines: list[Line]) -> Iterator[tuple[Line, Line]]:
    """Neighbours, in the order of time, that start at one time."""
    ordered = sorted((line for line in lines if line.start is not None), key=lambda line: line.start or 0.0)
    for one, other in pairwise(ordered):
        if one.start == other.start:
            yield one, other
