"""Every output of every command: what is there and was not written by the same command stays, unless it is told otherwise."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from symskill_pddl.cli import work
from symskill_pddl.errors import InputError
from symskill_pddl.execution.lines import Header
from symskill_pddl.execution.trace import TraceWriter
from symskill_pddl.library import Library

ROBOSUITE = Path(__file__).parent.parent / "data" / "robosuite"
WORLD = ("--world", "toy_arena:ARENA")
Program = Callable[..., Any]
PRECIOUS = b"precious\n"


@pytest.fixture
def trace(tmp_path: Path) -> Path:
    """A short run."""
    with TraceWriter(tmp_path / "run.jsonl") as writer:
        writer.write(Header(task="StoreIt", seed=3))
    return tmp_path / "run.jsonl"


@pytest.fixture
def toy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A library of the toy world; its made-up skills cannot be written to files."""
    from toy_arena import toy_library

    Library((), (), (), {}).save(tmp_path / "toy")
    monkeypatch.setattr(work, "open_library", lambda _: toy_library())
    return tmp_path / "toy"


def tree(folder: Path) -> dict[Path, bytes]:
    return {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()}


Case = tuple[tuple[object, ...], Path]


@pytest.fixture(params=["import", "export", "problem", "plan", "run", "evaluate", "kept", "report", "picture", "plots"])
def case(request: pytest.FixtureRequest, tmp_path: Path) -> Case:
    """A call, and a file that it writes."""
    out = tmp_path / "out"
    out.mkdir()

    def given(name: str) -> Any:
        return request.getfixturevalue(name)

    match request.param:
        case "import":
            return ("import", ROBOSUITE / "panda_lift.hdf5", "-o", out / "a.hdf5"), out / "a.hdf5"
        case "export":
            return ("export", given("library"), "-o", out), out / "domain.pddl"
        case "problem":
            return ("problem", given("toy"), "--task", "StoreIt", *WORLD, "-o", out / "p.pddl"), out / "p.names.json"
        case "plan":
            return ("plan", *given("toys"), "-o", out / "plan"), out / "plan"
        case "run":
            return ("run", given("toy"), "--task", "StoreIt", *WORLD, "--trace", out / "t"), out / "t"
        case "evaluate":
            return ("evaluate", given("toy"), "--tasks", "OpenUp", "--trials", 1, *WORLD, "-o", out / "r.json"), out / "r.json"
        case "kept":
            # with no step allowed to be planned every episode fails
            fails = ("--planner", "command:false {domain} {problem}", "--tasks", "StoreIt", "--seed", 7, "--trials", 1)
            return ("evaluate", given("toy"), *fails, *WORLD, "-o", tmp_path / "r", "--keep-failed", out), out / "StoreIt-7.jsonl"
        case "report":
            return ("report", given("trace"), "-o", out / "page"), out / "page"
        case "picture":
            library = given("library")
            name = Library.load(library).classifiers[0].predicate.name
            return ("show", library, "--why", name, "--picture", out / "a.svg"), out / "a.svg"
        case "plots":
            pytest.importorskip("matplotlib")
            library = given("library")
            return ("show", library, "--plots", out), out / f"{min(Library.load(library).skills)}-1.png"
    raise AssertionError(request.param)


def test_what_somebody_else_wrote_stays_unless_forced(symskill: Program, case: Case) -> None:
    call, path = case
    path.write_bytes(PRECIOUS)
    before = tree(path.parent)
    done = symskill(*call)
    assert done.status == 2
    assert f"'{path}' is there already" in done.error
    assert done.error.endswith("choose another name, or replace it with --force")
    assert tree(path.parent) == before
    assert symskill(*call, "--force").status in (0, 1)
    assert path.read_bytes() != PRECIOUS
    # what the command wrote it writes again, but demonstrations
    assert symskill(*call).status == (2 if call[0] == "import" else 0)
    left = {p.name for p in path.parent.iterdir()}
    assert not any(name.endswith((".symskill", ".partial", ".partial.jsonl", ".saving")) for name in left)


