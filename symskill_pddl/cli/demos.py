"""Commands that make and look at demonstrations and libraries: record, import, learn, show."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from symskill_pddl.cli.console import emit_json, progress, remark, say, table
from symskill_pddl.cli.options import JsonFlag, LibraryArgument, pairs, require_folder
from symskill_pddl.errors import InputError


def record(
    task: Annotated[str, typer.Argument(metavar="TASK", help="A task of the kitchen.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="The HDF5 file to write.")],
    n: Annotated[int, typer.Option("-n", help="How many demonstrations.")] = 10,
    seed: Annotated[int, typer.Option(help="Seed of the first episode.")] = 0,
) -> None:
    """Record demonstrations of a task in the simulated kitchen."""
    from symskill_pddl.demos import save_demos
    from symskill_pddl.kitchen import task_named
    from symskill_pddl.kitchen.record import record_with_truth

    task_named(task)
    require_folder(output)
    with progress(f"recording {n} demonstrations of {task}"):
        demos, truths = record_with_truth(task, n, seed)
    save_demos(output, demos, truths)
    remark(f"{output}: {len(demos)} demonstrations, {sum(d.duration_s for d in demos):.0f} s")


def import_recording(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A robosuite or robomimic HDF5 recording.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="The HDF5 file to write.")],
    types: Annotated[
        list[str] | None, typer.Option("--type", metavar="OBJECT=TYPE", help="Type of an object; may be repeated.")
    ] = None,
) -> None:
    """Turn a robosuite recording into demonstrations."""
    from symskill_pddl.demos import import_robosuite, save_demos

    require_folder(output)
    wanted = pairs(types or [], "--type", "OBJECT=TYPE")
    with progress(f"replaying {file}"):
        demos = import_robosuite(file, types=wanted)
    save_demos(output, demos)
    objects = ", ".join(f"{name} - {kind}" for name, kind in demos[0].objects.items())
    remark(f"{output}: {len(demos)} demonstrations, {sum(d.duration_s for d in demos):.0f} s; objects: {objects}")


def learn(
    files: Annotated[list[Path], typer.Argument(metavar="DEMOS...", help="Files of demonstrations.")],
    output: Annotated[Path | None, typer.Option("-o", "--output", help="The library's folder.")] = None,
    into: Annotated[
        Path | None, typer.Option("--into", metavar="LIBRARY", help="Add the demonstrations to those of this library.")
    ] = None,
) -> None:
    """Learn predicates, operators and skills from demonstrations."""
    from symskill_pddl.cli.work import learn_from

    target = output if into is None else into
    if target is None or (output is not None and into is not None):
        raise InputError("say where the library goes: -o FOLDER for a new one, or --into LIBRARY to add to one")
    library, report = learn_from(files, target, into=into is not None)
    for note in report.notes:
        remark(note)
    spent = sum(seconds for _, seconds in report.seconds)
    counts = f"{len(library.classifiers)} predicates, {len(library.operators)} operators, {len(library.skills)} skills"
    remark(f"{target}: {counts}, {spent:.1f} s")


def show(
    library: LibraryArgument,
    json: JsonFlag = False,
    why: Annotated[
        str | None, typer.Option("--why", metavar="NAME", help="Where an operator or a predicate comes from, and why it is so.")
    ] = None,
) -> None:
    """Show a library: predicates, operators and skills."""
    from symskill_pddl.cli import views
    from symskill_pddl.cli.why import why as reasons_of
    from symskill_pddl.cli.work import open_library

    learned = open_library(library)
    if why is not None:
        reasons = reasons_of(learned, why)
        if json:
            emit_json(reasons.document)
        else:
            say("\n".join(reasons.lines))
        return
    if json:
        emit_json(views.library_json(learned))
        return
    for title, columns, rows in views.library_tables(learned):
        table(title, columns, rows)
        say()
