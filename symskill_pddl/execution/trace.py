"""The trace of a run: `trace.jsonl`, one JSON object a line (`lines`), from which every decision of the monitor can be replayed.

The first line is a `Header` with the schema's version. Every line is flushed as it is written, so that a crash loses at most
the line being written; reading tolerates such a cut last line and says so. The fields `ms`, `seconds` and `times` are wall-clock
measurements and differ between runs; everything else is a function of the inputs and the seed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, TextIO

from pydantic import BaseModel, TypeAdapter

from symskill_pddl.errors import FormatError, InputError
from symskill_pddl.execution.lines import SCHEMA, Header, Line, NoteLine, OutcomeLine
from symskill_pddl.reading import read_text, validated

_LINE: TypeAdapter[Any] = TypeAdapter(Line)


class TraceWriter:
    """Writes a trace, a line at a time. A context manager; `listener` also gets every line."""

    def __init__(self, path: str | Path, listener: Callable[[Any], None] | None = None) -> None:
        self._listener = listener
        try:
            self._file: TextIO = Path(path).open("w", encoding="utf-8")  # noqa: SIM115 - closed by close()
        except OSError as error:
            raise InputError(f"cannot write the trace '{path}': {error.strerror or error}") from None

    def write(self, line: BaseModel) -> None:
        """Append one line and flush it."""
        self._file.write(line.model_dump_json(exclude_defaults=False) + "\n")
        self._file.flush()
        if self._listener:
            self._listener(line)

    def note(self, time: float, text: str) -> None:
        """Append a remark."""
        self.write(NoteLine(time=time, text=text))

    def close(self) -> None:
        """Close the file; further writes fail."""
        self._file.close()

    def __enter__(self) -> TraceWriter:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()


@dataclass(frozen=True)
class Trace:
    """A trace read back. `note` tells of a last line that was cut off, empty otherwise."""

    header: Header
    lines: tuple[Any, ...]
    note: str = ""

    def of(self, event: str) -> tuple[Any, ...]:
        """All lines of one event."""
        return tuple(line for line in self.lines if line.event == event)

    @property
    def outcome(self) -> OutcomeLine | None:
        return next((line for line in reversed(self.lines) if isinstance(line, OutcomeLine)), None)


def read_trace(path: str | Path) -> Trace:
    """Read `trace.jsonl`.

    Raises
    ------
    InputError
        The file does not exist or is not text.
    FormatError
        A line is not of the schema, naming the line; no header; another version. A last line without its line end that does
        not parse was cut off by a crash: it is left out and noted.
    """
    rows, note, lines = read_text(path, "trace").split("\n"), "", []
    for number, row in enumerate(rows, start=1):
        if not row.strip():
            continue
        try:
            lines.append(validated(_LINE.validate_python, row, f"{path}:{number}: not a line of a trace"))
        except FormatError:
            if number == len(rows) and number > 1:
                note = f"the last line ({number}) was cut off and is left out"
                break
            raise
        if len(lines) > 1 and isinstance(lines[-1], Header):
            raise FormatError(f"{path}:{number}: a second header; one file holds one run")
    if not lines or not isinstance(lines[0], Header):
        raise FormatError(f"{path}:1: a trace starts with a header")
    if lines[0].schema_version != SCHEMA:
        raise FormatError(f"{path}:1: trace of version {lines[0].schema_version}, this program reads version {SCHEMA}")
    return Trace(lines[0], tuple(lines[1:]), note)
