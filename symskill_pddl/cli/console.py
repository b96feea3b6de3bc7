"""Where text goes: results to standard output, everything else (progress, errors) to standard error.

All of it passes through `escaped` here, so that nothing that stood in somebody's file can order a terminal about.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from io import StringIO
from threading import Timer
from typing import IO, Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TaskID, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from symskill_pddl.errors import QUOTED, SymSkillError, escaped, shown

WIDTH = 120
"""Columns of a table that goes to a file or another program."""


PATIENCE_S = 2.0
"""What takes longer than this is announced where there is no terminal."""
LONGEST_WORD, LONGEST_LINE = 240, 900
"""Characters of one word, such as a path, and of a whole error."""
_QUOTATION = re.compile(f"'([^']{{{QUOTED + 1},}})'")


class ClosedError(Exception):
    """Nobody reads what we write any more."""


class OutputError(SymSkillError):
    """Standard output takes nothing more, for example because the disk is full."""


def say(text: str = "") -> None:
    """One or more lines of a result, unwrapped and without markup."""
    _write(sys.stdout, escaped(text) + "\n")


def remark(text: str) -> None:
    """One or more lines about how things are going, beside the result."""
    _write(sys.stderr, escaped(text) + "\n")


def complain(text: str) -> None:
    """An error, as one line."""
    _write(sys.stderr, f"symskill: error: {_line(text)}\n")


def emit_json(document: Any) -> None:
    """The one JSON document of a command called with --json."""
    text = json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False)
    # json escapes what it must; the rest that a terminal could obey stands in texts, where \uXXXX means the same
    unsafe = {character for character in set(text) if character != "\n" and escaped(character, "") != character}
    for character in unsafe:
        text = text.replace(character, json.dumps(character)[1:-1])
    _write(sys.stdout, text + "\n")


def _line(text: str) -> str:
    """A message with nothing very long in it: no word, nothing between quotes, and not the whole."""
    words = (shown(word, LONGEST_WORD) for word in text.split())
    return shown(_QUOTATION.sub(lambda found: f"'{shown(found[1])}'", " ".join(words)), LONGEST_LINE)


def _write(stream: IO[str], text: str) -> None:
    try:
        stream.write(text)
    except BrokenPipeError:
        raise ClosedError from None
    except OSError as error:
        if stream is sys.stdout:
            raise OutputError(f"cannot write to standard output: {error.strerror or error}") from None
        # there is no place left to complain at


def table(title: str, columns: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    """A table on standard output."""
    grid = Table(
        title=escaped(title) or None,
        title_justify="left",
        title_style="bold",
        header_style="",
        box=None,
        pad_edge=False,
        padding=(0, 2, 0, 0),
    )
    for column in columns:
        grid.add_column(escaped(column), overflow="fold")
    for row in rows:
        # Text, not markup: names may hold brackets
        grid.add_row(*(Text(escaped(str(cell))) for cell in row))
    drawn, terminal = StringIO(), sys.stdout.isatty()
    # names and numbers are not coloured
    Console(file=drawn, force_terminal=terminal, width=None if terminal else WIDTH, highlight=False).print(grid)
    _write(sys.stdout, drawn.getvalue())


@contextmanager
def progress(text: str, total: int | None = None) -> Iterator[Advance]:
    """Show on standard error that something takes its time, and for how long; the value tells how it goes on."""
    error = Console(stderr=True, highlight=False)
    if not error.is_terminal:
        # nothing to animate: what takes long is said once, what is refused at once gets its error alone
        line = Timer(PATIENCE_S, remark, (text,))
        line.daemon = True
        line.start()
        try:
            yield Advance()
        finally:
            line.cancel()
        return
    counted = (BarColumn(), MofNCompleteColumn()) if total is not None else ()
    columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False), *counted, TimeElapsedColumn())
    with Progress(*columns, console=error, transient=True) as bar:
        yield Advance(bar, bar.add_task(shown(text), total=total))


class Advance:
    """Handle on a line of progress: call it to take a step, or to change the text; without a terminal it does nothing."""

    def __init__(self, bar: Progress | None = None, task: TaskID | None = None) -> None:
        self._bar, self._task = bar, task

    def __call__(self, steps: int = 0, text: str | None = None) -> None:
        if self._bar is not None and self._task is not None:
            self._bar.update(self._task, advance=steps, description=None if text is None else shown(text))

    def remark(self, text: str) -> None:
        """A line that stays, above the progress."""
        if self._bar is not None:
            self._bar.console.print(Text(escaped(text)))
        else:
            remark(text)
