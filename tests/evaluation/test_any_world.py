"""An evaluation in a world that this package has never heard of, by what every world has to have."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from toy_arena import ARENA, ToyEpisode, toy_library

from symskill_pddl.arena import Arena, Disturbed, Filmable, Recordable
from symskill_pddl.errors import InputError
from symskill_pddl.evaluation.ablations import without
from symskill_pddl.evaluation.results import load_results, save_results
from symskill_pddl.evaluation.spread import Processes
from symskill_pddl.evaluation.suite import Suite, chosen, presets, run_suite
from symskill_pddl.evaluation.trial import prepare, run_episode
from symskill_pddl.library import Library
from symskill_pddl.planning import Builtin
from symskill_pddl.symbols import Atom

WORLD = "toy_arena:ARENA"
TESTS = Path(__file__).parents[1]


def load(path: Path) -> Library:
    assert path == Path("library")
    return toy_library()


def test_the_toy_is_an_arena_and_no_more_than_that() -> None:
    assert isinstance(ARENA, Arena)
    assert not isinstance(ARENA, Recordable | Filmable)
    assert not isinstance(ToyEpisode("OpenUp", 0), Disturbed)


def test_a_task_made_of_others_is_planned_and_carried_out() -> None:
    library = toy_library()
    episode = prepare(library, "StoreIt", 3, world=WORLD)
    assert episode.problem.goal == {Atom("door-open", ("door", "cabinet")), Atom("food-in-cabinet", ("cheese", "cabinet"))}
    result, outcome = run_episode(library, episode, 3, Builtin())
    assert result.success, result.reason
    assert [s.step.split()[0].strip("(") for s in outcome.steps] == [
        "reach-closed-door", "open-door", "pick-from-counter", "place-in-cabinet",
    ]  # fmt: skip
    assert (result.disturbances, result.touched_s) == (0, 0.0)


def test_a_suite_runs_in_it_and_its_results_say_so(tmp_path: Path) -> None:
    suite = Suite(("OpenUp", "PutIn"), trials=2, seed=3, world=WORLD)
    results = run_suite(load, Path("library"), suite)
    assert [task.successes for task in results.tasks] == [2, 2]
    assert '"world": "toy_arena:ARENA"' in results.dumps()
    save_results(tmp_path / "results.json", results)
    assert load_results(tmp_path / "results.json") == results
    assert run_suite(load, Path("library"), suite, pool=Processes(2)).dumps() == results.dumps()
    assert without(suite, "monitor").world == WORLD


def test_of_the_default_world_the_file_says_nothing() -> None:
    # as the files of earlier versions, which knew one world only
    settings = Suite(("StoreCheese",), 1, 0).settings("abc")
    assert settings.world == "kitchen"
    assert "world" not in settings.model_dump_json()


def test_its_suites_are_its_own() -> None:
    assert set(presets(ARENA)) == {"atomic", "composed", "both"}
    assert chosen(ARENA, "all", None).tasks == ("OpenUp", "PutIn", "StoreIt")
    assert chosen(ARENA, None, "both").tasks == ("OpenUp", "PutIn")
    with pytest.raises(InputError, match="unknown suite 'disturbed'; there are: atomic, both, composed"):
        chosen(ARENA, None, "disturbed")


def test_what_it_does_not_have_is_refused_before_anything_runs() -> None:
    with pytest.raises(InputError, match="unknown task 'StoreCheese'; the world 'toy' has: OpenUp, PutIn, StoreIt"):
        Suite(("StoreCheese",), 1, 0, world=WORLD)
    with pytest.raises(InputError, match="'drop@t=3': nothing goes wrong in the toy world"):
        Suite(("OpenUp",), 1, 0, disturbances=("drop@t=3",), world=WORLD)
    with pytest.raises(InputError, match="'drop@t=3': nothing goes wrong in the toy world"):
        prepare(toy_library(), "OpenUp", 0, world=WORLD, disturbances=("drop@t=3",))


def test_no_other_world_is_loaded_for_it() -> None:
    code = (
        "import sys; from toy_arena import toy_library; from symskill_pddl.evaluation.suite import Suite, run_one; "
        f"print(run_one(toy_library(), Suite(('PutIn',), 1, 0, world={WORLD!r}), 'PutIn', 0).success, "
        "*sorted(m for m in sys.modules if m.split('.')[0] in ('mujoco', 'robosuite') or m.startswith('symskill_pddl.kitchen')))"
    )
    path = f"{TESTS}:{TESTS.parent}"
    done = subprocess.run([sys.executable, "-c", code], env={"PYTHONPATH": path}, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["True"]
