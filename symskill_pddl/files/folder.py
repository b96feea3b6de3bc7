"""A folder that is replaced as a whole: an index, and the files that it names.

New files are written beside the old ones under names of their own, then the index is renamed, then what only the old index
named is removed: at any moment there is one whole content, and no file is touched that no index named. While somebody writes,
`INDEX.saving` is locked and lists the files that are about to be written, so that the next writer can remove what a
killed one left.
"""

from __future__ import annotations

import contextlib
import json
import os
import stat
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from symskill_pddl.errors import InputError
from symskill_pddl.files.atomic import make_folder, open_locked, refuse_link, sweep, write_atomic


@dataclass(frozen=True)
class Shape:
    """What such a folder is called and looks like."""

    name: str
    index: str
    folders: tuple[str, ...]
    """Where the files that the index names lie."""
    listed: Callable[[bytes], frozenset[str] | None]
    """The files that an index names, such as 'skills/a.npz'; none if the bytes are no index of such a folder."""

    @property
    def saving(self) -> str:
        return f"{self.index}.saving"

    def holds(self, folder: Path) -> bool:
        """Whether there is such a folder, perhaps damaged."""
        return self._listed(folder) is not None

    def check(self, folder: Path) -> None:
        """Raise `InputError` unless such a folder may be written here: a new or empty one, or one that holds such files."""
        try:
            found = os.lstat(folder)
        except FileNotFoundError:
            return
        except OSError as error:
            raise InputError(f"cannot write the {self.name} '{folder}': {error.strerror or error}") from None
        refuse_link(folder, found)
        if not stat.S_ISDIR(found.st_mode):
            raise InputError(f"cannot write the {self.name} '{folder}': it is no folder")
        for path in (folder / sub for sub in self.folders if os.path.lexists(folder / sub)):
            refuse_link(path, os.lstat(path))
        try:
            names = {p.name for p in folder.iterdir()}
        except OSError as error:
            raise InputError(f"cannot write the {self.name} '{folder}': {error.strerror or error}") from None
        begun = self.saving in names and self.index not in names
        if names and not begun and not self.holds(folder):
            raise InputError(f"'{folder}' is not empty and no {self.name}: choose a new folder, or an empty one")

    def _listed(self, folder: Path) -> frozenset[str] | None:
        try:
            return self.listed((folder / self.index).read_bytes())
        except OSError:
            return None


class Writer:
    """The right to write into a folder, for as long as `writing` lasts."""

    def __init__(self, folder: Path, shape: Shape, journal: int, replace: bool) -> None:
        self._folder, self._shape, self._journal, self._replace = folder, shape, journal, replace

    def save(self, files: Mapping[str, bytes], index: bytes) -> None:
        """Replace the content of the folder.

        Raises
        ------
        InputError
            Something else is there and must not be replaced, or it cannot be written; the folder's content is as it was.
        """
        folder, shape = self._folder, self._shape
        old = shape._listed(folder) or frozenset()
        same = (folder / shape.index).read_bytes() == index if shape.holds(folder) else None
        if same is False and not self._replace:
            raise InputError(f"'{folder}' holds another {shape.name} already; --force replaces it")
        left, keep = self._begun(), old
        self._begin(left | files.keys())
        made: list[Path] = []
        try:
            for name, content in files.items():
                made += make_folder((folder / name).parent)
                if not _holds(folder / name, content):
                    write_atomic(folder / name, content)
            if not same:
                write_atomic(folder / shape.index, index)
            keep = frozenset(files)
        finally:
            for name in sorted((old | left | files.keys()) - keep):
                with contextlib.suppress(OSError):
                    (folder / name).unlink()
            for sub in (folder / s for s in shape.folders if (folder / s).is_dir()):
                sweep(sub)
            remove_empty(made)

    def _begun(self) -> frozenset[str]:
        """What a killed writer was about to write: only names that an index could list."""
        try:
            names = json.loads(os.pread(self._journal, 1 << 24, 0) or b"[]")
        except ValueError:  # killed before the list was whole, and so before the first file
            return frozenset()
        inside = {str(name) for name in names if str(name).rpartition("/")[0] in self._shape.folders}
        return frozenset(inside)

    def _begin(self, names: frozenset[str]) -> None:
        try:
            os.ftruncate(self._journal, 0)
            os.write(self._journal, json.dumps(sorted(names)).encode())
            os.fsync(self._journal)
        except OSError as error:
            raise InputError(f"cannot write the {self._shape.name} '{self._folder}': {error.strerror or error}") from error


@contextlib.contextmanager
def writing(folder: Path, shape: Shape, *, replace: bool) -> Iterator[Writer]:
    """Become the only one who writes into a folder, which is made if it is not there.

    `replace`: an older content may be replaced by another one. If nothing is saved in the end, a folder that was made here goes.

    Raises
    ------
    InputError
        The folder holds something else, is a link or a file, or another program is writing it.
    """
    shape.check(folder)
    made = make_folder(folder)
    journal = folder / shape.saving
    try:
        descriptor = open_locked(journal, f"another program is writing the {shape.name} '{folder}'")
        try:
            shape.check(folder)
            yield Writer(folder, shape, descriptor, replace)
        finally:
            with contextlib.suppress(OSError):
                journal.unlink()
            os.close(descriptor)
    finally:
        remove_empty(made)


def remove_empty(folders: tuple[Path, ...] | list[Path]) -> None:
    """Remove those of the folders, outermost first, that hold nothing."""
    for folder in reversed(folders):
        with contextlib.suppress(OSError):
            folder.rmdir()


def _holds(path: Path, content: bytes) -> bool:
    try:
        return path.read_bytes() == content
    except OSError:
        return False
