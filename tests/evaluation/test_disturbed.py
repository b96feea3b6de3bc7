"""What each disturbance does to a run: without the monitor it fails, or a field or the modulation absorbs it."""

from __future__ import annotations

from importlib.resources import as_file, files

import pytest

from symskill_pddl.demos import load_demos
from symskill_pddl.evaluation.trial import prepare, run_episode
from symskill_pddl.execution.config import ExecutionConfig, MotionConfig
from symskill_pddl.execution.outcome import Category
from symskill_pddl.learning import LearnConfig, learn
from symskill_pddl.learning.skills import SkillConfig
from symskill_pddl.library import Library
from symskill_pddl.planning import Builtin
from symskill_pddl.skills import FitConfig

pytestmark = pytest.mark.simulation

QUICK = LearnConfig(skills=SkillConfig(fit=FitConfig(max_components=3, max_fields=2, samples=100)))


@pytest.fixture(scope="module")
def library() -> Library:
    """Three of the shipped demonstrations of two tasks."""
    with as_file(files("symskill_pddl") / "data" / "kitchen") as folder:
        return learn([d for task in ("PnPCounterToCab", "OpenDrawer") for d in load_demos(folder / f"{task}.hdf5")[:3]], QUICK)


def run(library: Library, task: str, *specs: str, monitor: bool = True, avoid: bool = True):
    """An episode under disturbances: its result, the kitchen, and in how many control periods the obstacle was touched."""
    episode, touched = prepare(library, task, 0, disturbances=specs), []
    kitchen = episode.kitchen
    kitchen.watchers.append(lambda _: touched.append(kitchen.physics.robot_touches("obstacle")))
    config = ExecutionConfig(motion=MotionConfig(avoid=avoid))
    result, _ = run_episode(library, episode, 0, Builtin(), monitor=monitor, config=config)
    assert {text for _, text in kitchen.events} == set(specs)
    return result, kitchen, sum(touched)


FATAL = [
    ("PnPCounterToCab", ("drop@t=4",)),
    ("OpenDrawer", ("close-drawer@t=0",)),
    # the hand goes where the thing was
    ("PnPCounterToCab", ("freeze:6s@t=0", "shift:8cm@t=0.1")),
    # as the fingers close
    ("PnPCounterToCab", ("push:120N,0.8s@t=2.6",)),
]


@pytest.mark.parametrize(("task", "specs"), FATAL)
def test_a_run_without_the_monitor_fails(library: Library, task: str, specs: tuple[str, ...]) -> None:
    result, *_ = run(library, task, *specs, monitor=False)
    assert not result.success
    assert result.category == Category.MISSED


@pytest.mark.parametrize(("task", "specs"), FATAL[:3])
def test_with_it_the_run_plans_again_and_succeeds(library: Library, task: str, specs: tuple[str, ...]) -> None:
    result, *_ = run(library, task, *specs)
    assert result.success
    assert result.replans >= 1


@pytest.mark.parametrize(
    ("task", "spec"),
    [("PnPCounterToCab", "shift@t=1"), ("OpenDrawer", "push:60N,1s@t=5"), ("OpenDrawer", "noise@t=0")],
)
def test_fields_that_follow_their_frames_absorb_it(library: Library, task: str, spec: str) -> None:
    result, *_ = run(library, task, spec, monitor=False)
    assert result.success


def test_the_modulation_leads_around_an_obstacle(library: Library) -> None:
    around, _, touched = run(library, "PnPCounterToCab", "obstacle@t=3", monitor=False)
    assert around.success
    _, _, bumped = run(library, "PnPCounterToCab", "obstacle@t=3", monitor=False, avoid=False)
    assert touched < bumped
