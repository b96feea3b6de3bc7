"""The program: its commands, its exit statuses, and what has to be set before numpy is loaded."""

from __future__ import annotations

import os
import sys

import typer

from symskill_pddl.cli import demos, evaluate, execute, inspect, pddl, quickstart, recordings, replay
from symskill_pddl.cli.console import say
from symskill_pddl.cli.net import caught

app = typer.Typer(
    name="symskill",
    help="From a handful of robot demonstrations to a PDDL domain, plans, and their execution under a monitor.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.command()(quickstart.quickstart)
app.command()(demos.record)
app.command("import")(recordings.import_recording)
app.command()(inspect.inspect)
app.command()(demos.learn)
app.command()(demos.show)
app.command()(pddl.export)
app.command()(pddl.problem)
app.command()(pddl.planners)
app.command()(pddl.plan)
app.command()(pddl.check)
app.command()(execute.run)
app.command()(evaluate.evaluate)
app.command()(replay.replay)
app.command()(execute.report)


def _version(asked: bool) -> None:
    if asked:
        from symskill_pddl import __version__

        say(f"symskill {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: bool = typer.Option(False, "--version", is_eager=True, callback=_version, help="Print the version and leave."),
) -> None:
    """From a handful of robot demonstrations to a PDDL domain, plans, and their execution under a monitor."""


def main() -> None:
    """Entry of the `symskill` program.

    Exit status: 0 done; 1 no plan, goal missed, or check failed; 2 bad input, with one line that says what and where; 3 an error
    of ours, with one line that says where its traceback is (`net`).
    """
    # small matrices: one thread is faster than many, and numpy reads this once, when it is loaded
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    # nothing here draws with the simulator, so it need not look for a graphics library
    os.environ.setdefault("MUJOCO_GL", "disabled")
    sys.exit(caught(lambda: app(prog_name="symskill", standalone_mode=False)))
