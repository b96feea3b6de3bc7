"""Atomic writes: a crash, a full disk or a kill leaves the old file or the new one, never half of one."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path

from symskill_pddl.errors import InputError


def write_atomic(path: str | Path, content: bytes) -> None:
    """Write a temporary file beside `path`, flush it to the disk, and rename it over `path`.

    Raises
    ------
    InputError
        If the folder does not exist or cannot be written; whatever was at `path` is as it was.
    """
    path = Path(path)
    if path.is_dir():
        raise InputError(f"cannot write '{path}': it is a folder, a file name is needed")
    temporary = None
    try:
        descriptor, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".tmp")
        with os.fdopen(descriptor, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        # mkstemp makes private files; give it what an ordinary open() would
        umask = os.umask(0)
        os.umask(umask)
        Path(temporary).chmod(0o666 & ~umask)
        Path(temporary).replace(path)
        temporary = None
        _sync_folder(path.parent)
    except OSError as error:
        raise InputError(f"cannot write '{path}': {error.strerror or error}") from error
    finally:
        if temporary is not None:
            with contextlib.suppress(OSError):
                Path(temporary).unlink()


def _sync_folder(folder: Path) -> None:
    # the rename itself has to reach the disk; some file systems do not allow to open a folder
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
