"""Messages say where."""

from symskill_pddl.errors import NoPlanError, ParseError, SymSkillError, alternatives


def test_a_parse_error_says_where() -> None:
    assert str(ParseError("unknown type 'fod'", source="domain.pddl", line=3, column=7)) == "domain.pddl:3:7: unknown type 'fod'"
    assert str(ParseError("empty", source="plan.txt")) == "plan.txt: empty"


def test_exit_status() -> None:
    assert SymSkillError.exit_status == 2
    assert NoPlanError.exit_status == 1


def test_alternatives_are_sorted() -> None:
    assert alternatives(["b", "a"]) == "a, b"
    assert alternatives([]) == "none"
