import json
from pathlib import Path

import pytest

from symskill_pddl.errors import FormatError, InputError
from symskill_pddl.evaluation.results import EpisodeResult, Results, Settings, load_results, save_results, summarise
from symskill_pddl.evaluation.statistics import wilson


def episode(seed: int, cause: str = "", time_s: float = 10.0, replans: int = 0, **more: object) -> EpisodeResult:
    return EpisodeResult(
        seed=seed,
        success=not cause,
        category="replan limit" if cause else "success",
        cause=cause,
        reason="",
        replans=replans,
        recoveries=0,
        steps=3,
        time_s=time_s,
        **more,
    )


def results() -> Results:
    episodes = [
        episode(2, "timeout", 99.0, replans=3, troubles={"motion": 2, "grasp": 1}),
        episode(1, time_s=20.0, troubles={"motion": 1}, disturbances=2),
        episode(0),
        episode(3, "grasp"),
    ]
    settings = Settings(library="abc", planner="builtin", monitor=True, disturbances=("close-door@op=2",), seed=0, trials=4)
    return Results(settings=settings, tasks=(summarise("Put", episodes),))


def test_a_summary_counts_and_sorts() -> None:
    (task,) = results().tasks
    assert (task.trials, task.successes) == (4, 2)
    assert task.interval == pytest.approx(wilson(2, 4), abs=1e-4)
    assert task.failures == {"grasp": 1, "timeout": 1}
    assert task.troubles == {"grasp": 1, "motion": 3}
    assert task.disturbances == 2
    assert task.median_time_s == 15.0  # of the successes only
    assert task.max_time_s == 20.0
    assert task.mean_replans == 0.75
    assert [e.seed for e in task.episodes] == [0, 1, 2, 3]


def test_without_success_there_are_no_times() -> None:
    task = summarise("Put", [episode(0, "timeout")])
    assert task.median_time_s is None
    assert task.max_time_s is None
    assert task.interval[0] == 0.0


def test_nothing_cannot_be_summarised() -> None:
    with pytest.raises(InputError, match="no episode"):
        summarise("Put", [])


def test_results_come_back_from_their_file(tmp_path: Path) -> None:
    path = tmp_path / "results.json"
    save_results(path, results())
    assert load_results(path) == results()
    first = path.read_bytes()
    save_results(path, load_results(path))
    assert path.read_bytes() == first


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        ({"schema_version": 1}, "schema_version"),
        ({"format": "something"}, "format"),
        ({"tasks": [{"task": "Put"}]}, "tasks.0.trials"),
        ({"more": 1}, "more"),
    ],
)
def test_a_wrong_file_is_refused_with_the_field(tmp_path: Path, edit: dict[str, object], message: str) -> None:
    path = tmp_path / "results.json"
    path.write_text(json.dumps({**json.loads(results().dumps()), **edit}))
    with pytest.raises(FormatError, match=message):
        load_results(path)


def test_a_missing_or_damaged_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no results file"):
        load_results(tmp_path / "results.json")
    (tmp_path / "results.json").write_text(results().dumps()[:-40])
    with pytest.raises(FormatError, match="not a results file"):
        load_results(tmp_path / "results.json")
