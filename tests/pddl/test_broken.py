"""Twenty broken files for each kind of mistake: each is refused with its place, at once, and never with a traceback."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest
from random_domains import covered_egg, kitchen

from symskill_pddl.errors import ParseError
from symskill_pddl.pddl import DIALECTS, read_domain, read_problem, write_domain, write_problem

ROOT = Path(__file__).parents[2]
DOMAINS = [
    *(write_domain(kitchen(), dialect=dialect) for dialect in DIALECTS),
    *(path.read_text() for path in sorted((ROOT / "domains").rglob("*.pddl"))),
]
PROBLEM = write_problem(covered_egg(), kitchen(), dialect="negative")
WORD = r"[a-z][a-z0-9-]*"
PARTS = {
    None: ("^", "$^"),
    "declarations": (r"\(:predicates", r"\(:(durative-)?action"),
    "actions": (r"\(:(durative-)?action", "$^"),
    "init": (r"\(:init", "$^"),
}
"""Regular expressions for where a part begins and ends; the last never matches, which is the end of the file."""
ATOM = rf"^\s+(?:\(at \w+ |\(over all )?\(({WORD}) (\?{WORD})"


def code(text):
    """Where the text is no comment, as spans of whole lines."""
    at = 0
    for line in text.splitlines(keepends=True):
        if not line.lstrip().startswith(";"):
            yield at, line
        at += len(line)


def spots(text, pattern, group=0, section=None):
    """Spans of a pattern outside comments; in `section`, which is a part of `PARTS`."""
    start, end = (m.start() if (m := re.search(edge, text)) else len(text) for edge in PARTS[section])
    found = [(at + m.start(group), at + m.end(group)) for at, line in code(text) for m in re.finditer(pattern, line)]
    return [span for span in found if start <= span[0] < end]


def replaced(text, span, by):
    return text[: span[0]] + by + text[span[1] :]


def at(pattern, by, group=0, section=None):
    """The mistake of writing something else at a place that a pattern finds."""

    def broken(text, rng):
        span = rng.choice(spots(text, pattern, group, section))
        return replaced(text, span, by(text[slice(*span)]) if callable(by) else by), span[0]

    return broken


def cut_off(text, rng):
    end = rng.randrange(1, text.rstrip().rindex(")"))
    return text[:end], None


def twice(text, rng):
    """An action stands in the file a second time."""
    starts = [s for s, _ in spots(text, r"\(:(durative-)?action ")]
    start = rng.choice(starts)
    depth, end = 0, start
    while True:
        depth += {"(": 1, ")": -1}.get(text[end], 0)
        end += 1
        if depth == 0 and not re.search(r";[^\n]*$", text[:end]):
            break
    block = "\n".join(line for line in text[start:end].splitlines() if not line.lstrip().startswith(";"))
    place = text.rstrip().rindex(")")
    return text[:place] + block + "\n)\n", None


MISTAKES = {
    "a parenthesis too few": at(r"\)", ""),
    "a parenthesis too many": at(r"\)", "))"),
    "the end is missing": cut_off,
    "a character that no name has": at(WORD, lambda w: w[0] + '"' + w[1:], section="declarations"),
    "a predicate that is not declared": at(ATOM, lambda w: w + "x", 1, "actions"),
    "a variable that is no parameter": at(ATOM, lambda w: w + "-9", 2, "actions"),
    "an argument too many": at(ATOM, lambda w: f"{w} {w}", 2, "actions"),
    "an argument too few": at(ATOM, "", 2, "actions"),
    "a type that is not declared": at(rf"\?{WORD} - ({WORD})", lambda w: w + "y", 1),
    "an argument of another type": at(r":parameters \(\?\S+ - (\S+?)[ )]", "object", 1),
    "a keyword misspelt": at(r":(?:effect|parameters)", lambda w: w + "s"),
    "a section misspelt": at(r"\(:(?:types|predicates)", lambda w: w + "x"),
    "a section twice": at(r"\(:predicates", "(:predicates) (:predicates"),
    "a name declared twice": at(rf"^\s+\(({WORD})(?: \?|\)$)", lambda w: f"{w}) ({w}", 1, "declarations"),
    "an action twice": twice,
    "something of another PDDL": at(r":effect \(and", ":effect (and (assign (fuel) 1)"),
    "a disjunction": at(r":(?:pre)?condition \(and", lambda w: w.replace("(and", "(or")),
    "a word where a group belongs": at(r":parameters (?=\()", ":parameters none "),
    "no word where one belongs": at(rf"\(:(?:durative-)?action ({WORD})", "()", 1),
    "something after the end": lambda text, rng: (text + rng.choice(["(define)", "end", "(", ")"]), None),
}
PROBLEM_MISTAKES = {
    "an object that is not declared": at(rf"^\s+\({WORD} ({WORD})", lambda w: w + "-9", 1, "init"),
    "a predicate that is not declared": at(rf"^\s+\(({WORD})", lambda w: w + "x", 1, "init"),
    "an argument too many": at(rf"^\s+\({WORD} ({WORD})", lambda w: f"{w} {w}", 1, "init"),
    "an object of another type": at(rf"^\s+\({WORD} ({WORD}) ({WORD})", "pan-c", 1, "init"),
    "a type that is not declared": at(rf"{WORD} - ({WORD})", lambda w: w + "y", 1),
    "an object twice": at(rf"^\s+({WORD}) -", lambda w: f"{w} {w}", 1),
    "another domain": at(r"\(:domain (\w+)", lambda w: w + "x", 1),
    "no goal": at(r"\(:goal", "(:init"),
    "a parenthesis too few": at(r"\)", ""),
    "a parenthesis too many": at(r"\)", "))"),
    "the end is missing": cut_off,
}


def refused(read, text, spot):
    with pytest.raises(ParseError) as caught:
        read(text)
    error = caught.value
    lines = text.splitlines() or [""]
    assert 1 <= error.line <= len(lines)
    assert 1 <= error.column <= len(lines[error.line - 1]) + 1
    assert re.match(r"file\.pddl:\d+:\d+: \S", str(error))
    assert "\n" not in str(error)
    return error, (None if spot is None else text.count("\n", 0, spot) + 1)


@pytest.mark.parametrize("mistake", MISTAKES)
def test_twenty_broken_domains(mistake):
    on_the_line = 0
    for seed in range(20):
        rng = random.Random(seed)
        text, spot = MISTAKES[mistake](DOMAINS[seed % len(DOMAINS)], rng)
        error, line = refused(lambda t: read_domain(t, "file.pddl"), text, spot)
        on_the_line += error.line == line
    elsewhere = {"a parenthesis too few", "a parenthesis too many", "an argument of another type", "a section misspelt"}
    elsewhere |= {"the end is missing", "an action twice", "something after the end", "a type that is not declared"}
    assert mistake in elsewhere or on_the_line == 20


@pytest.mark.parametrize("mistake", PROBLEM_MISTAKES)
def test_twenty_broken_problems(mistake):
    for seed in range(20):
        text, spot = PROBLEM_MISTAKES[mistake](PROBLEM, random.Random(seed))
        refused(lambda t: read_problem(t, kitchen(), "file.pddl"), text, spot)


@pytest.mark.parametrize("size", [1, 10, 100])
def test_long_and_deep_files_end(size):
    for text in ("(" * 1000 * size, ")" * 1000 * size, "a " * 1000 * size, ";" * 1000 * size, "(define (domain d)" * size):
        with pytest.raises(ParseError):
            read_domain(text)
