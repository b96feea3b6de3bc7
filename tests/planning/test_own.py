"""Somebody's own planner class, by name."""

import time

import pytest
from random_domains import covered_egg, kitchen

from symskill_pddl.errors import InputError
from symskill_pddl.planning import Limits, Status, get
from symskill_pddl.symbols import validate

HERE = "tests.planning.own_planners"


def test_a_good_one():
    planner = get(f"{HERE}:Good")
    result = planner.solve(kitchen(), covered_egg(), Limits(60.0))
    validate(kitchen(), covered_egg(), result.unwrap())
    assert result.planner == planner.name == f"{HERE}:Good"
    step = next(s for s in result.plan.steps if s[0] == "place-lid" and s[1][0] == "lid-a")
    assert step not in planner.solve(kitchen(), covered_egg(), Limits(60.0), {step: 1000.0}).unwrap().steps


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("Liar", "is not a plan: the plan ends without the goal"),
        ("Raises", "KeyError: 'egg'"),
        ("Nothing", "AttributeError: "),
        ("Missing", "has no attribute 'Missing'"),
    ],
)
def test_one_that_breaks_is_a_status_with_a_message(name, said):
    result = get(f"{HERE}:{name}").solve(kitchen(), covered_egg(), Limits(60.0))
    assert result.status is Status.FAILED
    assert said in result.messages[0]


def test_one_that_does_not_come_back_is_ended():
    planner = get(f"{HERE}:Sleeps")
    assert get(f"{HERE}:Good").solve(kitchen(), covered_egg(), Limits(60.0)).status is Status.SOLVED  # it is imported
    begin = time.monotonic()
    assert planner.solve(kitchen(), covered_egg(), Limits(0.3)).status is Status.TIMEOUT
    assert time.monotonic() - begin < 60.0  # of 600 s


def test_a_module_that_is_not_there():
    with pytest.raises(InputError, match=r"unknown planner 'no_such_module:Mine'; there are: .*MODULE:NAME"):
        get("no_such_module:Mine")
