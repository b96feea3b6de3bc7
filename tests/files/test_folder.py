import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.files import Shape, writing


def listed(content):
    try:
        names = json.loads(content)["files"]
    except (ValueError, KeyError, TypeError):
        return None
    return frozenset(names)


SHAPE = Shape("box", "box.json", ("parts",), listed)
KILLED = """
import sys
sys.path.insert(0, {tests!r})
import os, signal
from pathlib import Path
import test_folder as t
import symskill_pddl.files.folder as module
real, written = module.write_atomic, []
def stop(path, content):
    if len(written) == {after}:
        os.kill(os.getpid(), signal.SIGKILL)
    written.append(path)
    real(path, content)
module.write_atomic = stop
t.put(Path(sys.argv[1]), "b1", "b2")
"""


def put(folder, *names, replace=True):
    with writing(folder, SHAPE, replace=replace) as writer:
        writer.save({f"parts/{n}": n.encode() for n in names}, index(*names))


def index(*names):
    return json.dumps({"files": [f"parts/{n}" for n in names]}).encode()


def content(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def whole(*names):
    return {"box.json": index(*names)} | {f"parts/{n}": n.encode() for n in names}


def test_a_folder_is_made_and_replaced_and_other_files_stay(tmp_path):
    folder = tmp_path / "x" / "box"
    put(folder, "a1", "a2")
    assert content(folder) == whole("a1", "a2")
    others = {"parts/mine": b"precious", "notes": b"precious"}
    for name, text in others.items():
        (folder / name).write_bytes(text)
    put(folder, "a1", "b1")
    assert content(folder) == whole("a1", "b1") | others


def test_another_content_is_replaced_only_if_told_so(tmp_path):
    put(tmp_path / "box", "a")
    put(tmp_path / "box", "a", replace=False)
    with pytest.raises(InputError, match="box' holds another box already; --force replaces it"):
        put(tmp_path / "box", "b", replace=False)
    assert content(tmp_path / "box") == whole("a")


@pytest.mark.parametrize("there", ["notes.txt", ".hidden", "parts/a", "box.json"])
def test_a_folder_that_holds_something_else_is_refused(tmp_path, there):
    (tmp_path / there).parent.mkdir(exist_ok=True)
    (tmp_path / there).write_bytes(b"{}")
    with pytest.raises(InputError, match="is not empty and no box: choose a new folder, or an empty one"):
        put(tmp_path, "a")
    assert content(tmp_path) == {there: b"{}"}


def test_links_and_files_are_refused(tmp_path):
    put(tmp_path / "box", "a")
    (tmp_path / "link").symlink_to("box")
    (tmp_path / "file").write_bytes(b"precious")
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match="link': it is a link to 'box'; name what it leads to"):
        put(tmp_path / "link", "b")
    for name in ("file", "pipe"):
        with pytest.raises(InputError, match=f"cannot write the box '.*{name}': it is no folder"):
            put(tmp_path / name, "b")
    (tmp_path / "box" / "parts").rename(tmp_path / "elsewhere")
    (tmp_path / "box" / "parts").symlink_to("../elsewhere")
    with pytest.raises(InputError, match=r"parts': it is a link to '\.\./elsewhere'"):
        put(tmp_path / "box", "b")
    assert content(tmp_path / "elsewhere") == {"a": b"a"}


def test_two_writers(tmp_path):
    with writing(tmp_path / "box", SHAPE, replace=True) as writer:
        with pytest.raises(InputError, match=r"another program is writing the box '.*box'; wait for it, or choose another -o"):
            put(tmp_path / "box", "b")
        writer.save({"parts/a": b"a"}, index("a"))
    put(tmp_path / "box", "b")
    assert content(tmp_path / "box") == whole("b")


def test_what_is_not_saved_in_the_end_leaves_nothing(tmp_path):
    with pytest.raises(KeyboardInterrupt), writing(tmp_path / "x" / "box", SHAPE, replace=True):
        raise KeyboardInterrupt
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("fails_at", ["parts/b2", "box.json"])
@pytest.mark.parametrize("before", [(), ("a", "b1")])
def test_a_failure_leaves_the_old_content_and_no_litter(tmp_path, monkeypatch, before, fails_at):
    import symskill_pddl.files.folder as module

    folder, real = tmp_path / "box", module.write_atomic
    if before:
        put(folder, *before)

    def write(path, content):
        if path == folder / fails_at:
            raise InputError("the disk is full")
        real(path, content)

    monkeypatch.setattr(module, "write_atomic", write)
    with pytest.raises(InputError, match="the disk is full"):
        put(folder, "b1", "b2")
    assert folder.exists() == bool(before)
    assert not before or content(folder) == whole(*before)


@pytest.mark.parametrize("after", [0, 1, 2])
@pytest.mark.parametrize("before", [(), ("a",)])
def test_the_next_writer_removes_what_a_killed_one_left(tmp_path, before, after):
    folder = tmp_path / "box"
    if before:
        put(folder, *before)
    program = KILLED.format(tests=str(Path(__file__).parent), after=after)
    done = subprocess.run([sys.executable, "-c", program, folder], check=False)
    assert done.returncode == -signal.SIGKILL
    left = content(folder)
    assert left.get("box.json") == (index(*before) if before else None)
    assert {"parts/b1": b"b1"}.items() <= left.items() or not after
    put(folder, "c")
    assert content(folder) == whole("c")


def test_a_list_of_a_killed_writer_reaches_nothing_else(tmp_path):
    put(tmp_path / "box", "a")
    (tmp_path / "mine").write_bytes(b"precious")
    names = ["../mine", "parts/../../mine", str(tmp_path / "mine"), "parts/old", 7]
    (tmp_path / "box" / "box.json.saving").write_text(json.dumps(names))
    (tmp_path / "box" / "parts" / "old").write_bytes(b"left")
    put(tmp_path / "box", "b")
    assert content(tmp_path) == {f"box/{n}": c for n, c in whole("b").items()} | {"mine": b"precious"}
