"""Importer of RoboCasa's own recordings: robomimic HDF5, as of RoboCasa 0.2, and LeRobot datasets, as of RoboCasa 365.

The recorded states are replayed through the recorded model; RoboCasa itself is not needed. Objects, their names, types and frames
are those of a run in RoboCasa (`tracking`, `things`, `view`), so what is learned from a recording holds there.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from symskill_pddl.demos.demo import Demo
from symskill_pddl.demos.gripper import Told, with_commands
from symskill_pddl.demos.importing import ImportConfig, Remark, warn
from symskill_pddl.demos.lerobot import is_lerobot, read_lerobot
from symskill_pddl.demos.recorded import Recorded, read_recording
from symskill_pddl.demos.replay import KinematicModel
from symskill_pddl.demos.safe_hdf5 import Group, opened
from symskill_pddl.errors import FormatError, InputError, UnsafeError
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.panda.arm import Q_GRIP_EE
from symskill_pddl.robocasa.custom import described_objects
from symskill_pddl.robocasa.recorded_kitchen import RecordedEnv
from symskill_pddl.robocasa.tasks import TASKS, TaskSpec
from symskill_pddl.robocasa.things import Seen, look
from symskill_pddl.robocasa.tracking import Model, Tracked
from symskill_pddl.robocasa.view import View


def is_robocasa(path: str | Path) -> bool:
    """Whether a path is a LeRobot dataset, or an HDF5 recording with RoboCasa's descriptions of episodes."""
    if is_lerobot(path):
        return True
    if not Path(path).is_file():
        return False
    try:
        with opened(path) as file:
            data = file.get("data")
            return isinstance(data, Group) and any("ep_meta" in data[name].attrs for name in data)
    except InputError:
        return False


def import_robocasa(path: str | Path, config: ImportConfig | None = None, *, remark: Remark = warn) -> tuple[Demo, ...]:
    """Read a recording of RoboCasa as demonstrations.

    Parameters
    ----------
    path : str or Path
        An HDF5 file (see `read_recording`) whose demonstrations have the attribute ``ep_meta``, or a LeRobot dataset's folder
        (see `read_lerobot`).
    config : ImportConfig, optional
    remark : callable
        Is told, line by line, what is left out; Python's warnings, if nothing is given.

    Returns
    -------
    tuple of Demo
        Sorted by name, as seen from where the robot's arm stands at first.

    Raises
    ------
    InputError
        If there is no such file.
    FormatError
        If it is damaged, or its model has not what the task is about.
    MissingDependencyError
        For a LeRobot dataset, without pyarrow.
    """
    config = config or ImportConfig()
    read = read_lerobot if is_lerobot(path) else read_recording
    told = read(path, lambda r: Told(_demo(r, config), r.actions, r.convention), config, remark)
    return with_commands(told, f"'{path}'", remark, column=config.gripper_column, opens=config.gripper_open)


def _demo(recorded: Recorded, config: ImportConfig) -> Demo:
    spec = _task(recorded)
    try:
        model = KinematicModel(recorded.xml)
        recorded.check_states(model.state_size)
        model.pose(recorded.states[0])
        found = Model(model.mujoco, model.model, model.data)
        env = RecordedEnv(found, recorded.meta)
        seen = look(spec.about, found, env, env.fixture(spec)) if spec is not None else _described(model, recorded)
        view = View(found.T_world_robot(), seen.mirrored)
    except UnsafeError as error:
        raise UnsafeError(f"{recorded.where}: {error}") from None
    except (InputError, KeyError) as error:
        raise recorded.fail(" ".join(str(error).split()).removeprefix(f"{recorded.where}: ")) from None
    T_world_ee, aperture, T_world_bodies = _poses(model, recorded.states, [t.body for t in seen.tracked])
    T_world = T_world_bodies @ Pose.stack([t.T_body_frame for t in seen.tracked])
    attributes: dict[str, str | int | float] = {"imported_from": "robocasa", **recorded.kept}
    for key in ("layout_id", "style_id", "lang"):
        if isinstance(value := recorded.meta.get(key), str | int):
            attributes[key] = value
    return Demo(
        name=recorded.name,
        source=recorded.source,
        task=config.task or (spec.name if spec is not None else str(recorded.env["env_name"])),
        times=recorded.times,
        T_world_ee=view.pose(T_world_ee),
        aperture=aperture,
        gripper_closed=recorded.closed,
        objects={t.name: t.type for t in seen.tracked},
        T_world_objects=view.pose(T_world),
        extents={t.type: t.half for t in seen.tracked if t.half is not None},
        attributes=attributes,
    )


def _task(recorded: Recorded) -> TaskSpec | None:
    """The task: 365 has names of its own for RoboCasa's tasks, 0.2 those of the paper; None if it is unknown."""
    env = str(recorded.env["env_name"])
    specs = [spec for spec in TASKS.values() if not spec.composed]
    return next((spec for spec in specs if env in (spec.name, spec.env)), None)


def _described(model: KinematicModel, recorded: Recorded) -> Seen:
    """What an environment that is not known here says it is about."""
    objects = described_objects(model.objects, recorded.meta)
    if not objects:
        raise FormatError(
            f"it is of '{recorded.env['env_name']}', and its description names neither things ('object_cfgs') nor fixtures "
            "('fixture_refs') that the model has"
        )
    still = Pose.identity()
    return Seen(tuple(Tracked(o.name, kind, o.body, still, o.half_size) for o, kind in objects.items()), (), False)


def _poses(model: KinematicModel, states: Array, bodies: list[int]) -> tuple[Pose, Array, Pose]:
    """Poses of the gripper (n,), the opening of its fingers (n,), and poses of bodies (n, m), in the simulator's world.

    The hand is the same from both sides; which one is which has to be as in a run, so its frame is made of the site as there.
    """
    R = np.zeros((len(states), 4, 4))
    p, q = np.empty((len(states), len(bodies), 3)), np.empty((len(states), len(bodies), 4))
    aperture = np.empty(len(states))
    for i, state in enumerate(states):
        model.pose(state)
        R[i, :3, :3], R[i, :3, 3], R[i, 3, 3] = model.grip.xmat.reshape(3, 3), model.grip.xpos, 1.0
        aperture[i] = model.aperture()
        p[i], q[i] = model.data.xpos[bodies], model.data.xquat[bodies]
    return Pose.from_matrix(R) @ Pose(np.zeros(3), Q_GRIP_EE), aperture, Pose(p, q)
