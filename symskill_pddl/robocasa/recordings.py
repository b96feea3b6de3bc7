"""Importer of RoboCasa's own recordings: robomimic HDF5, as of RoboCasa 0.2, and LeRobot datasets, as of RoboCasa 365.

The recorded states are replayed through the recorded model; RoboCasa itself is not needed. Objects, their names, types and frames
are those of a run in RoboCasa (`tracking`, `view`), so what is learned from a recording holds there. What RoboCasa's fixture
would say of itself is read from the names in the model and from the recorded ``ep_meta``.
"""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from symskill_pddl.demos.demo import Demo
from symskill_pddl.demos.lerobot import is_lerobot, read_lerobot
from symskill_pddl.demos.recorded import Recorded, read_recording
from symskill_pddl.demos.replay import KinematicModel
from symskill_pddl.errors import FormatError, InputError, alternatives
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.panda.arm import Q_GRIP_EE
from symskill_pddl.robocasa.tasks import TASKS, TaskSpec
from symskill_pddl.robocasa.tracking import FIXTURES, Model
from symskill_pddl.robocasa.view import View

BASE = "robot0_link0"


def is_robocasa(path: str | Path) -> bool:
    """Whether a path is a LeRobot dataset, or an HDF5 recording with RoboCasa's descriptions of episodes."""
    import h5py

    if is_lerobot(path):
        return True
    try:
        with h5py.File(path, "r") as file:
            data = file.get("data")
            return isinstance(data, h5py.Group) and any("ep_meta" in data[name].attrs for name in data)
    except OSError:
        return False


def import_robocasa(path: str | Path) -> tuple[Demo, ...]:
    """Read a recording of RoboCasa as demonstrations.

    Parameters
    ----------
    path : str or Path
        An HDF5 file (see `read_recording`) whose demonstrations have the attribute ``ep_meta``, or a LeRobot dataset's folder
        (see `read_lerobot`).

    Returns
    -------
    tuple of Demo
        Sorted by name, as seen from where the robot's arm stands at first.

    Raises
    ------
    InputError
        If there is no such file, or it is of a task that is none of `TASKS`.
    FormatError
        If it is damaged, or its model has not the fixture that the task is about.
    MissingDependencyError
        For a LeRobot dataset, without pyarrow.
    """
    return read_lerobot(path, _demo) if is_lerobot(path) else read_recording(path, _demo)


def _demo(recorded: Recorded) -> Demo:
    spec = _task(recorded)
    try:
        model = KinematicModel(recorded.xml)
        recorded.check_states(model.state_size)
        model.pose(recorded.states[0])
        found = Model(model.mujoco, model.model, model.data)
        fixture = FIXTURES[spec.about](found, _episode(recorded), _fixture(recorded, spec, model))
    except FormatError as error:
        raise recorded.fail(str(error).removeprefix(f"{recorded.where}: ")) from None
    base = model.data.body(BASE)
    yaw = 2.0 * np.arctan2(base.xquat[3], base.xquat[0])
    view = View(Pose(base.xpos.copy(), np.array([np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)])), fixture.mirrored)
    tracked = (fixture.moving.tracked, fixture.unit)
    T_world_ee, T_world_bodies = _poses(model, recorded.states, [t.body for t in tracked])
    T_world = T_world_bodies @ Pose.stack([t.T_body_frame for t in tracked])
    attributes: dict[str, str | int | float] = {"imported_from": "robocasa", **recorded.kept}
    for key in ("layout_id", "style_id", "lang"):
        if isinstance(value := recorded.meta.get(key), str | int):
            attributes[key] = value
    return Demo(
        name=recorded.name,
        source=recorded.source,
        task=spec.name,
        times=recorded.times,
        T_world_ee=view.pose(T_world_ee),
        aperture=model.aperture(recorded.states),
        gripper_closed=recorded.closed,
        objects={t.name: t.type for t in tracked},
        T_world_objects=view.pose(T_world),
        extents={t.type: t.half for t in tracked if t.half is not None},
        attributes=attributes,
    )


