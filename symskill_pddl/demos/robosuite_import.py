"""Importer of robosuite's own recordings: HDF5 with simulator states and the model's XML (robomimic keeps the same layout).

The states are replayed through the recorded model, reduced to its kinematics (`replay`); only poses of named frames, the finger
opening and the commanded gripper are kept. No joint angle enters a demonstration.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from symskill_pddl.demos.demo import Demo
from symskill_pddl.demos.recorded import Recorded, read_recording
from symskill_pddl.demos.replay import KinematicModel, type_name
from symskill_pddl.errors import FormatError, InputError, alternatives


def import_robosuite(path: str | Path, *, types: Mapping[str, str] | None = None) -> tuple[Demo, ...]:
    """Read a robosuite or robomimic recording as demonstrations.

    Parameters
    ----------
    path : str or Path
        See `read_recording`.
    types : mapping of str to str, optional
        Type for objects by name, ``{"cubeA": "cube", "cubeB": "cube"}``. Others get their name without trailing digits.

    Returns
    -------
    tuple of Demo
        Sorted by name. The gripper is closed where the last entry of an action is positive (robosuite: -1 opens, 1 closes,
        0 holds); on a base that drives, the seventh entry.

    Raises
    ------
    InputError
        If the file does not exist, its model is missing, or `types` names an object that is in no demonstration.
    FormatError
        If the file is damaged or is no such recording, or is one of two arms or of a gripper without sliding fingers.
    """
    demos = read_recording(path, lambda recorded: _demo(recorded, types or {}))
    known = {name for demo in demos for name in demo.objects}
    if unknown := sorted(set(types or {}) - known):
        raise InputError(
            f"'{path}': a type is given for the unknown object '{unknown[0]}'; the recordings have: {alternatives(known)}"
        )
    return demos


def _demo(recorded: Recorded, types: Mapping[str, str]) -> Demo:
    try:
        model = KinematicModel(recorded.xml)
    except FormatError as error:
        raise recorded.fail(str(error)) from None
    recorded.check_states(model.state_size)
    replayed = model.replay(recorded.states)
    objects = {o.name: types.get(o.name, type_name(o.name)) for o in model.objects}
    extents: dict[str, tuple[float, float, float]] = {}
    for tracked in model.objects:
        if tracked.half_size is not None:
            type_ = objects[tracked.name]
            a, b, c = (max(x, y) for x, y in zip(tracked.half_size, extents.get(type_, tracked.half_size), strict=True))
            extents[type_] = (a, b, c)
    try:
        return Demo(
            name=recorded.name,
            source=recorded.source,
            task=str(recorded.env["env_name"]),
            times=recorded.times,
            T_world_ee=replayed.T_world_ee,
            aperture=replayed.aperture,
            gripper_closed=recorded.closed,
            objects=objects,
            T_world_objects=replayed.T_world_objects,
            extents=extents,
            attributes={"imported_from": "robosuite", **recorded.kept},
        )
    except InputError as error:
        raise recorded.fail(str(error).removeprefix(f"{recorded.source}:{recorded.name}: ")) from None
