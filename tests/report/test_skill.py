"""Pictures of skills: one PNG for each phase, with or without demonstrations; one clear line without matplotlib."""

import io
import sys

import numpy as np
import pytest
from PIL import Image

from symskill_pddl.errors import MissingDependencyError
from symskill_pddl.geometry import Pose
from symskill_pddl.report import skill_pictures
from symskill_pddl.skills import FitConfig, Phase, Skill, Trajectory, fit_fields


def reach(seed: int) -> Trajectory:
    rng = np.random.default_rng(seed)
    s = np.linspace(1.0, 0.0, 60)[:, None]
    x = s * (np.array([0.3, 0.1, 0.2]) + rng.normal(0, 0.02, 3)) + 0.04 * np.sin(np.pi * s)
    return Trajectory(0.05 * np.arange(60), Pose.from_rotvec(x, s * np.array([0.3, 0.0, 0.5])))


@pytest.fixture(scope="module")
def skill() -> Skill:
    (field,) = fit_fields([reach(0), reach(1)], FitConfig(max_fields=1, components=2))
    return Skill((Phase("?food", field, False, 0.02, 0.1, 3.0), Phase("?food", field, False, 0.01, 0.1, 3.0)), True)


def test_a_picture_for_each_phase_with_and_without_demonstrations(skill):
    pytest.importorskip("matplotlib")
    shown = skill_pictures("pick-food", skill, [[reach(0), reach(1)], []])
    again = skill_pictures("pick-food", skill, [[reach(0), reach(1)], []])
    bare = skill_pictures("pick-food", Skill(skill.phases[:1], True), [[]])
    assert shown == again
    assert (len(shown), len(bare)) == (2, 1)
    for picture in (*shown, *bare):
        image = Image.open(io.BytesIO(picture))
        assert image.format == "PNG"
        assert min(image.size) > 800
        # something is drawn: grey, red and blue, not white alone
        assert len(image.convert("RGB").getcolors(10**7)) > 100


def test_without_matplotlib_one_line_says_what_to_install(skill, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(MissingDependencyError, match=r"pip install 'symskill-pddl\[plots\]'"):
        skill_pictures("pick-food", skill, [[], []])
