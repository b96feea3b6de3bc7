import pytest
from random_domains import covered_egg, kitchen

from symskill_pddl.errors import ParseError
from symskill_pddl.pddl import read_plan, write_plan
from symskill_pddl.symbols import Plan

PLAN = Plan((("pick-lid", ("lid-a", "pan-a")), ("place-lid", ("lid-a", "pan-c"))))


def read(text):
    return read_plan(text, kitchen(), covered_egg().object_types, "plan.txt")


@pytest.mark.parametrize(
    "text",
    [
        write_plan(PLAN),
        "(pick-lid lid-a pan-a)\n(place-lid lid-a pan-c)\n; cost = 2 (unit cost)\n",
        "; a comment\n\n  ( PICK-LID LID-A PAN-A )  ; why\r\n(PLACE-LID LID-A PAN-C)",
        "0.0003:   (PICK-LID LID-A PAN-A) [1.0000]\n1.0005:   (PLACE-LID LID-A PAN-C) [2.0000])\n",
        "1.001: (place-lid lid-a pan-c) [2.0]\n0.000: (pick-lid lid-a pan-a) [1.0]",
        "0: (pick-lid lid-a pan-a)\n1: (place-lid lid-a pan-c)",
    ],
)
def test_formats(text):
    assert read(text) == PLAN


def test_cost():
    assert read("; cost = 3.5 (general cost)").cost == 3.5
    assert read(write_plan(Plan(PLAN.steps, 5.5))).cost == 5.5
    assert read("").cost is None


def test_an_empty_plan_is_a_plan():
    assert read(write_plan(Plan())) == Plan()


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("pick-lid lid-a pan-a", "plan.txt:2:1: expected a step"),
        ("(pick-lid lid-a pan-a", "plan.txt:2:1: expected a step"),
        ("  ((pick-lid lid-a pan-a))", "plan.txt:2:3: expected a step"),
        ("()", "plan.txt:2:1: expected an operator's name"),
        ("(fry egg)", "plan.txt:2:1: unknown operator 'fry'"),
        ("(pick-lid lid-a wok)", "plan.txt:2:1: .*unknown object 'wok'"),
        ("(pick-lid lid-a)", "plan.txt:2:1: .*takes 2 arguments"),
        ("(pick-lid egg pan-a)", "plan.txt:2:1: .*needs a lid"),
    ],
)
def test_errors_have_the_line(line, message):
    with pytest.raises(ParseError, match=message.replace("(", r"\(")):
        read(f"(pick-lid lid-a pan-a)\n{line}\n")
