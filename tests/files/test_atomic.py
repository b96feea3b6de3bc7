import os
import re
import socket
import subprocess
import sys

import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.files import draft, make_folder, open_locked, write_atomic
from symskill_pddl.files.atomic import TEMPORARY

KILLED = """
import os, signal, sys
from pathlib import Path
from symskill_pddl.files import draft
with draft(sys.argv[1]) as temporary:
    temporary.write_bytes(b"half")
    os.kill(os.getpid(), signal.SIGKILL)
"""


def interrupted(path):
    path.write_bytes(b"new")
    raise KeyboardInterrupt


def names(folder):
    return sorted(p.name for p in folder.iterdir())


def test_writes_and_replaces_with_ordinary_permissions(tmp_path):
    path = tmp_path / "a.txt"
    write_atomic(path, b"one")
    write_atomic(path, b"two")
    assert path.read_bytes() == b"two"
    (tmp_path / "b.txt").write_bytes(b"")
    assert path.stat().st_mode == (tmp_path / "b.txt").stat().st_mode
    assert names(tmp_path) == ["a.txt", "b.txt"]


def test_a_file_keeps_its_permissions(tmp_path):
    path = tmp_path / "a.txt"
    path.write_bytes(b"mine alone")
    path.chmod(0o600)
    write_atomic(path, b"two")
    assert path.stat().st_mode & 0o777 == 0o600


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
    assert names(tmp_path) == ["a.txt"]


def test_what_raises_or_is_removed_leaves_the_old_content(tmp_path):
    path = tmp_path / "a.txt"
    write_atomic(path, b"old")
    with pytest.raises(KeyboardInterrupt), draft(path) as temporary:
        interrupted(temporary)
    with draft(path) as temporary:
        temporary.write_bytes(b"new")
        temporary.unlink()
    assert path.read_bytes() == b"old"
    assert names(tmp_path) == ["a.txt"]


def test_the_next_write_removes_what_a_killed_process_left_and_nothing_else(tmp_path):
    (tmp_path / ".a.txt.swp").write_bytes(b"an editor's")
    (tmp_path / ".a.txt.0123abcd.symskill").mkdir()
    done = subprocess.run([sys.executable, "-c", KILLED, tmp_path / "a.txt"], check=False)
    assert done.returncode == -9
    (left,) = (p for p in tmp_path.iterdir() if p.is_file() and TEMPORARY.fullmatch(p.name))
    assert left.read_bytes() == b"half"
    with draft(tmp_path / "b.txt") as living:
        write_atomic(tmp_path / "c.txt", b"whole")
        assert living.exists()
        assert not left.exists()
    assert names(tmp_path) == [".a.txt.0123abcd.symskill", ".a.txt.swp", "b.txt", "c.txt"]


def test_what_is_no_ordinary_file_is_refused_and_stays(tmp_path):
    target = tmp_path / "target"
    target.write_bytes(b"precious")
    (tmp_path / "link").symlink_to(target)
    (tmp_path / "dangling").symlink_to(tmp_path / "nowhere")
    os.mkfifo(tmp_path / "pipe")
    listener = socket.socket(socket.AF_UNIX)
    listener.bind(str(tmp_path / "socket"))
    for name, message in {
        "link": f"it is a link to '{target}'; name what it leads to",
        "dangling": f"it is a link to '{tmp_path / 'nowhere'}'; name what it leads to",
        "pipe": "it is a device or a pipe, not an ordinary file",
        "socket": "it is a device or a pipe, not an ordinary file",
        ".": "it is a folder, a file name is needed",
        "none/a.txt": f"there is no folder '{tmp_path / 'none'}'",
        "target/a.txt": "Not a directory",
        "n" * 300: "File name too long",
    }.items():
        for write in (write_atomic, open_locked):
            with pytest.raises(InputError, match=re.escape(f"cannot write '{tmp_path / name}': {message}")):
                write(tmp_path / name, "")
    with pytest.raises(InputError, match="'/dev/null': it is a device or a pipe"):
        write_atomic("/dev/null", b"")
    listener.close()
    assert (target.read_bytes(), names(tmp_path)) == (b"precious", ["dangling", "link", "pipe", "socket", "target"])
    assert (tmp_path / "link").is_symlink()


def test_what_is_write_protected_is_refused(tmp_path, monkeypatch):
    (tmp_path / "a.txt").write_bytes(b"old")
    allowed = [tmp_path]
    # the super-user, who runs tests in a container, may write everything
    monkeypatch.setattr(os, "access", lambda path, _: path in allowed)
    with pytest.raises(InputError, match=r"a.txt': it is write-protected"):
        write_atomic(tmp_path / "a.txt", b"new")
    allowed.clear()
    with pytest.raises(InputError, match=rf"the folder '{tmp_path}' is write-protected"):
        write_atomic(tmp_path / "b.txt", b"new")
    assert (tmp_path / "a.txt").read_bytes() == b"old"


def test_a_lock_is_held_until_it_is_closed(tmp_path):
    path = tmp_path / "a.lock"
    first = open_locked(path, "somebody is writing 'a'")
    with pytest.raises(InputError, match=r"^somebody is writing 'a'; wait for it, or choose another -o$"):
        open_locked(path, "somebody is writing 'a'")
    os.close(first)
    os.close(open_locked(path, ""))


def test_a_lock_on_a_file_that_was_removed_meanwhile_is_taken_on_the_new_one(tmp_path, monkeypatch):
    path = tmp_path / "a.lock"
    real = os.open
    removed = []

    def opened(where, *rest):
        descriptor = real(where, *rest)
        if not removed:  # whoever held the lock removes the file just now
            removed.append(where.unlink())
        return descriptor

    monkeypatch.setattr(os, "open", opened)
    descriptor = open_locked(path, "")
    assert os.path.samestat(os.fstat(descriptor), path.stat())
    os.close(descriptor)


def test_folders_are_made_and_links_are_not_followed(tmp_path):
    assert make_folder(tmp_path / "a" / "b") == (tmp_path / "a", tmp_path / "a" / "b")
    assert make_folder(tmp_path / "a" / "b") == ()
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(InputError, match="file': it is a file, a folder is needed"):
        make_folder(tmp_path / "file")
    with pytest.raises(InputError, match="cannot make the folder"):
        make_folder(tmp_path / "file" / "a")
    (tmp_path / "link").symlink_to(tmp_path / "a")
    with pytest.raises(InputError, match=f"it is a link to '{tmp_path / 'a'}'"):
        make_folder(tmp_path / "link")
