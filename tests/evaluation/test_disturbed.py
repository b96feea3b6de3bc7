"""What each disturbance does to a run: without the monitor it fails, or a field or the modulation absorbs it.

No monitor means that every step of the first plan is carried out once. Most cases begin with a step of the plan, or as soon
as they are possible: they do not hang on a moment.
"""

from __future__ import annotations

from importlib.resources import as_file, files

import pytest

from symskill_pddl.arena import Disturbed
from symskill_pddl.demos import load_demos
from symskill_pddl.evaluation.results import EpisodeResult
from symskill_pddl.evaluation.trial import prepare, run_episode
from symskill_pddl.execution.config import ExecutionConfig, MotionConfig
from symskill_pddl.execution.outcome import Category
from symskill_pddl.kitchen.disturbances import ANY, KINDS
from symskill_pddl.learning import LearnConfig, learn
from symskill_pddl.learning.skills import SkillConfig
from symskill_pddl.library import Library
from symskill_pddl.planning import Builtin

pytestmark = pytest.mark.simulation

QUICK = LearnConfig(skills=SkillConfig(max_fields=4))
TASKS = ("PnPCounterToCab", "OpenDrawer", "OpenSingleDoor", "PnPStoveToCounter", "TurnOnStove", "TurnOnSinkFaucet")
KNOB_2 = "(knob-turned knob-2 stove-2)"


@pytest.fixture(scope="module")
def of_tasks() -> Library:
    """Learned from two of the shipped demonstrations of each of six tasks."""
    with as_file(files("symskill_pddl") / "data" / "kitchen") as folder:
        return learn([d for task in TASKS for d in load_demos(folder / f"{task}.hdf5")[:2]], QUICK)


@pytest.fixture(scope="module")
def of_play() -> Library:
    """Learned from the shipped recording of play."""
    with as_file(files("symskill_pddl") / "data" / "play" / "Play.hdf5") as path:
        return learn(load_demos(path), QUICK)


def run(
    library: Library,
    task: str,
    specs: tuple[str, ...],
    *,
    monitor: bool = False,
    goal: str | None = None,
    track: bool = True,
    avoid: bool = True,
) -> EpisodeResult:
    """The task's first episode under disturbances, all of which happen."""
    episode = prepare(library, task, 0, goal=goal, disturbances=specs)
    config = ExecutionConfig(motion=MotionConfig(track=track, avoid=avoid))
    result, _ = run_episode(library, episode, 0, Builtin(), monitor=monitor, config=config)
    assert isinstance(episode.world, Disturbed)
    assert {text for _, text in episode.world.events} == set(specs)
    return result


FATAL = [
    # task, disturbances, what a run without the monitor misses, another goal than the task's
    ("PnPStoveToCounter", ("drop@op=1",), "food-on-container", None),
    ("PnPCounterToCab", ("close-door@t=0",), "food-in-cabinet", None),
    ("OpenDrawer", ("close-drawer@t=0",), "drawer-open", None),
    ("TurnOnStove", ("close-knob@t=0",), "knob-turned", None),
    ("CookDinner", ("close-knob-2@t=0",), "knob-turned", KNOB_2),
    ("TurnOnSinkFaucet", ("close-lever@op=1",), "lever-turned", None),
    # the hand goes where the thing was
    ("PnPCounterToCab", ("freeze:6s@t=0", "shift:8cm@t=0.1"), "food-in-cabinet", None),
    # the hand is torn off the drawer's handle
    ("OpenDrawer", ("push:120N,2s@op=1",), "drawer-open", None),
    # the bread is put onto the lid
    ("PlayCookAndCover", ("put-lid-back@op=2",), "thing-in-cookware", None),
]


@pytest.mark.parametrize(("task", "specs", "missed", "goal"), FATAL)
def test_a_run_without_the_monitor_fails(
    of_tasks: Library, of_play: Library, task: str, specs: tuple[str, ...], missed: str, goal: str | None
) -> None:
    result = run(of_play if task.startswith("Play") else of_tasks, task, specs, goal=goal)
    assert not result.success
    assert result.category == Category.MISSED
    assert f"({missed} " in result.reason


@pytest.mark.parametrize(("task", "specs", "missed", "goal"), FATAL)
def test_with_it_the_run_plans_again_and_succeeds(
    of_tasks: Library, of_play: Library, task: str, specs: tuple[str, ...], missed: str, goal: str | None
) -> None:
    result = run(of_play if task.startswith("Play") else of_tasks, task, specs, goal=goal, monitor=True)
    assert result.success
    assert result.replans >= 1


@pytest.mark.parametrize(
    ("task", "spec", "missed"),
    [("PnPCounterToCab", "shift@t=1", "food-in-cabinet"), ("PnPStoveToCounter", "move-plate:12cm@op=1", "food-on-container")],
)
def test_fields_that_follow_their_frames_absorb_it_and_others_fail(of_tasks: Library, task: str, spec: str, missed: str) -> None:
    assert run(of_tasks, task, (spec,)).success
    left_behind = run(of_tasks, task, (spec,), track=False)
    assert not left_behind.success
    assert f"({missed} " in left_behind.reason


def test_without_tracking_the_monitor_makes_up_for_a_plate_that_is_moved(of_tasks: Library) -> None:
    result = run(of_tasks, "PnPStoveToCounter", ("move-plate:12cm@op=1",), monitor=True, track=False)
    assert result.success
    assert result.replans >= 1


@pytest.mark.parametrize("spec", ["push@op=1", "noise@t=0"])
def test_fields_absorb_a_little_of_what_is_fatal_in_strength(of_tasks: Library, spec: str) -> None:
    assert run(of_tasks, "OpenDrawer", (spec,)).success


def test_a_run_that_hardly_sees_fails(of_tasks: Library) -> None:
    result = run(of_tasks, "OpenDrawer", ("noise:5cm,20deg@t=0",))
    assert not result.success
    assert "(drawer-open " in result.reason


def test_the_modulation_leads_around_an_obstacle(of_tasks: Library) -> None:
    around = run(of_tasks, "PnPCounterToCab", ("obstacle@t=3",))
    assert around.success
    assert around.touched_s < 0.5
    assert run(of_tasks, "PnPCounterToCab", ("obstacle@t=3",), avoid=False).touched_s > 1.5


def test_no_kind_is_left_out() -> None:
    shown = {spec.split("@")[0].split(":")[0] for _, specs, *_ in FATAL for spec in specs}
    assert shown | {"shift", "move-plate", "noise", "obstacle"} == set(KINDS) - {ANY}
