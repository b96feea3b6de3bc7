import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_domains import atoms, covered_egg, kitchen

from symskill_pddl.pddl import DIALECTS, exported, read_domain, write_domain, write_problem
from symskill_pddl.pddl.export import number, signature
from symskill_pddl.symbols import Domain, Operator, Predicate

GOLDEN = Path(__file__).parent / "golden"
COMMENTS = {
    "lid-on-pan": ("offset 0.0 0.1 3.2 cm, within 1.1 cm",),
    "pick-lid": ("learned from 5 episodes", "maintain: (gripper-open)\n(:action evil)"),
    "lid": ("covers pans",),
}


@pytest.mark.parametrize("dialect", DIALECTS)
def test_the_text(dialect):
    text = write_domain(kitchen(), dialect=dialect, comments=COMMENTS, header=("learned",))
    assert text == (GOLDEN / f"kitchen-{dialect}.pddl").read_text()
    assert write_problem(covered_egg(), kitchen(), dialect=dialect) == (GOLDEN / f"egg-{dialect}.pddl").read_text()


@pytest.mark.parametrize("dialect", DIALECTS)
def test_comments_never_become_pddl(dialect):
    text = write_domain(kitchen(), dialect=dialect, comments=COMMENTS)
    assert read_domain(text) == exported(kitchen(), dialect).domain


@pytest.mark.parametrize("dialect", DIALECTS)
def test_the_form_that_every_parser_takes(dialect):
    text = write_domain(kitchen(), dialect=dialect)
    assert text == text.lower()
    assert not re.search(r"\(\s*\)(?!\n)", text.replace(":parameters ()", ""))
    assert "object - object" not in text
    assert len(re.findall(r"\n\n  \(:(durative-)?action", text)) == 4
    assert "\n\n\n" not in text


def test_an_operator_without_anything():
    domain = Domain("d", (), (Predicate("p"),), (Operator("noop", (), frozenset(), frozenset(), frozenset()),))
    text = write_domain(domain)
    assert ":precondition (and)" in re.sub(r"\s+\)", ")", text)
    assert read_domain(text) == domain


@pytest.mark.parametrize(
    ("value", "text"), [(1.0, "1"), (0.0, "0"), (2.5, "2.5"), (1e-6, "0.000001"), (123456789.0, "123456789")]
)
def test_numbers(value, text):
    assert number(value) == text


@given(st.lists(st.sampled_from(["a", "a1", "a2", "object"]), max_size=4))
def test_signatures_have_distinct_variables(types):
    words = [w for w in signature(Predicate("p", tuple(types))).split() if w.startswith("?")]
    assert len(set(words)) == len(words) == len(types)


def test_a_temporal_delete_falls_when_the_data_say():
    text = write_domain(kitchen(), dialect="temporal")
    pick = text[text.index("pick-lid") : text.index("place-lid")]
    assert "(at end (not (gripper-open)))" in pick  # maintained until the end
    assert "(at start (not (arm-free)))" in pick
    assert exported(kitchen(), "temporal").problem(covered_egg()).init == covered_egg().init | atoms("arm-free")
