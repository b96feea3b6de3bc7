"""Recordings that somebody else made: how they become demonstrations (import)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from symskill_pddl.cli.console import progress, remark
from symskill_pddl.cli.options import ForceFlag, pairs
from symskill_pddl.cli.options import output as checked_output
from symskill_pddl.errors import InputError
from symskill_pddl.files import DEMOS

if TYPE_CHECKING:
    from symskill_pddl.demos import Demo
    from symskill_pddl.demos.importing import ImportConfig

FORMATS = "An HDF5 recording of robosuite, robomimic, LIBERO, RoboCasa or Isaac Lab, or a LeRobot dataset of RoboCasa."


def import_recording(
    file: Annotated[Path, typer.Argument(metavar="FILE", help=FORMATS)],
    output: Annotated[Path, typer.Option("-o", "--output", help="The HDF5 file to write.")],
    types: Annotated[
        list[str] | None, typer.Option("--type", metavar="OBJECT=TYPE", help="Type of an object; may be repeated.")
    ] = None,
    task: Annotated[str, typer.Option("--task", help="What was shown, if it is not what the recording says.")] = "",
    names: Annotated[
        list[str] | None, typer.Option("--demo", metavar="NAME", help="Only this episode, demo_3; may be repeated.")
    ] = None,
    filter_key: Annotated[str, typer.Option("--filter-key", metavar="KEY", help="Only the episodes of mask/KEY.")] = "",
    count: Annotated[int | None, typer.Option("-n", help="Only the first N episodes, of those chosen.")] = None,
    gripper_column: Annotated[
        int | None, typer.Option("--gripper-column", metavar="N", help="The column of the actions that is the gripper's, from 0.")
    ] = None,
    gripper_open: Annotated[
        float | None, typer.Option("--gripper-open", metavar="VALUE", help="The value of that column that opens the gripper.")
    ] = None,
    rate: Annotated[
        float | None, typer.Option("--rate", metavar="HZ", help="Samples per second, if the recording does not say.")
    ] = None,
    force: ForceFlag = False,
) -> None:
    """Turn a recording of robosuite, robomimic, LIBERO, RoboCasa or Isaac Lab into demonstrations."""
    from symskill_pddl.demos import encode_demos
    from symskill_pddl.demos.importing import ImportConfig

    wanted = pairs(types or [], "--type", "OBJECT=TYPE")
    config = ImportConfig(wanted, task, tuple(names or ()), filter_key, count, gripper_column, gripper_open, rate)
    target = checked_output(output, DEMOS, force=force, inputs=[file])
    with progress(f"replaying {file}"):
        demos = read_recordings(file, config)
    target.write(encode_demos(demos, str(output)))
    objects = ", ".join(f"{name} - {kind}" for name, kind in demos[0].objects.items())
    tasks = ", ".join(sorted({d.task for d in demos}))
    seconds = sum(d.duration_s for d in demos)
    remark(f"{output}: {len(demos)} demonstrations of {tasks}, {seconds:.0f} s; objects: {objects}")


def read_recordings(path: Path, config: ImportConfig, said: Callable[[str], object] = remark) -> tuple[Demo, ...]:
    """Demonstrations from a recording in any of the formats; what is left out, and what was decided, is said."""
    from symskill_pddl.demos import import_robosuite
    from symskill_pddl.demos.isaac_lab import import_isaac_lab, is_isaac_lab
    from symskill_pddl.robocasa.recordings import import_robocasa, is_robocasa

    if is_robocasa(path):
        if config.types:
            raise InputError("--type is for recordings of robosuite; the objects of RoboCasa's kitchens have their types")
        return import_robocasa(path, config, remark=said)
    if is_isaac_lab(path):
        return import_isaac_lab(path, config, remark=said)
    return import_robosuite(path, config, remark=said)
