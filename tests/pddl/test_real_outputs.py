"""Whole outputs of real planners for one problem (a covered egg), as they printed them; paths of the machine are left out.

Kairos 1.0.6, Fast Downward 23.06 (lama-first), LPG-td 1.4, pyperplan 2.1, ENHSP 20 by itself and through unified-planning 1.3.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from random_domains import covered_egg, kitchen

from symskill_pddl.pddl import read_plans
from symskill_pddl.symbols import validate

DATA = Path(__file__).parent / "data"
STEPS = {
    "kairos.txt": 8,
    "kairos-temporal.txt": 8,
    "fast-downward.txt": 8,
    "sas_plan": 8,
    "lpg.SOL": 8,
    "pyperplan.soln": 10,
    "enhsp.txt": 10,
    "unified-planning.txt": 10,
}


@pytest.mark.parametrize("name", STEPS)
def test_the_plan_in_it_is_found_and_valid(name):
    text = (DATA / name).read_text()
    plan = read_plans(text, kitchen(), covered_egg().object_types, name)[-1].plan
    assert len(plan) == STEPS[name]
    validate(kitchen(), covered_egg(), plan)


def test_every_plan_of_an_anytime_planner_is_found():
    found = read_plans((DATA / "kairos.txt").read_text(), kitchen(), covered_egg().object_types)
    for read in found:
        validate(kitchen(), covered_egg(), read.plan)
    assert [len(read.plan) for read in found] == sorted((len(read.plan) for read in found), reverse=True)
