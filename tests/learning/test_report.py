"""The summary of learning, and what one operator that cannot be fitted costs: itself, and nothing else."""

from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest
from synthetic import record

from symskill_pddl.errors import LearningError
from symskill_pddl.learning import learn_reported
from symskill_pddl.learning.report import LeftOut, summary

module = import_module("symskill_pddl.learning.learn")


def episode(start, where="demos:demo_0"):
    return SimpleNamespace(demo=SimpleNamespace(where=where, times=np.arange(10.0)), obj="milk", start=start, stop=start + 2)


def test_the_summary_tells_what_was_used_left_out_and_is_doubtful():
    episodes = [episode(i) for i in range(5)]
    left_out = [LeftOut.of(episodes[1], "it leads back to where it began")]
    text = summary(episodes, [episodes[0], *episodes[2:4]], left_out, 4, {"milk-in-box": 0.05, "door-open": 0.9})
    assert text == (
        "3 of 5 episodes used; 2 left out: demos:demo_0 at 1.0 s (it leads back to where it began), "
        "demos:demo_0 at 4.0 s (no operator shows it); 4 operators; doubtful: reference of milk-in-box, lead 0.05"
    )


def test_much_that_was_left_out_is_counted():
    text = summary([episode(i) for i in range(6)], [], [], 1, {})
    assert text.startswith("0 of 6 episodes used; 6 left out: ")
    assert text.endswith(", and 3 more; 1 operator")


def test_what_was_left_out_says_where_when_why_and_what_helps():
    told = LeftOut("demos:demo_3", 1.25, 2.5, "door", "the hand does not move", "show it again")
    assert str(told) == "demos:demo_3 1.25-2.50 s, door: the hand does not move; left out: show it again"


@pytest.fixture
def failing(monkeypatch):
    """Skills of some operators cannot be fitted."""
    fit = module.learn_skill

    def fail(names):
        def learn_skill(group, config):
            if group.learned.operator.name in names:
                raise LearningError("no stable field")
            return fit(group, config)

        monkeypatch.setattr(module, "learn_skill", learn_skill)

    return fail


def test_an_operator_without_a_skill_is_left_out_and_the_others_stay(failing):
    demos = record("CloseSingleDoor", 1)
    failing({"close-door"})
    library, report = learn_reported(demos)
    assert [o.operator.name for o in library.operators] == ["reach-door-open"]
    assert set(library.skills) == {"reach-door-open"}
    (left,) = report.left_out
    assert (left.what, left.reason) == ("close-door", "no stable field")
    assert "1 operator" in report.summary


def test_without_any_skill_there_is_no_library(failing):
    failing({"close-door", "reach-door-open"})
    with pytest.raises(LearningError, match="no skill can be learned; first reason: no stable field"):
        learn_reported(record("CloseSingleDoor", 1))
