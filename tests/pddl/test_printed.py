"""What planners print, in small; whole outputs of real planners are in data/."""

import pytest
from random_domains import covered_egg, kitchen

from symskill_pddl.errors import ParseError
from symskill_pddl.pddl import read_plan, read_plans
from symskill_pddl.symbols import Plan

PLAN = Plan((("pick-lid", ("lid-a", "pan-a")), ("place-lid", ("lid-a", "pan-c"))))
OBJECTS = covered_egg().object_types
WAYS = {
    "ff": "ff: found legal plan as follows\n\n"
    "step    0: PICK-LID LID-A PAN-A\n        1: PLACE-LID LID-A PAN-C\n\ntime spent:  0.00",
    "lpg-td": "0.0000:   (PICK-LID LID-A PAN-A) [D:1.00; C:0.10]\n1.0000:   (PLACE-LID LID-A PAN-C) [D:1.00; C:0.10]",
    "optic": "b (9.000 | 0.000)\n;;;; Solution Found\n; Cost: 2.0\n0.000: (pick-lid lid-a pan-a)  [1.000]\n"
    "1.001: (place-lid lid-a pan-c)  [1.000]\n",
    "fast downward's log": "Solution found!\npick-lid lid-a pan-a (1)\nplace-lid lid-a pan-c (1)\nPlan length: 2 step(s).",
    "unified-planning": "SequentialPlan:\n    pick-lid(lid-a, pan-a)\n    place-lid(lid-a, pan-c)\n",
    "enhsp": "Problem Solved\n\n"
    "0.0: (pick-lid lid-a pan-a)\n0.0: -----waiting---- [1.0]\n1.0: (place-lid lid-a pan-c)\nPlan-Length:2",
    "numbered": "Plan:\n1. (pick-lid lid-a pan-a)\n2. (place-lid lid-a pan-c)\n",
    "numbered, words": "1) pick-lid lid-a pan-a\n2) place-lid lid-a pan-c\n",
    "scientific": "0.0e+00: (pick-lid lid-a pan-a) [1.0e+00]\n1.0e+00: (place-lid lid-a pan-c) [1.0e+00]",
    "mark and line ends": "\ufeff(pick-lid lid-a pan-a)\r\n(place-lid lid-a pan-c)\r\n",
    "comments between": "; first\n(pick-lid lid-a pan-a)\n; then\n(place-lid lid-a pan-c)\n; cost = 1.2.3",
    "two plans, the last counts": "; Solution 1\n(pick-lid lid-b pan-b)\n(place-lid lid-b pan-c)\n; Solution 2\n"
    "(pick-lid lid-a pan-a)\n(place-lid lid-a pan-c)\n",
    "two plans, talk between": "0: (pick-lid lid-b pan-b)\nbetter:\n0: (pick-lid lid-a pan-a)\n1: (place-lid lid-a pan-c)\n",
    "two plans, counted anew": "0: (pick-lid lid-b pan-b)\n1: (place-lid lid-b pan-c)\n0: (pick-lid lid-a pan-a)\n"
    "1: (place-lid lid-a pan-c)\n",
    "talk within a count": "0: (pick-lid lid-a pan-a)\n  state: (lid-on-pan lid-b pan-b) changed\n1: (place-lid lid-a pan-c)\n",
    "facts in the talk": "(lid-on-pan lid-b pan-b)\nfound:\n(pick-lid lid-a pan-a)\n(place-lid lid-a pan-c)\n",
}


@pytest.mark.parametrize("way", WAYS)
def test_ways_to_print_a_plan(way):
    assert read_plan(WAYS[way], kitchen(), OBJECTS) == PLAN


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("no solution", "plan.txt:1:1: there is no plan"),
        ("Parsing...\nThe task has (pick-lid lid-a", "plan.txt:1:1: there is no plan"),
        ("(pick-lid lid-a pan-a)\n(fry egg)", "plan.txt:2:1: unknown operator 'fry'"),
        ("log\n(pick-lid lid-a)", "plan.txt:2:1: 'pick-lid' takes 2 arguments"),
        ("log\n(pick-lid lid-a pan-a", "plan.txt:2:1: expected a step"),
        ("log\n(pick-lid lid-a pan-a) and so on", "plan.txt:2:1: expected a step"),
        ("step 0: PICK-LID LID-A WOK", "plan.txt:1:1: .*unknown object 'wok'"),
        ("pick-lid(lid-a)", "plan.txt:1:1: 'pick-lid' takes 2 arguments"),
    ],
)
def test_what_is_meant_for_a_step_and_is_none(text, message):
    with pytest.raises(ParseError, match=message.replace("(", r"\(")):
        read_plan(text, kitchen(), OBJECTS, "plan.txt")


def test_what_is_said_of_a_plan():
    first, last = read_plans(WAYS["two plans, the last counts"], kitchen(), OBJECTS, "plan.txt")
    assert first.plan.steps[0] == ("pick-lid", ("lid-b", "pan-b"))
    assert last.remarks == ("of 2 plans in plan.txt this is number 2",)
    (same,) = read_plans("0.000: (pick-lid lid-a pan-a) [1]\n0.000: (place-lid lid-a pan-c) [1]", kitchen(), OBJECTS, "plan.txt")
    assert "lines 1 and 2 of plan.txt start at the same time" in same.remarks[0]


def test_times_come_along():
    plan = read_plan(WAYS["optic"], kitchen(), OBJECTS)
    assert (plan.times, plan.cost) == (((0.0, 1.0), (1.001, 1.0)), 2.0)
    assert read_plan(WAYS["ff"], kitchen(), OBJECTS).times is None
