"""Atomic writes: a crash, a full disk or a kill leaves the old file or the new one, never half of one.

A file is written under a temporary name beside its own, `.NAME.xxxxxxxx.symskill`, and renamed when it is whole. The temporary
file is locked as long as its process lives; one that nobody holds was left by a killed process, and the next write into
the same folder removes it.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
import secrets
import stat
from collections.abc import Iterator
from pathlib import Path

from symskill_pddl.errors import InputError

TEMPORARY = re.compile(r"\..+\.[0-9a-f]{8}\.symskill")
"""Names of temporary files."""


def write_atomic(path: str | Path, content: bytes) -> None:
    """Write a file whole, in place of the one that is there.

    Raises
    ------
    InputError
        As for `draft`; whatever was at `path` is as it was.
    """
    with draft(path) as temporary:
        temporary.write_bytes(content)


@contextlib.contextmanager
def draft(path: str | Path) -> Iterator[Path]:
    """A file to write to, which takes the place of `path` at the end of the block.

    If the block raises, or removes it, what was at `path` stays as it was.

    Raises
    ------
    InputError
        `path` is a folder, link, device or pipe, or write-protected, or the folder does not exist or cannot be written.
    """
    path = Path(path)
    found = check_place(path)
    try:
        sweep(path.parent)
        temporary, descriptor = _locked_beside(path)
        try:
            if found is not None:
                with contextlib.suppress(OSError):  # some file systems know no permissions
                    os.fchmod(descriptor, stat.S_IMODE(found.st_mode))
            yield temporary
            if temporary.exists():
                os.fsync(descriptor)
                temporary.replace(path)
                _sync_folder(path.parent)
        finally:
            with contextlib.suppress(OSError):
                temporary.unlink(missing_ok=True)
            os.close(descriptor)
    except OSError as error:
        raise InputError(f"cannot write '{path}': {error.strerror or error}") from error


def check_place(path: Path) -> os.stat_result | None:
    """The file at `path`, or nothing: there a file may be written.

    Raises
    ------
    InputError
        It is a folder, a link, a device, a pipe or write-protected; or there is no folder that could hold it.
    """
    try:
        found = os.lstat(path)
    except FileNotFoundError:
        found = None
    except OSError as error:
        raise InputError(f"cannot write '{path}': {error.strerror or error}") from None
    if not path.parent.is_dir():
        raise InputError(f"cannot write '{path}': there is no folder '{path.parent}'")
    if not os.access(path.parent, os.W_OK | os.X_OK):
        raise InputError(f"cannot write '{path}': the folder '{path.parent}' is write-protected")
    if found is None:
        return None
    if stat.S_ISDIR(found.st_mode):
        raise InputError(f"cannot write '{path}': it is a folder, a file name is needed")
    refuse_link(path, found)
    if not stat.S_ISREG(found.st_mode):
        raise InputError(f"cannot write '{path}': it is a device or a pipe, not an ordinary file")
    if not os.access(path, os.W_OK):
        raise InputError(f"cannot write '{path}': it is write-protected")
    return found


def refuse_link(path: Path, found: os.stat_result) -> None:
    """Raise if `path` is a symbolic link: it may lead out of the folder where somebody expects the output."""
    if stat.S_ISLNK(found.st_mode):
        raise InputError(f"cannot write '{path}': it is a link to '{path.readlink()}'; name what it leads to")


def make_folder(path: Path) -> tuple[Path, ...]:
    """Make a folder, and those above it, where they are not there; those that were made, the outermost first.

    Raises
    ------
    InputError
        It is a link or a file, or cannot be made.
    """
    with contextlib.suppress(OSError):  # not there yet; whatever else is wrong mkdir says
        refuse_link(path, os.lstat(path))
    missing = [p for p in (*reversed(path.parents), path) if not p.exists()]
    try:
        path.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise InputError(f"cannot write into '{path}': it is a file, a folder is needed") from None
    except OSError as error:
        raise InputError(f"cannot make the folder '{path}': {error.strerror or error}") from None
    return tuple(missing)


def open_locked(path: Path, busy: str) -> int:
    """Open a file for reading and appending, made if it is not there, and lock it until it is closed.

    The lock goes with the process that holds it, however that ends. On file systems without locks there is none.

    Parameters
    ----------
    busy : str
        What is the case if it is locked: "another evaluation is writing 'results.json'".

    Raises
    ------
    InputError
        Another process has it locked, it is no ordinary file, or it cannot be written.
    """
    while True:
        check_place(path)
        try:
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)
        except OSError as error:
            raise InputError(f"cannot write '{path}': {error.strerror or error}") from None
        if not _lock(descriptor):
            os.close(descriptor)
            raise InputError(f"{busy}; wait for it, or choose another -o")
        if _is_at(descriptor, path):
            return descriptor
        os.close(descriptor)  # whoever held the lock removed the file before letting go


def sweep(folder: Path) -> None:
    """Remove the temporary files of killed processes."""
    with os.scandir(folder) as entries:
        names = [e.name for e in entries if TEMPORARY.fullmatch(e.name) and e.is_file(follow_symlinks=False)]
    for name in names:
        with contextlib.suppress(OSError):
            descriptor = os.open(folder / name, os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC)
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                (folder / name).unlink()
            finally:
                os.close(descriptor)


def _locked_beside(path: Path) -> tuple[Path, int]:
    while True:
        temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.symskill")
        try:
            descriptor = os.open(temporary, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)
        except FileExistsError:
            continue
        if _lock(descriptor) and _is_at(descriptor, temporary):
            return temporary, descriptor
        os.close(descriptor)  # another process swept it away before it was locked


def _lock(descriptor: int) -> bool:
    """False if another process holds the lock; a file system that knows none (OSError of another kind) counts as locked."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True


def _is_at(descriptor: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), os.lstat(path))
    except OSError:
        return False


def _sync_folder(folder: Path) -> None:
    # the rename itself has to reach the disk; some file systems do not allow to open a folder
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
