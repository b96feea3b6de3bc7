"""import, inspect, and a problem from a moment of a recording, as a person would call them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from symskill_pddl.demos import load_demos

ROBOSUITE = Path(__file__).parent.parent / "data" / "robosuite"
Program = Callable[..., Any]


@pytest.fixture
def stack(symskill: Program, tmp_path: Path) -> Path:
    path = tmp_path / "stack.hdf5"
    done = symskill("import", ROBOSUITE / "panda_stack.hdf5", "-o", path, "--type", "cubeA=cube", "--type", "cubeB=cube")
    assert done.status == 0
    assert "1 demonstrations of Stack" in done.err
    return path


def test_a_choice_of_episodes_and_a_task_of_ones_own(symskill: Program, tmp_path: Path) -> None:
    path = tmp_path / "lift.hdf5"
    done = symskill("import", ROBOSUITE / "panda_lift.hdf5", "-o", path, "--demo", "demo_3", "--task", "Raise")
    assert done.status == 0
    assert [(d.name, d.task) for d in load_demos(path)] == [("demo_3", "Raise")]
    first = tmp_path / "first.hdf5"
    assert symskill("import", ROBOSUITE / "panda_lift.hdf5", "-o", first, "-n", 1).status == 0
    assert [d.name for d in load_demos(first)] == ["demo_1"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--demo", "demo_9"), "there is no episode 'demo_9'; it has: demo_1, demo_3"),
        (("--filter-key", "good"), "there is no filter key 'good'; it has: none"),
        (("-n", 0), "at least 1 episode has to be imported, got 0"),
        (("--gripper-column", 7), "an action has 7 numbers, there is no column 7"),
        (("--gripper-open", 1), "--gripper-open -1"),
    ],
)
def test_a_choice_that_does_not_fit(symskill: Program, tmp_path: Path, options: tuple[object, ...], message: str) -> None:
    done = symskill("import", ROBOSUITE / "panda_lift.hdf5", "-o", tmp_path / "lift.hdf5", *options)
    assert done.status == 2
    assert message in done.error
    assert not (tmp_path / "lift.hdf5").exists()


@pytest.mark.parametrize("command", [("import", "-o", "out.hdf5"), ("inspect",)])
def test_a_table_of_numbers_is_no_recording(symskill: Program, tmp_path: Path, command: tuple[str, ...]) -> None:
    (tmp_path / "poses.csv").write_text("time,x,y,z\n0,1,2,3\n")
    done = symskill(command[0], tmp_path / "poses.csv", *command[1:])
    assert done.status == 2
    assert "is no HDF5 file but a text file; poses of one's own become demonstrations" in done.error


def test_inspect_tells_and_draws(symskill: Program, stack: Path, tmp_path: Path) -> None:
    done = symskill("inspect", stack, "--picture", tmp_path / "stack.svg")
    assert done.status == 0
    assert "stack:demo_1 (Stack): 26.5 s, 20 samples per second" in done.out
    assert "the fingers follow the command (100%)" in done.out
    assert "up: +z" in done.out
    assert (tmp_path / "stack.svg").read_text().startswith("<svg")


def test_inspect_reads_a_simulators_recording_and_answers_in_json(symskill: Program) -> None:
    done = symskill("inspect", ROBOSUITE / "panda_lift.hdf5", ROBOSUITE / "panda_door.hdf5", "--json")
    assert done.status == 0
    document = json.loads(done.out)
    assert [r["where"] for r in document["recordings"]] == ["panda_lift:demo_1", "panda_lift:demo_3", "panda_door:demo_1"]
    moved = {track["name"] for track in document["recordings"][2]["tracks"] if track["moves"]}
    assert moved == {"door", "latch"}
    assert any("ends with a closed gripper" in line for line in document["suspicious"])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "say where the problem comes from: --task TASK of a world, or --from demos.hdf5:demo_0@0s"),
        (("--task", "StoreCheese", "--from", "a.hdf5"), "say where the problem comes from"),
        (("--task", "StoreCheese", "--goal-at", "END"), "--goal-at belongs to --from"),
    ],
)
def test_a_problem_comes_from_one_place(symskill: Program, tmp_path: Path, options: tuple[str, ...], message: str) -> None:
    done = symskill("problem", tmp_path, "-o", tmp_path / "p.pddl", *options)
    assert done.status == 2
    assert message in done.error


def test_a_plan_from_a_recordings_first_moment(
    symskill: Program, stack: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert symskill("learn", stack, "-o", "lib").status == 0
    assert symskill("export", "lib", "-o", "pddl").status == 0
    done = symskill("problem", "lib", "--from", "stack.hdf5:demo_1@0s", "--goal-at", "END", "-o", "pddl/problem.pddl")
    assert done.status == 0
    assert "; stack:demo_1 at 0 s" in Path("pddl/problem.pddl").read_text()
    done = symskill("plan", "pddl/domain.pddl", "pddl/problem.pddl")
    assert done.status == 0
    assert "pick" in done.out
    done = symskill("problem", "lib", "--from", "stack.hdf5:demo_2@0s", "-o", "pddl/problem.pddl")
    assert "has no demonstration 'demo_2'; is 'demo_1' meant? It has: demo_1" in done.error
