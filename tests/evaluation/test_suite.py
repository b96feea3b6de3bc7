from pathlib import Path

import pytest

from symskill_pddl.errors import InputError, MissingDependencyError
from symskill_pddl.evaluation import suite as suites
from symskill_pddl.evaluation.results import EpisodeResult
from symskill_pddl.evaluation.spread import Processes
from symskill_pddl.evaluation.suite import ERROR, Suite, chosen, presets, run_one, run_suite, tasks_named
from symskill_pddl.execution.config import ExecutionConfig, MotionConfig
from symskill_pddl.execution.lines import Header
from symskill_pddl.execution.trace import TraceWriter, read_trace
from symskill_pddl.kitchen import TASKS
from symskill_pddl.kitchen.arena import ARENA
from symskill_pddl.kitchen.disturbances import KINDS
from symskill_pddl.library import Library

EMPTY = Library((), (), (), {})


def load_empty(path: Path) -> Library:
    assert path == Path("library")
    return EMPTY


def test_tasks_are_all_or_named() -> None:
    assert tasks_named(ARENA, "all") == tuple(name for name, spec in TASKS.items() if not spec.kind.startswith("play"))
    assert tasks_named(ARENA, "StoreCheese, OpenSingleDoor") == ("StoreCheese", "OpenSingleDoor")
    with pytest.raises(InputError, match="no task named"):
        tasks_named(ARENA, " , ")


def test_every_preset_is_a_suite() -> None:
    found = presets(ARENA)
    for preset in found.values():
        Suite(preset.tasks, 1, 0, disturbances=preset.disturbances)
    every = {task for name in ("atomic", "composed", "play") for task in found[name].tasks}
    assert every == set(TASKS) - {"Play"}
    assert chosen(ARENA, None, "disturbed").disturbances
    assert chosen(ARENA, None, "mixed").disturbances == ("any@p=0.005",)
    assert set(KINDS) - {"any"} < set(found)
    assert {"OpenDrawer", "CloseDrawer"} <= set(chosen(ARENA, None, "close-drawer").tasks)
    assert "OpenSingleDoor" not in chosen(ARENA, None, "close-drawer").tasks
    assert "OpenDrawer" not in chosen(ARENA, None, "drop").tasks
    assert chosen(ARENA, "StoreCheese", None).tasks == ("StoreCheese",)


@pytest.mark.parametrize(("tasks", "preset"), [(None, None), ("all", "atomic"), (None, "impossible")])
def test_one_of_tasks_and_preset(tasks: str | None, preset: str | None) -> None:
    with pytest.raises(InputError, match=r"atomic, close-door, .*, composed, disturbed, drop"):
        chosen(ARENA, tasks, preset)


def test_the_settings_say_what_is_switched_off(monkeypatch: pytest.MonkeyPatch) -> None:
    heard: list[ExecutionConfig] = []

    def refuse(*_: object, config: ExecutionConfig, **__: object) -> None:
        heard.append(config)
        raise InputError("no episode within reach")

    monkeypatch.setattr(suites, "prepare", lambda *_, **__: None)
    monkeypatch.setattr(suites, "run_episode", refuse)
    config = ExecutionConfig(resample=False, motion=MotionConfig(avoid=False))
    results = run_suite(load_empty, Path("library"), Suite(("StoreCheese",), 1, 5, config=config))
    assert heard == [config]
    found = results.settings
    assert (found.resampling, found.replanning, found.obstacles) == (False, True, False)


def test_a_suite_has_every_task_with_every_seed() -> None:
    suite = Suite(("OpenSingleDoor", "StoreCheese"), trials=2, seed=7)
    assert suite.episodes == (("OpenSingleDoor", 7), ("OpenSingleDoor", 8), ("StoreCheese", 7), ("StoreCheese", 8))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"tasks": ()}, "one or more different tasks"),
        ({"tasks": ("StoreCheese", "StoreCheese")}, "different tasks"),
        ({"tasks": ("StoreMoon",)}, "unknown task 'StoreMoon'"),
        ({"trials": 0}, "at least one trial"),
        ({"seed": -1}, "seed"),
        ({"planner": "oracle"}, "unknown planner"),
        ({"disturbances": ("earthquake@t=1",)}, "earthquake"),
    ],
)
def test_a_wrong_suite_is_refused_before_it_runs(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Suite(**{"tasks": ("StoreCheese",), "trials": 1, "seed": 0, **arguments})  # type: ignore[arg-type]


def test_jobs_have_to_be_positive() -> None:
    with pytest.raises(InputError, match="job"):
        Processes(0)


def test_what_cannot_be_set_up_is_a_failure_with_its_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise InputError("no episode within reach")

    monkeypatch.setattr(suites, "prepare", refuse)
    results = run_suite(load_empty, Path("library"), Suite(("StoreCheese",), 3, 5))
    (task,) = results.tasks
    assert task.failures == {ERROR: 3}
    assert [(e.seed, e.reason) for e in task.episodes] == [(s, "no episode within reach") for s in (5, 6, 7)]


def test_a_missing_package_is_no_failed_episode(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise MissingDependencyError("robosuite is not installed")

    monkeypatch.setattr(suites, "prepare", refuse)
    with pytest.raises(MissingDependencyError):
        run_one(EMPTY, Suite(("StoreCheese",), 1, 0), "StoreCheese", 0)


@pytest.mark.simulation
def test_results_do_not_depend_on_the_number_of_processes() -> None:
    # an empty library has no goals, so nothing is simulated for long, but every process sets its episodes up
    suite = Suite(("StoreCheese", "OpenSingleDoor"), trials=2, seed=3)
    alone = run_suite(load_empty, Path("library"), suite)
    assert run_suite(load_empty, Path("library"), suite, pool=Processes(2)).dumps() == alone.dumps()
    assert alone.tasks[0].failures == {ERROR: 2}
    assert "learned no goal" in alone.tasks[0].episodes[0].reason


def test_the_traces_of_failed_episodes_are_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def made_up(library: Library, episode: object, seed: int, planner: object, *, trace: TraceWriter, **_: object) -> object:
        trace.write(Header(seed=seed))
        good = seed % 2 == 0
        return EpisodeResult(
            seed=seed, success=good, category="", reason="", replans=0, recoveries=0, steps=0, time_s=0.0
        ), None  # fmt: skip

    monkeypatch.setattr(suites, "prepare", lambda *_, **__: None)
    monkeypatch.setattr(suites, "run_episode", made_up)
    run_suite(load_empty, Path("library"), Suite(("StoreCheese",), 4, 0), failed=tmp_path)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["StoreCheese-1.jsonl", "StoreCheese-3.jsonl"]
    assert read_trace(tmp_path / "StoreCheese-3.jsonl").header.seed == 3
