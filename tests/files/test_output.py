import os

import pytest
from hypothesis import given
from hypothesis import strategies as st

from symskill_pddl.errors import InputError
from symskill_pddl.files import DEMOS, DOMAIN, PAGE, PLAN, PROBLEM, RESULTS, TRACE, Output, Replace, sealed

HEADER = b'{"event":"header","schema_version":3}\n'
TAKEN = "is there already and is no {} that symskill wrote{}: choose another name, or replace it with --force"


def test_a_new_name_and_an_empty_file_are_written(tmp_path):
    for replace in Replace:
        path = tmp_path / replace.name
        Output(path, TRACE, replace).write(b"")
        Output(path, TRACE, replace).write(HEADER)
        assert path.read_bytes() == HEADER


def test_only_a_file_of_the_same_kind_is_replaced(tmp_path):
    path = tmp_path / "trace.jsonl"
    path.write_bytes(HEADER)
    Output(path, TRACE).write(HEADER + b"{}\n")
    for kind in (RESULTS, PAGE, DOMAIN, PLAN, DEMOS):
        with pytest.raises(InputError, match=TAKEN.format(kind.name, ", or was edited since" if kind.sealed else "")):
            Output(path, kind)
    with pytest.raises(InputError, match=r"trace.jsonl' is there already: choose another name, or replace it with --force"):
        Output(path, TRACE, Replace.NOTHING)
    Output(path, PAGE, Replace.ANYTHING).write(b"new")
    assert path.read_bytes() == b"new"


def test_what_the_command_reads_is_never_replaced(tmp_path):
    path, twin = tmp_path / "a.pddl", tmp_path / "b.pddl"
    path.write_bytes(b"")
    os.link(path, twin)
    for replace in Replace:
        with pytest.raises(InputError, match=r"cannot write '.*a.pddl': it is read by the same command"):
            Output(path, DOMAIN, replace, (tmp_path / "none", twin))


def test_a_file_in_a_folder_that_the_command_reads_is_replaced_only_if_it_is_ours(tmp_path):
    path, folder = tmp_path / "library" / "library.json", tmp_path / "library"
    folder.mkdir()
    path.write_bytes(b"precious")
    with pytest.raises(InputError, match=r"library.json': it is read by the same command"):
        Output(path, TRACE, Replace.ANYTHING, (folder,))
    path.write_bytes(HEADER)
    Output(path, TRACE, Replace.OURS, (folder,)).write(HEADER)
    Output(folder / "new", TRACE, Replace.OURS, (folder,)).write(HEADER)


def test_what_comes_in_between_is_not_replaced(tmp_path):
    output = Output(tmp_path / "a", TRACE)
    output.path.write_bytes(b"somebody's")
    with pytest.raises(InputError, match="is there already"):
        output.write(HEADER)
    assert [p.name for p in tmp_path.iterdir()] == ["a"]
    assert output.path.read_bytes() == b"somebody's"


@given(st.text(st.characters(codec="utf-8"), min_size=1, max_size=200), st.booleans(), st.integers(0, 999), st.integers(0, 255))
def test_an_edit_is_noticed(tmp_path_factory, text, last, at, byte):
    path = tmp_path_factory.getbasetemp() / "sealed"
    body = text + "\n"
    content = sealed(body, last=last)
    path.write_bytes(content)
    assert PLAN.wrote(path)
    edited, length = bytearray(content), len(body.encode())
    edited[at % length + (0 if last else len(content) - length)] = byte
    path.write_bytes(edited)
    assert PLAN.wrote(path) == (edited == content)
    path.write_bytes(content + b"; a remark\n")
    assert not PLAN.wrote(path)


def test_domains_problems_and_plans_are_told_apart(tmp_path):
    path = tmp_path / "a"
    for text, kind in (
        ("; x\n(define (domain d))\n", DOMAIN),
        ("(define\n(problem p))\n", PROBLEM),
        ("(a b)\n; cost = 1\n", PLAN),
    ):
        path.write_bytes(sealed(text, last=kind is PLAN))
        assert [k for k in (DOMAIN, PROBLEM, PLAN) if k.wrote(path)] == [kind]
        path.write_bytes(text.encode())
        assert not kind.wrote(path)


def interrupted(path):
    path.write_bytes(HEADER + b"half")
    raise KeyboardInterrupt


def test_a_growing_file_takes_its_place_at_the_end(tmp_path):
    output = Output(tmp_path / "trace.jsonl", TRACE)
    output.path.write_bytes(HEADER)
    with pytest.raises(KeyboardInterrupt), output.growing(""):
        interrupted(output.partial)
    assert (output.path.read_bytes(), output.partial.read_bytes()) == (HEADER, HEADER + b"half")
    with output.growing("another run is writing it"):
        assert output.partial.read_bytes() == b""
        with pytest.raises(InputError, match="another run is writing it; wait"), output.growing("another run is writing it"):
            pass
        output.partial.write_bytes(HEADER + b"whole")
    assert [p.name for p in tmp_path.iterdir()] == ["trace.jsonl"]
    assert output.path.read_bytes() == HEADER + b"whole"
    output.partial.write_bytes(b"somebody's")
    with pytest.raises(InputError, match=r"trace.jsonl.partial' is there already"), output.growing(""):
        pass
    assert output.partial.read_bytes() == b"somebody's"
