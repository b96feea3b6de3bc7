"""Self-contained HTML pages: no script, no font, no picture from elsewhere; everything that came from a file is escaped."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from symskill_pddl.execution.trace import Trace
from symskill_pddl.files import PAGE, Output
from symskill_pddl.library import Library
from symskill_pddl.report.knowledge import view_library
from symskill_pddl.report.results import ResultRow, total
from symskill_pddl.report.run import view_run
from symskill_pddl.report.timeline import timeline


@cache
def _environment() -> Environment:
    return Environment(
        loader=PackageLoader("symskill_pddl.report"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        autoescape=True,
    )


def run_page(trace: Trace, library: Library | None = None) -> str:
    """The page of one run: summary, timeline, steps with their verdicts, plans, disturbances, timing.

    With a library also what was learned: operators, skills, predicates.
    """
    run = view_run(trace)
    title = f"{run.task or 'Run'}, seed {run.seed}"
    return _render("run.html.j2", title=title, run=run, drawing=timeline(run), library=view_library(library) if library else None)


def library_page(library: Library, title: str = "Library") -> str:
    """The page of a library: operators with their skills and evidence, predicates with their geometry."""
    return _render("library.html.j2", title=title, library=view_library(library))


def results_page(rows: Sequence[ResultRow], title: str = "Evaluation", facts: Sequence[tuple[str, str]] = ()) -> str:
    """The page of an evaluation: success rates with their intervals, failures, times. `facts` (name, value) stand at the top."""
    columns = list(dict.fromkeys(name for row in rows for name in row.times))
    return _render("results.html.j2", title=title, rows=rows, columns=columns, facts=facts, total=total(rows))


def write_page(path: str | Path, html: str) -> None:
    """Write a page atomically, in place of an older one; raises `InputError` if something else is there."""
    Output(Path(path), PAGE).write(html.encode("utf-8"))


def _render(template: str, **values: Any) -> str:
    return _environment().get_template(template).render(**values)
