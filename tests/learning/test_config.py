"""Settings: a TOML file sets any of them; the rest follows from the recordings."""

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.learning import LearnConfig, read_config
from symskill_pddl.learning.scale import RelationConfig, aperture_of


def test_a_file_sets_some_settings_and_the_others_stay(tmp_path):
    file = tmp_path / "learn.toml"
    file.write_text('[relations]\ngap = 1\nodd_of = 5\n[hints]\nup = "y"\n[hints.joints]\nblock = "free"\n')
    config = read_config(file)
    assert (config.relations.gap, config.relations.odd_of, config.relations.ratio) == (1.0, 5, RelationConfig().ratio)
    assert config.hints.document() == {"up": "y", "joints": {"block": "free"}}
    assert config.skills == LearnConfig().skills


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[relation]\ngap = 1", "there is no table 'relation'; there are: .*relations"),
        ("[relations]\ngab = 1", r"there is no setting of \[relations\] 'gab'; there are: .*gap"),
        ("relations = 1", r"'relations' has to be a table, \[relations\]"),
        ("[relations]\ngap = -1", "relations.gap has to be a positive number, got -1"),
        ("[relations]\ngap = true", "relations.gap has to be a positive number, got True"),
        ("[relations]\nodd_of = 2.5", "relations.odd_of has to be a positive whole number, got 2.5"),
        ("[relations]\ngap = nan", "the number nan is out of range"),
        ("[hints]\nupp = 'z'", "there is no hint 'upp'"),
        ("gap =", "is no TOML"),
    ],
)
def test_what_is_no_setting_is_refused(tmp_path, text, message):
    file = tmp_path / "learn.toml"
    file.write_text(text)
    with pytest.raises(InputError, match=message):
        read_config(file)


def test_a_file_that_is_not_there():
    with pytest.raises(InputError, match=r"there is no file of settings 'nowhere\.toml'"):
        read_config(Path("nowhere.toml"))


def test_lengths_follow_the_hand():
    small, large = (RelationConfig().scaled(a) for a in (0.03, 0.3))
    for name in ("free_gap_m", "slide_gap_m", "contact_gap_m", "static_gap_m"):
        np.testing.assert_allclose(10 * getattr(small, name), getattr(large, name))
    for f in fields(small.free_shape):
        if f.name.endswith("_m"):
            np.testing.assert_allclose(10 * getattr(small.free_shape, f.name), getattr(large.free_shape, f.name))
    assert small.hinge_gap_rad == large.hinge_gap_rad


def test_without_fingers_a_usual_hand_is_assumed():
    assert aperture_of([]) == 0.08


NO_TABLES = ["hints = 1", "[hints]\nleave_out = 3", "[hints]\nleave_out = []", '[hints]\nleave_out = "lamp"']


@pytest.mark.parametrize("text", NO_TABLES)
def test_hints_that_are_no_table_are_refused(tmp_path, text):
    (tmp_path / "learn.toml").write_text(text)
    with pytest.raises(InputError, match="have to be a table"):
        read_config(tmp_path / "learn.toml")
