"""Where text goes: results to standard output, everything else (progress, errors) to standard error."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from threading import Timer
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TaskID, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

WIDTH = 120
"""Columns of a table that goes to a file or another program."""


PATIENCE_S = 2.0
"""What takes longer than this is announced where there is no terminal."""


def out() -> Console:
    """Standard output, looked up at the time of the call; names and numbers are not coloured."""
    return Console(highlight=False, width=None if sys.stdout.isatty() else WIDTH)


def say(text: str = "") -> None:
    """One or more lines of a result, unwrapped and without markup."""
    sys.stdout.write(text + "\n")


def remark(text: str) -> None:
    """A line about how things are going, beside the result."""
    sys.stderr.write(text + "\n")


def complain(text: str) -> None:
    """An error, as one line."""
    sys.stderr.write(f"symskill: error: {' '.join(text.split())}\n")


def emit_json(document: Any) -> None:
    """The one JSON document of a command called with --json."""
    sys.stdout.write(json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n")


def table(title: str, columns: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    """A table on standard output."""
    grid = Table(
        title=title or None,
        title_justify="left",
        title_style="bold",
        header_style="",
        box=None,
        pad_edge=False,
        padding=(0, 2, 0, 0),
    )
    for column in columns:
        grid.add_column(column, overflow="fold")
    for row in rows:
        # Text, not markup: names may hold brackets
        grid.add_row(*(Text(str(cell)) for cell in row))
    out().print(grid)


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
        yield Advance(bar, bar.add_task(text, total=total))


class Advance:
    """Handle on a line of progress: call it to take a step, or to change the text; without a terminal it does nothing."""

    def __init__(self, bar: Progress | None = None, task: TaskID | None = None) -> None:
        self._bar, self._task = bar, task

    def __call__(self, steps: int = 0, text: str | None = None) -> None:
        if self._bar is not None and self._task is not None:
            self._bar.update(self._task, advance=steps, description=text)

    def remark(self, text: str) -> None:
        """A line that stays, above the progress."""
        if self._bar is not None:
            self._bar.console.print(Text(text))
        else:
            remark(text)
