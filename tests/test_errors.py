"""Messages say where."""

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from symskill_pddl.errors import NoPlanError, ParseError, SymSkillError, alternatives, escaped, shown


def test_a_parse_error_says_where() -> None:
    assert str(ParseError("unknown type 'fod'", source="domain.pddl", line=3, column=7)) == "domain.pddl:3:7: unknown type 'fod'"
    assert str(ParseError("empty", source="plan.txt")) == "plan.txt: empty"


def test_exit_status() -> None:
    assert SymSkillError.exit_status == 2
    assert NoPlanError.exit_status == 1


def test_alternatives_are_sorted() -> None:
    assert alternatives(["b", "a"]) == "a, b"
    assert alternatives([]) == "none"


@pytest.mark.parametrize(
    "unsafe", ["\x1b]52;c;AAAA\x07", "\x9b31m", "\u202eabc", "\x00", "\x7f", "\ud800", "\u2066", "\U000e0041"]
)
def test_nothing_that_a_terminal_obeys_is_shown(unsafe: str) -> None:
    for text in (shown(f"a{unsafe}b"), escaped(f"a{unsafe}b")):
        assert text.isprintable()
        assert text.isascii()
        assert text.startswith("a\\")


def test_lines_stay_lines_and_names_stay_names() -> None:
    assert escaped("é\n\tb") == "é\n\tb"
    assert shown(" é \n\tb ") == "é b"


@given(st.text(), st.integers(20, 400))
def test_what_is_shown_is_short_and_printable(text: str, limit: int) -> None:
    assert len(shown(text * 50, limit)) <= limit
    assert shown(text, limit).isprintable() or any(unicodedata.category(c) in ("Cn", "Co", "Zs", "Cf") for c in text)


def test_of_something_long_both_ends_are_shown() -> None:
    line = shown("begin " + "x" * 10_000_000 + " end")
    assert line.startswith("begin ")
    assert line.endswith(" end")


def test_of_very_many_names_the_first_are_listed() -> None:
    text = alternatives(f"name-{i:05d}" for i in range(20_000))
    assert len(text) < 340
    assert text.endswith("... (20000 in all)")
