"""Commands on a library that was learned from a person's recording: import, learn, show, export, check."""

from __future__ import annotations

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
