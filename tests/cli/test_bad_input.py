"""Bad input: one line that says what and where, the right exit status, and files as they were."""

from __future__ import annotations

import json
import re
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import pytest

ROBOSUITE = Path(__file__).parent.parent / "data" / "robosuite"


@pytest.fixture
def old(tmp_path: Path) -> Path:
    """A file that must not change."""
    path = tmp_path / "old.hdf5"
    path.write_bytes(b"precious")
    return path


def test_a_missing_demonstration_file(symskill: Callable[..., Any], tmp_path: Path) -> None:
    done = symskill("learn", tmp_path / "none.hdf5", "-o", tmp_path / "library")
    assert done.status == 2
    assert "none.hdf5" in done.error
    assert "does not exist" in done.error or "there is no" in done.error
    assert not (tmp_path / "library").exists()


def test_a_truncated_demonstration_file(symskill: Callable[..., Any], demos: Path, tmp_path: Path) -> None:
    whole = demos.read_bytes()
    cut = tmp_path / "cut.hdf5"
    cut.write_bytes(whole[: len(whole) * 2 // 3])
    done = symskill("learn", demos, cut, "-o", tmp_path / "library")
    assert done.status == 2
    assert "cut.hdf5" in done.error
    assert not (tmp_path / "library").exists()


def test_a_library_survives_a_failed_learn(symskill: Callable[..., Any], library: Path, tmp_path: Path) -> None:
    before = {p: p.read_bytes() for p in library.rglob("*") if p.is_file()}
    (tmp_path / "noise.hdf5").write_bytes(b"no hdf5")
    assert symskill("learn", tmp_path / "noise.hdf5", "-o", library).status == 2
    assert {p: p.read_bytes() for p in library.rglob("*") if p.is_file()} == before


def test_two_files_with_one_name(symskill: Callable[..., Any], demos: Path, tmp_path: Path) -> None:
    (tmp_path / "more").mkdir()
    twin = shutil.copy(demos, tmp_path / "more" / demos.name)
    assert "one name" in symskill("learn", demos, twin, "-o", tmp_path / "library").error


def test_a_recording_of_two_arms(symskill: Callable[..., Any], tmp_path: Path, old: Path) -> None:
    recording = tmp_path / "handover.hdf5"
    shutil.copy(ROBOSUITE / "panda_lift.hdf5", recording)
    with h5py.File(recording, "r+") as file:
        file["data"].attrs["env_info"] = json.dumps({"robots": ["Panda", "Panda"]})
    done = symskill("import", recording, "-o", old, "--force")
    assert done.status == 2
    assert "one arm" in done.error
    assert "handover.hdf5" in done.error
    assert old.read_bytes() == b"precious"


@pytest.mark.parametrize(
    ("given", "message"),
    [("cubeA", "expected OBJECT=TYPE"), ("moon=rock", "unknown object 'moon'"), ("=rock", "expected OBJECT=TYPE")],
)
def test_a_wrong_type_option(symskill: Callable[..., Any], old: Path, given: str, message: str) -> None:
    done = symskill("import", ROBOSUITE / "panda_lift.hdf5", "--type", given, "-o", old, "--force")
    assert done.status == 2
    assert message in done.error
    assert old.read_bytes() == b"precious"


def test_an_unknown_task(symskill: Callable[..., Any], library: Path, old: Path, tmp_path: Path) -> None:
    calls = (
        ("record", "FlyToTheMoon", "-o", old),
        ("problem", library, "--task", "FlyToTheMoon", "-o", old),
        ("run", library, "--task", "FlyToTheMoon", "--trace", old),
        ("evaluate", library, "--tasks", "StoreCheese,FlyToTheMoon", "-o", old),
        ("quickstart", "--task", "FlyToTheMoon", "-o", tmp_path / "out"),
    )
    for call in calls:
        done = symskill(*call)
        assert (call[0], done.status) == (call[0], 2)
        assert "unknown task 'FlyToTheMoon'" in done.error
        assert "StoreCheese" in done.error
    assert old.read_bytes() == b"precious"


def test_output_that_cannot_be_written_is_found_before_the_work(
    symskill: Callable[..., Any], library: Path, tmp_path: Path
) -> None:
    nowhere = tmp_path / "no" / "file"
    calls = (
        ("record", "StoreCheese", "-o", nowhere),
        ("evaluate", library, "--tasks", "all", "-o", nowhere),
        ("run", library, "--task", "StoreCheese", "--trace", nowhere),
        ("import", ROBOSUITE / "panda_lift.hdf5", "-o", tmp_path),
    )
    for call in calls:
        done = symskill(*call)
        assert done.status == 2
        assert "cannot write" in done.error


def test_evaluations_that_cannot_be(symskill: Callable[..., Any], library: Path, tmp_path: Path) -> None:
    def refused(*options: str) -> str:
        done = symskill("evaluate", library, "--tasks", "all", *options, "-o", tmp_path / "r.json")
        assert done.status == 2
        assert not list(tmp_path.glob("r.*"))
        return str(done.error)

    assert "unknown mechanism 'luck'; there are: monitor, obstacles, replanning" in refused("--against", "luck")
    assert "without tracking needs an evaluation with it" in refused("--no-tracking", "--against", "tracking")
    assert "names a mechanism twice: monitor, monitor" in refused("--against", "monitor", "--against", "monitor")
    assert "at least one job, got 0" in refused("--jobs", "0")


@pytest.mark.parametrize("command", ["run", "quickstart"])
def test_a_film_that_cannot_be_made_is_found_before_the_work(
    symskill: Callable[..., Any], library: Path, tmp_path: Path, command: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def call(video: Path) -> str:
        arguments = ("run", library, "--task", "OpenDrawer") if command == "run" else ("quickstart", "-o", tmp_path / "out")
        done = symskill(*arguments, "--video", video)
        assert done.status == 2
        assert not (tmp_path / "out").exists()
        return str(done.error)

    assert "give a name that ends in .mp4" in call(tmp_path / "film.avi")
    assert "cannot write" in call(tmp_path / "no" / "film.mp4")
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    assert "pip install imageio-ffmpeg" in call(tmp_path / "film.mp4")


@pytest.mark.parametrize("command", ["show", "export"])
def test_a_folder_that_is_no_library(symskill: Callable[..., Any], tmp_path: Path, command: str) -> None:
    done = symskill(command, tmp_path, *(["-o", tmp_path / "pddl"] if command == "export" else []))
    assert done.status == 2
    assert "library.json" in done.error
    assert not (tmp_path / "pddl").exists()


def test_a_damaged_library(symskill: Callable[..., Any], library: Path) -> None:
    arrays = min(library.glob("skills/*.npz"))
    data = bytearray(arrays.read_bytes())
    data[len(data) // 2] ^= 1
    arrays.write_bytes(bytes(data))
    done = symskill("show", library)
    assert done.status == 2
    assert arrays.name in done.error


def test_an_unknown_dialect_or_rename(symskill: Callable[..., Any], library: Path, tmp_path: Path) -> None:
    out = tmp_path / "pddl"
    assert "unknown dialect 'lisp'" in symskill("export", library, "-o", out, "--dialect", "lisp").error
    names = tmp_path / "renames.json"
    names.write_text('{"renames": {"moon": "sun"}}')
    assert "cannot rename 'moon'" in symskill("export", library, "-o", out, "--names", names).error
    names.write_text('{"moon": "sun"}')
    assert "renames.json" in symskill("export", library, "-o", out, "--names", names).error
    assert not out.exists()


def test_a_report_of_something_else(symskill: Callable[..., Any], tmp_path: Path) -> None:
    page, source = tmp_path / "page.html", tmp_path / "source"
    page.write_text("old page")
    assert "source" in symskill("report", source, "-o", page).error
    source.write_text("{}")
    assert "not a results file" in symskill("report", source, "-o", page).error
    source.write_text("hello\n")
    assert "source:1" in symskill("report", source, "-o", page).error
    assert page.read_text() == "old page"


def test_an_edited_plan(symskill: Callable[..., Any], library: Path, tmp_path: Path) -> None:
    symskill("export", library, "-o", tmp_path)
    domain, problem, plan = tmp_path / "domain.pddl", tmp_path / "problem.pddl", tmp_path / "plan.txt"
    problem.write_text(
        "(define (problem p) (:domain learned) (:objects cube-1 - cube table-1 - table)\n"
        "(:init (gripper-open)) (:goal (and (gripper-open))))"
    )
    action = domain.read_text().split("(:action ")[1].split()[0]
    wrong = {
        f"({action} moon table-1)": "plan.txt:1:1: '.*' names the unknown object 'moon'",
        f"({action} cube-1 cube-1)": "plan.txt:1:1: .* needs a table for .table, 'cube-1' is a cube",
        f"({action} cube-1)": "plan.txt:1:1: .* takes 2 arguments",
        "(dance cube-1)": "plan.txt:1:1: unknown operator 'dance'",
        f"({action} cube-1 table-1)": "plan.txt: plan step 1 .* needs ",
    }
    for text, message in wrong.items():
        plan.write_text(text + "\n")
        done = symskill("check", library, domain, problem, plan)
        assert done.status == 2
        assert re.search(message, done.error), done.error
