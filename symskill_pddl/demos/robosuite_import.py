"""Importer of robosuite's own recordings: HDF5 with simulator states and the model's XML (robomimic keeps the same layout).

The states are replayed through the recorded model, reduced to its kinematics (`replay`); only poses of named frames, the finger
opening and the commanded gripper are kept. No joint angle enters a demonstration.
"""

from __future__ import annotations

from pathlib import Path

from symskill_pddl.demos.demo import Demo
from symskill_pddl.demos.gripper import Told, with_commands
from symskill_pddl.demos.importing import ImportConfig, Remark, warn
from symskill_pddl.demos.recorded import Recorded, read_recording
from symskill_pddl.demos.replay import KinematicModel, type_name
from symskill_pddl.errors import FormatError, InputError, alternatives


def import_robosuite(path: str | Path, config: ImportConfig | None = None, *, remark: Remark = warn) -> tuple[Demo, ...]:
    """Read a robosuite or robomimic recording as demonstrations.

    Parameters
    ----------
    path : str or Path
        See `read_recording`.
    config : ImportConfig, optional
    remark : callable
        Is told, line by line, what is left out; Python's warnings, if nothing is given.

    Returns
    -------
    tuple of Demo
        Sorted by name. The gripper is closed where the last entry of an action is positive (robosuite: -1 opens, 1 closes,
        0 holds); on a base that drives, the seventh entry; or as `config` says.

    Raises
    ------
    InputError
        If the file does not exist, its model is missing, `config` names what is in no demonstration, or the fingers do not follow
        the gripper's commands.
    FormatError
        If the file is damaged or is no such recording, or is one of two arms.
    """
    config = config or ImportConfig()
    told = read_recording(path, lambda recorded: _told(recorded, config), config, remark)
    known = {name for one in told for name in one.demo.objects}
    if unknown := sorted(set(config.types) - known):
        raise InputError(
            f"'{path}': a type is given for the unknown object '{unknown[0]}'; the recordings have: {alternatives(known)}"
        )
    return with_commands(told, f"'{path}'", remark, column=config.gripper_column, opens=config.gripper_open)


def _told(recorded: Recorded, config: ImportConfig) -> Told:
    try:
        model = KinematicModel(recorded.xml)
    except FormatError as error:
        raise type(error)(str(recorded.fail(str(error)))) from None
    recorded.check_states(model.state_size)
    replayed = model.replay(recorded.states)
    objects = {o.name: config.types.get(o.name, type_name(o.name)) for o in model.objects}
    extents: dict[str, tuple[float, float, float]] = {}
    for tracked in model.objects:
        if tracked.half_size is not None:
            type_ = objects[tracked.name]
            a, b, c = (max(x, y) for x, y in zip(tracked.half_size, extents.get(type_, tracked.half_size), strict=True))
            extents[type_] = (a, b, c)
    attributes: dict[str, str | int | float] = {
        "imported_from": "robosuite",
        "env": str(recorded.env["env_name"]),
        **recorded.kept,
    }
    if recorded.lang:
        attributes["lang"] = recorded.lang
    try:
        demo = Demo(
            name=recorded.name,
            source=recorded.source,
            task=config.task or recorded.task,
            times=recorded.times,
            T_world_ee=replayed.T_world_ee,
            aperture=replayed.aperture,
            gripper_closed=recorded.closed,
            objects=objects,
            T_world_objects=replayed.T_world_objects,
            extents=extents,
            attributes=attributes,
        )
    except InputError as error:
        raise recorded.fail(str(error).removeprefix(f"{recorded.source}:{recorded.name}: ")) from None
    return Told(demo, recorded.actions, recorded.convention)
