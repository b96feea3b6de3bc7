from pathlib import Path

import pytest

from symskill_pddl.cli.settings import parameters, table
from symskill_pddl.learning import LearnConfig
from symskill_pddl.learning.scale import RelationConfig

PAGE = Path(__file__).parents[2] / "docs" / "learning.md"


def test_every_parameter_has_a_reason():
    assert [e.name for e in parameters() if len(e.reason) < 12] == []


def test_the_document_holds_them_as_they_are():
    assert table(parameters()) in PAGE.read_text(encoding="utf-8"), "run: python benchmarks/learning_parameters.py"


@pytest.mark.parametrize(
    ("name", "value", "unit"),
    [
        ("states.still", "0.01", "A"),
        ("relations.spread", "0.25", "A"),
        ("relations.gap_deg", "18", "deg"),
        ("relations.odd_of", "3", ""),
        ("skills.tolerance_m", "0.004", "m"),
        ("skills.tolerance_rad", "5", "deg"),
    ],
)
def test_values_and_units(name, value, unit):
    (found,) = [e for e in parameters() if e.name == name]
    assert (found.value, found.unit) == (value, unit)


def test_they_are_those_of_the_configuration_given():
    changed = parameters(LearnConfig(relations=RelationConfig(gap=0.5)))
    assert [e.value for e in changed if e.name == "relations.gap"] == ["0.5"]