def test_links_and_pipes_are_refused_also_when_forced(symskill: Program, case: Case, tmp_path: Path) -> None:
    call, path = case
    target = tmp_path / "target"
    target.write_bytes(PRECIOUS)
    path.symlink_to(target)
    done = symskill(*call, "--force")
    assert (done.status, f"'{path}': it is a link to '{target}'; name what it leads to" in done.error) == (2, True)
    path.unlink()
    os.mkfifo(path)
    done = symskill(*call, "--force")
    assert (done.status, f"'{path}': it is a device or a pipe, not an ordinary file" in done.error) == (2, True)
    assert target.read_bytes() == PRECIOUS


@pytest.mark.parametrize("name", ["export", "plots", "learn", "quickstart"])
def test_a_link_to_a_folder_is_no_output(symskill: Program, library: Path, demos: Path, tmp_path: Path, name: str) -> None:
    (tmp_path / "real").mkdir()
    link = tmp_path / "link"
    link.symlink_to("real")
    calls: dict[str, tuple[object, ...]] = {
        "export": ("export", library, "-o", link),
        "plots": ("show", library, "--plots", link),
        "learn": ("learn", demos, "-o", link),
        "quickstart": ("quickstart", "-o", link),
    }
    done = symskill(*calls[name])
    assert (done.status, "link': it is a link to 'real'" in done.error) == (2, True)
    assert list((tmp_path / "real").iterdir()) == []


def test_no_command_writes_over_what_it_reads(
    symskill: Program, toys: tuple[Path, Path], trace: Path, demos: Path, tmp_path: Path
) -> None:
    recording = shutil.copy(ROBOSUITE / "panda_lift.hdf5", tmp_path / "recording.hdf5")
    before = tree(tmp_path)
    for call in (
        ("plan", *toys, "-o", toys[0]),
        ("plan", *toys, "-o", toys[1]),
        ("report", trace, "-o", trace),
        ("import", recording, "-o", recording),
    ):
        done = symskill(*call, "--force")
        assert (done.status, "it is read by the same command; choose another name" in done.error) == (2, True), call
    assert tree(tmp_path) == before


# ------------------------------------------------------------------------------------------------------------------ learn


