"""Commands on a library that was learned from a person's recording: import, learn, show, export, check."""

from __future__ import annotations

import gzip
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

ROBOSUITE = Path(__file__).parent.parent / "data" / "robosuite"


def test_a_recording_becomes_a_library(symskill: Callable[..., Any], tmp_path: Path, lift: Path) -> None:
    demos, library = tmp_path / "lift.hdf5", tmp_path / "library"
    done = symskill("import", ROBOSUITE / "panda_lift.hdf5", "-o", demos)
    assert (done.status, done.out) == (0, "")
    assert "cube - cube" in done.err
    assert demos.read_bytes() == (lift / "lift.hdf5").read_bytes()
    done = symskill("learn", demos, "-o", library)
    assert (done.status, done.out) == (0, "")
    # the same demonstrations, the same bytes
    made = {p.relative_to(library): p.read_bytes() for p in library.rglob("*") if p.is_file()}
    assert made == {p.relative_to(lift / "library"): p.read_bytes() for p in (lift / "library").rglob("*") if p.is_file()}


def test_types_can_be_given(symskill: Callable[..., Any], tmp_path: Path) -> None:
    done = symskill("import", ROBOSUITE / "panda_lift.hdf5", "--type", "cube=toy", "-o", tmp_path / "lift.hdf5")
    assert done.status == 0
    assert "cube - toy" in done.err


def test_show_prints_tables_or_one_document(symskill: Callable[..., Any], library: Path) -> None:
    tables, document = symskill("show", library), json.loads(symskill("show", library, "--json").out)
    assert (tables.status, tables.err) == (0, "")
    names = [p["name"] for p in document["predicates"]] + [o["name"] for o in document["operators"]]
    assert "gripper-open" in names
    for name in names:
        assert name in tables.out
    assert [p["learned"] for p in document["predicates"]].count(False) == 1
    for operator in document["operators"]:
        assert operator["skill"] in document["skills"]
        assert operator["support"] == len(operator["demonstrations"]) > 0
        assert operator["skill"] in tables.out


@pytest.mark.parametrize("dialect", ["strips", "negative", "costs", "temporal"])
def test_what_is_exported_is_found_to_be_what_was_learned(
    symskill: Callable[..., Any], library: Path, tmp_path: Path, dialect: str
) -> None:
    done = symskill("export", library, "-o", tmp_path, "--dialect", dialect, "--name", "toys")
    assert (done.status, done.out) == (0, "")
    text = (tmp_path / "domain.pddl").read_text()
    assert "(define (domain toys)" in text
    checked = symskill("check", library, tmp_path / "domain.pddl", "--json")
    assert checked.status == 0, checked.err
    assert json.loads(checked.out)["findings"] == []


