"""Files that a command writes: what may be at their place before, and how a file of ours is known again.

A file that is there is replaced only if it is of the kind that is written now and as this program left it, or if `--force` says
so. PDDL and plans are there to be edited, so one line of them is a checksum of the others: what was edited is somebody's work
and no longer ours. Demonstrations are never replaced unasked.
"""

from __future__ import annotations

import enum
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from symskill_pddl.errors import InputError
from symskill_pddl.files.atomic import check_place, draft, open_locked

EXCERPT = 1 << 16
"""Bytes at either end of a file by which its kind is known."""
MOST = 1 << 26
"""Bytes of a file with a checksum; a longer one is not ours."""
_SEAL = re.compile(rb"^; symskill ([0-9a-f]{12}): [^\n]*\n", re.MULTILINE)


@dataclass(frozen=True)
class Kind:
    """A kind of file that this program writes."""

    name: str
    begins: bytes
    """A regular expression that the bytes of such a file begin with."""
    sealed: bool = False
    """Whether one of its lines is a checksum of the others."""

    def wrote(self, path: Path) -> bool:
        """Whether the file is one of this kind, as this program left it."""
        try:
            with path.open("rb") as file:
                size = os.fstat(file.fileno()).st_size
                content = file.read(MOST if self.sealed else EXCERPT)
                if len(content) < size and not self.sealed:
                    file.seek(max(len(content), size - EXCERPT))
                    content += file.read()
        except OSError:
            return False
        return re.match(self.begins, content, re.DOTALL) is not None and (not self.sealed or _is_sealed(content))


DEMOS = Kind("file of demonstrations", rb"\x89HDF\r\n.*symskill-demos")
TRACE = Kind("trace", rb'\{"event":\s*"header"')
RESULTS = Kind("results file", rb'\{\s*"format":\s*"symskill-results"')
NAMES = Kind("file of names", rb'\{\s*"format":\s*"symskill-names"')
DOMAIN = Kind("domain", rb"(?:\s|;[^\n]*\n)*\(define\s*\(domain\b", sealed=True)
PROBLEM = Kind("problem", rb"(?:\s|;[^\n]*\n)*\(define\s*\(problem\b", sealed=True)
PLAN = Kind("plan", rb"(?!(?:\s|;[^\n]*\n)*\(define\b)", sealed=True)
PAGE = Kind("page", rb'<!DOCTYPE html>.{,400}<meta name="generator" content="symskill">')
DRAWING = Kind("drawing", rb"<svg\b[^>]*><!-- symskill -->")
PICTURE = Kind("picture", rb"\x89PNG\r\n.{,200}Software\x00symskill")
FILM = Kind("film", rb".{4}ftyp.*symskill")


def sealed(text: str, *, last: bool = False) -> bytes:
    """A text of PDDL or a plan with a first or last comment, the checksum by which `Kind.wrote` finds that nobody edited it."""
    body = text.encode()
    seal = f"; symskill {_sum(body)}: checksum of the other lines, by which an edited file is not overwritten unasked\n".encode()
    return body + seal if last else seal + body


def _sum(body: bytes) -> str:
    return sha256(body).hexdigest()[:12]


def _is_sealed(content: bytes) -> bool:
    seal = _SEAL.search(content)
    return seal is not None and _sum(content[: seal.start()] + content[seal.end() :]).encode() == seal[1]


class Replace(enum.Enum):
    """Which file an output may take the place of; an empty one always."""

    NOTHING = enum.auto()
    OURS = enum.auto()
    """One of the same kind, as this program left it."""
    ANYTHING = enum.auto()


@dataclass(frozen=True)
class Output:
    """A file that is going to be written: checked when this is made, so that no work is done for nothing, and again at the end.

    `inputs` are the files and folders that the same command reads.

    Raises
    ------
    InputError
        There is something at `path` that must not be replaced, or nothing could be written there.
    """

    path: Path
    kind: Kind
    replace: Replace = Replace.OURS
    inputs: tuple[Path, ...] = ()

    def __post_init__(self) -> None:
        found = check_place(self.path)
        if found is None:
            return
        if any(self._is_part_of(p) for p in self.inputs if p.exists()):
            raise InputError(f"cannot write '{self.path}': it is read by the same command; choose another name")
        if not found.st_size or self.replace is Replace.ANYTHING:
            return
        if self.replace is Replace.NOTHING:
            raise InputError(f"'{self.path}' is there already: choose another name, or replace it with --force")
        if not self.kind.wrote(self.path):
            edited = ", or was edited since" if self.kind.sealed else ""
            raise InputError(
                f"'{self.path}' is there already and is no {self.kind.name} that symskill wrote{edited}: "
                "choose another name, or replace it with --force"
            )

    def _is_part_of(self, read: Path) -> bool:
        """Whether it is that file, or a file in that folder which this program did not write there as an output."""
        inside = read.is_dir() and self.path.resolve().is_relative_to(read.resolve())
        return read.samefile(self.path) or (inside and not self.kind.wrote(self.path))

    @contextmanager
    def draft(self) -> Iterator[Path]:
        """As `atomic.draft`, if nothing came in between."""
        self.__post_init__()
        with draft(self.path) as temporary:
            yield temporary

    @property
    def partial(self) -> Path:
        """Where a file lies that grows while the work goes on."""
        return self.path.with_name(f"{self.path.name}.partial")

    @contextmanager
    def growing(self, busy: str) -> Iterator[None]:
        """Lock `partial`, empty it, and move it to `path` at the end of the block; if the block raises, it stays where it is.

        Parameters
        ----------
        busy : str
            As for `atomic.open_locked`.

        Raises
        ------
        InputError
            Another process has it locked, or it is something else than a file of this kind.
        """
        Output(self.partial, self.kind, self.replace)
        descriptor = open_locked(self.partial, busy)
        try:
            os.ftruncate(descriptor, 0)
            yield
            self.__post_init__()
            os.fsync(descriptor)
            self.partial.replace(self.path)
        except OSError as error:
            raise InputError(f"cannot write '{self.path}': {error.strerror or error}") from error
        finally:
            os.close(descriptor)

    def write(self, content: bytes) -> None:
        """Write it whole."""
        with self.draft() as temporary:
            temporary.write_bytes(content)
