import os

import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.files import write_atomic


def test_writes_and_replaces_with_ordinary_permissions(tmp_path):
    path = tmp_path / "a.txt"
    write_atomic(path, b"one")
    write_atomic(path, b"two")
    assert path.read_bytes() == b"two"
    (tmp_path / "b.txt").write_bytes(b"")
    assert path.stat().st_mode == (tmp_path / "b.txt").stat().st_mode
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.txt", "b.txt"]


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_a_failure_at_any_step_leaves_the_old_content_and_no_litter(tmp_path, monkeypatch, call):
    path = tmp_path / "a.txt"
    write_atomic(path, b"old")

    def fail(*_):
        raise OSError(5, "Input/output error")

    monkeypatch.setattr(os, "fsync", fail) if call == "fsync" else monkeypatch.setattr("pathlib.Path.replace", fail)
    with pytest.raises(InputError, match=r"cannot write '.*a.txt': Input/output error"):
        write_atomic(path, b"new")
    assert path.read_bytes() == b"old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_folders_are_refused(tmp_path):
    with pytest.raises(InputError, match="is a folder"):
        write_atomic(tmp_path, b"")
    with pytest.raises(InputError, match="there is no folder"):
        write_atomic(tmp_path / "none" / "a.txt", b"")