def test_two_exports_differ_in_nothing(symskill: Callable[..., Any], library: Path, tmp_path: Path) -> None:
    for folder in ("a", "b"):
        symskill("export", library, "-o", tmp_path / folder)
    for name in ("domain.pddl", "names.json"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_renamed_things_are_still_bound(symskill: Callable[..., Any], library: Path, tmp_path: Path) -> None:
    operator = json.loads(symskill("show", library, "--json").out)["operators"][0]["name"]
    renames = tmp_path / "renames.json"
    renames.write_text(json.dumps({"renames": {operator: "do-it", "gripper-open": "hand-empty"}}))
    assert symskill("export", library, "-o", tmp_path, "--names", renames).status == 0
    text = (tmp_path / "domain.pddl").read_text()
    assert "(:action do-it" in text
    assert "(hand-empty)" in text
    document = json.loads(symskill("check", library, tmp_path / "domain.pddl", "--json").out)
    assert document["findings"] == []
    assert {"action": "do-it", "operator": operator} in [{k: b[k] for k in ("action", "operator")} for b in document["bindings"]]


def test_an_action_without_a_skill_fails_the_check(symskill: Callable[..., Any], library: Path, tmp_path: Path) -> None:
    symskill("export", library, "-o", tmp_path)
    domain = tmp_path / "domain.pddl"
    domain.write_text(
        domain.read_text().rstrip().removesuffix(")") + "(:action fly :parameters () :effect (and (not (gripper-open)))))"
    )
    done = symskill("check", library, domain)
    assert done.status == 1
    assert "error: action 'fly': no skill belongs to it" in done.out


def test_recordings_of_robocasa_are_known_by_themselves(symskill: Callable[..., Any], tmp_path: Path) -> None:
    recording = tmp_path / "door.hdf5"
    recording.write_bytes(gzip.decompress((ROBOSUITE.parent / "robocasa" / "demo.hdf5.gz").read_bytes()))
    done = symskill("import", recording, "-o", tmp_path / "demos.hdf5")
    assert done.status == 0
    assert "2 demonstrations of OpenSingleDoor, 2 s; objects: door - door, cabinet - cabinet" in done.err
    refused = symskill("import", recording, "--type", "door=gate", "-o", tmp_path / "other.hdf5")
    assert refused.status == 2
    assert "--type is for recordings of robosuite" in refused.error


@pytest.fixture(scope="module")
def people(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A person's door and stack, imported."""
    from symskill_pddl.demos import import_robosuite, save_demos

    folder = tmp_path_factory.mktemp("people")
    for name in ("door", "stack"):
        save_demos(folder / f"{name}.hdf5", import_robosuite(ROBOSUITE / f"panda_{name}.hdf5"))
    return folder


def content(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_adding_to_a_library_is_learning_from_all(symskill: Callable[..., Any], people: Path, tmp_path: Path) -> None:
    door, stack, grown = people / "door.hdf5", people / "stack.hdf5", tmp_path / "grown"
    assert symskill("learn", stack, door, "-o", tmp_path / "all").status == 0
    # the original files are not needed: the library has its own
    copy = tmp_path / "stack.hdf5"
    copy.write_bytes(stack.read_bytes())
    assert symskill("learn", copy, "-o", grown).status == 0
    copy.unlink()
    done = symskill("learn", door, "--into", grown)
    assert (done.status, done.out) == (0, "")
    assert content(grown) == content(tmp_path / "all")

    # known content under another name, and a known name with other content
    again = tmp_path / "again.hdf5"
    again.write_bytes(door.read_bytes())
    assert "there called 'door:demo_1'" in symskill("learn", again, "--into", grown).error
    other = tmp_path / "door.hdf5"
    other.write_bytes(stack.read_bytes())
    assert "there called 'stack:demo_1'" in symskill("learn", other, "--into", grown).error
    assert content(grown) == content(tmp_path / "all")


def test_a_library_stays_if_nothing_can_be_added(
    symskill: Callable[..., Any], library: Path, people: Path, tmp_path: Path
) -> None:
    before = content(library)
    broken = tmp_path / "broken.hdf5"
    broken.write_bytes((people / "door.hdf5").read_bytes()[:2000])
    assert symskill("learn", broken, "--into", library).status == 2
    assert symskill("learn", people / "door.hdf5", "--into", tmp_path / "none").status == 2
    assert "--into LIBRARY" in symskill("learn", people / "door.hdf5").error
    assert "--into LIBRARY" in symskill("learn", people / "door.hdf5", "-o", tmp_path / "x", "--into", library).error
    assert content(library) == before
    (recording,) = (library / "demos").iterdir()
    whole = recording.read_bytes()
    recording.write_bytes(whole[:-1])
    try:
        assert recording.name in symskill("learn", people / "door.hdf5", "--into", library).error
    finally:
        recording.write_bytes(whole)


def test_why(symskill: Callable[..., Any], people: Path, tmp_path: Path) -> None:
    folder = tmp_path / "library"
    assert symskill("learn", people / "stack.hdf5", "-o", folder).status == 0
    document = json.loads(symskill("show", folder, "--json").out)
    for name in [o["name"] for o in document["operators"]] + [p["name"] for p in document["predicates"]]:
        done = symskill("show", folder, "--why", name)
        assert (done.status, done.err) == (0, "")
        assert name in done.out
        found = json.loads(symskill("show", folder, "--why", name, "--json").out)
        assert name in (found.get("operator"), found.get("predicate"))
    place = symskill("show", folder, "--why", "place-cubea-on-cubeb").out
    assert "stack:demo_1 from " in place
    assert "ends (gripper-holds-cubea ?cubea)" in place
    assert "cubea-on-cubeb: the cubeB, whose score leads the next candidate's by" in place
    rest = symskill("show", folder, "--why", "cubea-at-table").out
    assert "in the table's frame" in rest
    assert rest.index("ended by") < rest.index("pick-cubea-from-table")
    error = symskill("show", folder, "--why", "place-cubea").error
    assert "neither an operator nor a predicate" in error
    assert "place-cubea-on-cubeb" in error
    assert "gripper-open" in error


def test_operators_as_the_papers_table(symskill: Callable[..., Any], library: Path) -> None:
    markdown = symskill("show", library, "--table", "markdown").out.splitlines()
    assert markdown[0] == "| Operator | Summary | Preconditions | Effects | Maintain Conditions |"
    row = next(line for line in markdown if "pick-cube-from-table" in line)
    assert "| Pick cube from table |" in row
    assert "gripper-holds-cube, ¬cube-at-table, ¬gripper-open" in row
    latex = symskill("show", library, "--table", "latex").out
    assert latex.startswith("\\begin{tabular}{lllll}\n\\toprule")
    assert "$\\lnot$cube-at-table" in latex
    refused = symskill("show", library, "--table", "html")
    assert (refused.status, refused.out) == (2, "")
    assert "expected" in refused.err
    assert symskill("show", library, "--table", "latex", "--json").status == 2


def test_a_predicate_is_drawn_over_its_data(symskill: Callable[..., Any], library: Path, tmp_path: Path) -> None:
    done = symskill("show", library, "--why", "cube-at-table", "--picture", tmp_path / "cube.svg")
    assert done.status == 0
    assert "support: " in (tmp_path / "cube.svg").read_text()
    for arguments, message in (
        (("--why", "cube-at-table", "--picture", tmp_path / "cube.png"), "ends in .svg"),
        (("--why", "pick-cube-from-table", "--picture", tmp_path / "x.svg"), "no learned predicate"),
        (("--picture", tmp_path / "x.svg"), "belongs to --why"),
    ):
        refused = symskill("show", library, *arguments)
        assert (refused.status, refused.out) == (2, "")
        assert message in refused.err
    assert not (tmp_path / "x.svg").exists()


def test_skills_are_drawn(symskill: Callable[..., Any], library: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    phases = {name: len(s["phases"]) for name, s in json.loads(symskill("show", library, "--json").out)["skills"].items()}
    done = symskill("show", library, "--plots", tmp_path / "plots")
    assert done.status == 0, done.err
    assert {p.name for p in (tmp_path / "plots").iterdir()} == {f"{n}-{i + 1}.png" for n, k in phases.items() for i in range(k)}
    assert symskill("show", library, "--plots", tmp_path / "plots", "--json").status == 2