def _task(recorded: Recorded) -> TaskSpec:
    """The task: 365 has names of its own for RoboCasa's tasks, 0.2 those of the paper."""
    env = str(recorded.env["env_name"])
    specs = [spec for spec in TASKS.values() if spec.about in FIXTURES]
    for spec in specs:
        if env in (spec.name, spec.env):
            return spec
    known = alternatives({name for spec in specs for name in (spec.env, spec.name)})
    raise InputError(f"{recorded.where}: it is of '{env}'; tasks that can be imported: {known}")


def _episode(recorded: Recorded) -> Any:
    """What the environment says of the episode besides its fixtures."""
    side = "left" if " left " in str(recorded.meta.get("lang", "")) else "right"
    return SimpleNamespace(knob=_mapping(recorded.meta.get("task_refs")).get("knob"), drawer_side=side)


def _mapping(value: object) -> dict[str, Any]:
    return value if isinstance(value, dict) else {}


def _fixture(recorded: Recorded, spec: TaskSpec, model: KinematicModel) -> RecordedFixture:
    """The fixture that the task is about: one that the episode's description names, or whose joint the task is named after.

    Raises
    ------
    FormatError
        There is none, or it has two doors.
    """
    joints = [str(model.model.joint(j).name) for j in range(model.model.njnt)]
    references = [str(name) for name in _mapping(recorded.meta.get("fixture_refs")).values()]
    if spec.about in ("door", "drawer"):
        word = "door" if spec.about == "door" else "slidejoint"
        names = [r for r in references if any(j.startswith(f"{r}_") and word in j for j in joints)]
        lacking = f"names no fixture with a {spec.about} ('fixture_refs': {alternatives(references)})"
    else:
        knob = _mapping(recorded.meta.get("task_refs")).get("knob")
        ending = "_handle_joint" if spec.about == "lever" else f"_knob_{knob}_joint"
        names = [j.removesuffix(ending) for j in joints if j.endswith(ending)]
        if spec.about == "lever":
            # refrigerators and ovens have handles too
            names = [name for name in names if f"{name}_spout_joint" in joints]
        lacking = f"has no joint '...{ending}'" if spec.about == "lever" or knob else "names no knob ('task_refs')"
    if not names:
        raise FormatError(f"task '{spec.name}': the recording {lacking}")
    fixture = RecordedFixture(names[0], joints)
    if spec.about == "door" and len(fixture.door_joint_names) != 1:
        raise FormatError(f"'{fixture.name}' has {len(fixture.door_joint_names)} doors; task '{spec.name}' is about one")
    return fixture


class RecordedFixture:
    """What `tracking` asks RoboCasa's fixtures for, read from the recorded model."""

    def __init__(self, name: str, joints: list[str]) -> None:
        self.name = name
        self.door_joint_names = [j for j in joints if j.startswith(f"{name}_") and "door" in j.removeprefix(name)]


def _poses(model: KinematicModel, states: Array, bodies: list[int]) -> tuple[Pose, Pose]:
    """Poses of the gripper (n,) and of bodies (n, m) in the simulator's world.

    The hand is the same from both sides; which one is which has to be as in a run, so its frame is made of the site as there.
    """
    R = np.zeros((len(states), 4, 4))
    p, q = np.empty((len(states), len(bodies), 3)), np.empty((len(states), len(bodies), 4))
    for i, state in enumerate(states):
        model.pose(state)
        R[i, :3, :3], R[i, :3, 3], R[i, 3, 3] = model.grip.xmat.reshape(3, 3), model.grip.xpos, 1.0
        p[i], q[i] = model.data.xpos[bodies], model.data.xquat[bodies]
    return Pose.from_matrix(R) @ Pose(np.zeros(3), Q_GRIP_EE), Pose(p, q)
