"""Arguments and options that several commands share, and how their texts are read."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import typer

from symskill_pddl.errors import InputError
from symskill_pddl.files import DEMOS, Kind, Output, Replace
from symskill_pddl.worlds import ARENAS

LibraryArgument = Annotated[Path, typer.Argument(metavar="LIBRARY", help="Folder of a learned library.")]
ForceFlag = Annotated[bool, typer.Option("--force", help="Replace what is there already.")]
JsonFlag = Annotated[bool, typer.Option("--json", help="Print one JSON document.")]
WorldOption = Annotated[str, typer.Option("--world", help=f"{', '.join(ARENAS)}, or MODULE:NAME for one of your own.")]
TaskOption = Annotated[str, typer.Option("--task", help="A task of the world.")]
SeedOption = Annotated[int, typer.Option("--seed", help="Seed of the episode.")]
GoalOption = Annotated[
    str | None, typer.Option("--goal", metavar="ATOMS", help='Instead of the learned goal: "(atom object ...) ...".')
]
PlannerOption = Annotated[str | None, typer.Option("--planner", help="One that `symskill planners` lists.")]
DialectOption = Annotated[str, typer.Option("--dialect", help="strips, negative, costs or temporal; or all of them.")]
NamesOption = Annotated[Path | None, typer.Option("--names", help='A JSON file {"renames": {"name": "wished-name"}}.')]
DisturbOption = Annotated[
    list[str] | None, typer.Option("--disturb", metavar="SPEC", help="For example close-door@op=2; may be repeated.")
]
VideoOption = Annotated[Path | None, typer.Option("--video", metavar="FILE.mp4", help="Film the run.")]
EditedOption = Annotated[
    Path | None,
    typer.Option("--domain", metavar="DOMAIN", help="An edited export of the library: plan and watch with what it says."),
]
NoMonitorFlag = Annotated[bool, typer.Option("--no-monitor", help="Carry out the first plan blindly.")]
NoResamplingFlag = Annotated[bool, typer.Option("--no-resampling", help="Try a failed motion again as it was.")]
NoReplanningFlag = Annotated[bool, typer.Option("--no-replanning", help="Keep the first plan; retry its steps, or give up.")]
NoTrackingFlag = Annotated[
    bool, typer.Option("--no-tracking", help="Leave a skill's field where its objects were when the skill began.")
]
NoObstaclesFlag = Annotated[bool, typer.Option("--no-obstacles", help="Do not flow around other objects.")]


def pairs(texts: Iterable[str], option: str, form: str) -> dict[str, str]:
    """``["a=b"]`` as a mapping."""
    found: dict[str, str] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not (key and equals and value):
            raise InputError(f"{option} '{text}': expected {form}")
        if key in found:
            raise InputError(f"{option}: '{key}' is given twice")
        found[key] = value
    return found


def output(path: Path, kind: Kind, *, force: bool, inputs: Iterable[Path | None] = ()) -> Output:
    """A file that a command is going to write; raises `InputError` before the work if it must not, or could not, be written.

    `inputs` are the files that the command reads; it does not write over them even with `force`.
    """
    # what was demonstrated cannot be made again
    unasked = Replace.NOTHING if kind is DEMOS else Replace.OURS
    return Output(path, kind, Replace.ANYTHING if force else unasked, tuple(p for p in inputs if p is not None))