def test_learn_refuses_a_folder_with_something_in_it(symskill: Program, demos: Path, tmp_path: Path) -> None:
    project = tmp_path / "project"
    for name in ("demos/mine.hdf5", "demos/other.hdf5", "skills/my_skill.npz", "library.json/x"):
        (project / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(demos, project / name)
    before = tree(project)
    for force in ((), ("--force",)):
        done = symskill("learn", demos, "-o", project, *force)
        assert (done.status, done.error) == (2, f"'{project}' is not empty and no library: choose a new folder, or an empty one")
    assert tree(project) == before


def test_learn_replaces_a_library_only_if_forced(symskill: Program, library: Path, demos: Path) -> None:
    (library / "notes.txt").write_bytes(PRECIOUS)
    (library / "skills" / "mine.npz").write_bytes(PRECIOUS)
    (library / "demos" / "mine.hdf5").write_bytes(PRECIOUS)
    before = tree(library)
    other = demos.with_name("other.hdf5")
    demos.rename(other)
    done = symskill("learn", other, "-o", library)
    assert (done.status, done.error) == (2, f"'{library}' holds a library already: --into adds to it, --force replaces it")
    assert tree(library) == before
    own = next(p for p in library.glob("demos/*.hdf5") if p.name != "mine.hdf5")
    done = symskill("learn", own, "-o", library, "--force")
    assert (done.status, "lies in the library" in done.error) == (2, True)
    assert tree(library) == before
    assert symskill("learn", other, "-o", library, "--force").status == 0
    assert set(Library.load(library).recordings) == {"other"}
    index = json.loads((library / "library.json").read_text())
    named = {
        f"{folder}/{entry['file']}"
        for folder, key in (("skills", "skills"), ("demos", "recordings"))
        for entry in index[key].values()
    }
    mine = {"library.json", "notes.txt", "skills/mine.npz", "demos/mine.hdf5"}
    assert {str(p.relative_to(library)) for p in tree(library)} == named | mine


@pytest.mark.parametrize("option", ["-o", "--into"])
def test_learn_holds_the_lock_from_the_beginning(symskill: Program, library: Path, demos: Path, option: str) -> None:
    from symskill_pddl.library_io import writing

    before = tree(library)
    with writing(library):
        done = symskill("learn", demos, option, library, *(["--force"] if option == "-o" else []))
        assert done.status == 2
        assert done.error == f"another program is writing the library '{library}'; wait for it, or choose another -o"
    assert tree(library) == before


def test_into_a_folder_that_is_no_library_makes_nothing(symskill: Program, demos: Path, tmp_path: Path) -> None:
    before = tree(tmp_path)
    assert "library.json" in symskill("learn", demos, "--into", tmp_path / "none").error
    assert "library.json" in symskill("learn", demos, "--into", tmp_path).error
    assert tree(tmp_path) == before
    assert not (tmp_path / "none").exists()


# ------------------------------------------------------------------------------------------------------- edits and results


def test_an_edited_domain_is_not_exported_over(symskill: Program, library: Path, tmp_path: Path) -> None:
    domain = tmp_path / "domain.pddl"
    for _ in range(2):
        assert symskill("export", library, "-o", tmp_path).status == 0
    domain.write_text(domain.read_text().replace("(:action pick", "(:action take"))
    edited = tree(tmp_path)
    done = symskill("export", library, "-o", tmp_path, "--dialect", "all")
    assert (done.status, "is no domain that symskill wrote, or was edited since" in done.error) == (2, True)
    assert tree(tmp_path) == edited
    assert not (tmp_path / "temporal").exists()


def test_a_library_that_is_read_is_not_written_over(symskill: Program, toy: Path) -> None:
    index = toy / "library.json"
    before = index.read_bytes()
    for call in (
        ("problem", toy, "--task", "StoreIt", "-o", index),
        ("run", toy, "--task", "StoreIt", "--trace", index),
        ("evaluate", toy, "--tasks", "OpenUp", "-o", index),
    ):
        done = symskill(*call, *WORLD, "--force")
        assert (done.status, "it is read by the same command" in done.error) == (2, True)
    assert index.read_bytes() == before


def test_a_library_that_changes_while_it_is_evaluated(symskill: Program, toy: Path, tmp_path: Path) -> None:
    first = work.checksum_of(toy)
    assert work.open_unchanged(toy, None, first) is not None
    (toy / "library.json").write_bytes((toy / "library.json").read_bytes() + b" ")
    with pytest.raises(InputError, match="is not the library any more that it was when this began"):
        work.open_unchanged(toy, None, first)


def test_results_of_another_evaluation_stay(symskill: Program, toy: Path, tmp_path: Path) -> None:
    results = tmp_path / "results.json"
    call = ("evaluate", toy, "--tasks", "OpenUp", "--trials", 1, *WORLD, "-o", results)
    assert symskill(*call).status == 0
    before = results.read_bytes()
    assert symskill(*call).status == 0
    assert results.read_bytes() == before
    done = symskill(*call, "--seed", 7)
    assert done.status == 2
    assert done.error == (
        f"'{results}' holds the results of another evaluation (seed 1000, now 7): "
        "choose another -o, or replace them with --force"
    )  # fmt: skip
    assert results.read_bytes() == before
    assert symskill(*call, "--seed", 7, "--force").status == 0
    assert json.loads(results.read_text())["settings"]["seed"] == 7


def test_a_file_that_is_no_evaluation_in_progress_is_not_cut(symskill: Program, toy: Path, tmp_path: Path) -> None:
    partial = tmp_path / "results.json.partial.jsonl"
    for text in ("one line", "one\ntwo\nthree"):
        partial.write_text(text)
        assert symskill("evaluate", toy, "--tasks", "OpenUp", "--trials", 1, *WORLD, "-o", tmp_path / "results.json").status == 2
        assert partial.read_text() == text
