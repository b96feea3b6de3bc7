"""Commands in a world of one's own, by what every world has to have."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from toy_arena import ToyArena, toy_library

from symskill_pddl.cli import work
from symskill_pddl.errors import MissingDependencyError
from symskill_pddl.library import Library

WORLD = ("--world", "toy_arena:ARENA")


@pytest.fixture
def toys(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A library of the toy world; its made-up skills cannot be written to files."""
    Library((), (), (), {}).save(tmp_path / "library")
    monkeypatch.setattr(work, "open_library", lambda _: toy_library())
    return tmp_path / "library"


def test_a_task_is_posed_and_run_there(symskill: Callable[..., Any], toys: Path, tmp_path: Path) -> None:
    episode = ("--task", "StoreIt", "--seed", 1, *WORLD)
    problem, trace = tmp_path / "problem.pddl", tmp_path / "trace.jsonl"
    assert symskill("problem", toys, *episode, "-o", problem).status == 0
    assert "(food-in-cabinet cheese cabinet-1)" in problem.read_text()
    done = symskill("run", toys, *episode, "--trace", trace, "--json")
    assert (done.status, json.loads(done.out)["success"]) == (0, True), done.err
    replayed = symskill("replay", trace)
    assert (replayed.status, "StoreIt in toy_arena:ARENA, seed 1" in replayed.out) == (0, True)
    assert json.loads(symskill("replay", trace, "--json").out)["world"] == "toy_arena:ARENA"
    page = tmp_path / "run.html"
    assert symskill("report", trace, "-o", page).status == 0
    assert "toy_arena:ARENA" in page.read_text()


def test_it_is_evaluated_there(symskill: Callable[..., Any], toys: Path, tmp_path: Path) -> None:
    results, page = tmp_path / "results.json", tmp_path / "results.html"
    call = ("evaluate", toys, "--suite", "both", "--trials", 2, *WORLD, "--against", "monitor", "--json", "-o", results)
    done = symskill(*call)
    document = json.loads(done.out)
    assert (done.status, document["settings"]["world"]) == (0, "toy_arena:ARENA"), done.err
    assert [task["successes"] for task in document["tasks"]] == [2, 2]
    assert {row["task"] for row in document["against"]["monitor"]} == {"OpenUp", "PutIn", "all"}
    assert symskill("report", results, "-o", page).status == 0
    assert "toy_arena:ARENA" in page.read_text()


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (("run", "--task", "StoreIt", "--world", "moon"), "unknown world 'moon'; there are: kitchen"),
        (("evaluate", "--tasks", "StoreIt", "--world", "moon"), "unknown world 'moon'; there are: kitchen"),
        (("problem", "--task", "StoreIt", "--world", "moon"), "unknown world 'moon'; there are: kitchen"),
        (("run", "--task", "StoreCheese", *WORLD), "unknown task 'StoreCheese'; the world 'toy' has: OpenUp"),
        (("run", "--task", "StoreIt", "--disturb", "drop@t=3", *WORLD), "disturbance 'drop@t=3': nothing goes wrong"),
        (("evaluate", "--tasks", "StoreIt", "--disturb", "drop@t=3", *WORLD), "disturbance 'drop@t=3': nothing goes wrong"),
        (("evaluate", "--suite", "disturbed", *WORLD), "unknown suite 'disturbed'; there are: atomic, both, composed"),
        (("run", "--task", "StoreIt", "--video", "run.mp4", *WORLD), "--video: the world 'toy_arena:ARENA' cannot be filmed"),
    ],
)
def test_what_a_world_does_not_have_is_refused(
    symskill: Callable[..., Any], toys: Path, tmp_path: Path, command: tuple[str, ...], message: str
) -> None:
    name, *options = command
    old = tmp_path / "old"
    old.write_text("precious")
    done = symskill(name, toys, *options, "--trace" if name == "run" else "-o", old)
    assert done.status == 2
    assert message in done.error
    assert old.read_text() == "precious"


def test_nothing_is_recorded_where_there_is_no_demonstrator(symskill: Callable[..., Any], tmp_path: Path) -> None:
    done = symskill("record", "StoreIt", *WORLD, "-o", tmp_path / "demos.hdf5")
    assert done.status == 2
    assert "the world 'toy_arena:ARENA' has no demonstrator" in done.error
    assert "unknown world 'moon'" in symskill("record", "StoreIt", "--world", "moon", "-o", tmp_path / "demos.hdf5").error


@pytest.mark.parametrize(
    "command",
    [
        ("run", "--task", "OpenUp", "--trace"),
        ("problem", "--task", "OpenUp", "-o"),
        ("evaluate", "--tasks", "OpenUp", "-o"),
        ("record", "-n", "1", "-o"),
    ],
)
def test_a_missing_simulator_is_said_before_anything_else(
    symskill: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: tuple[str, ...]
) -> None:
    def check_ready(_: ToyArena) -> None:
        raise MissingDependencyError("no simulator here")

    monkeypatch.setattr(ToyArena, "check_ready", check_ready, raising=False)
    monkeypatch.setattr(ToyArena, "record", None, raising=False)
    name, *options = command
    # the library does not exist, which nobody should hear of
    about = "OpenUp" if name == "record" else tmp_path / "library"
    done = symskill(name, about, *WORLD, *options, tmp_path / "written")
    assert (done.status, done.error) == (2, "no simulator here")
    assert list(tmp_path.iterdir()) == []


def test_a_negative_seed_is_refused(symskill: Callable[..., Any], toys: Path, tmp_path: Path) -> None:
    for command in (("run",), ("problem", "-o", tmp_path / "problem.pddl")):
        done = symskill(command[0], toys, "--task", "OpenUp", "--seed", -1, *WORLD, *command[1:])
        assert (done.status, done.error) == (2, "a seed is at least 0, got -1")
