"""Importer of Isaac Lab's recordings: HDF5 with poses of bodies, and no model.

::

    data                        attributes: env_args (JSON: env_name, and in newer files sim_args with dt and decimation)
      demo_0
        actions        (n, m)   the last one is the gripper's: 1 opens, -1 closes
        obs/eef_pos    (n, 3), eef_quat (n, 4), gripper_pos (n, 2)
        states/rigid_object/<name>/root_pose  (n, 7)   m and quaternion (w, x, y, z)
        states/articulation/<name>/root_pose, joint_position

Objects are the rigid bodies and the roots of articulations other than the robot. The hand's pose is an observation, as Isaac
Lab's own manipulation tasks record it; without it nothing can be imported, since the robot's model is not in the file.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from symskill_pddl.demos.demo import Demo
from symskill_pddl.demos.gripper import Convention, Told, with_commands
from symskill_pddl.demos.hdf5 import natural_key
from symskill_pddl.demos.importing import HOW, ImportConfig, Remark, each, task_name, warn
from symskill_pddl.demos.recorded import filter_keys
from symskill_pddl.demos.replay import type_name
from symskill_pddl.demos.safe_hdf5 import Dataset, Group, opened
from symskill_pddl.errors import FormatError, InputError, alternatives
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.reading import parse_json

ROBOT = "robot"
"""What Isaac Lab calls the robot among the articulations."""


def is_isaac_lab(path: str | Path) -> bool:
    """Whether a path is an HDF5 file whose states are groups of bodies."""
    if not Path(path).is_file():
        return False
    try:
        with opened(path) as file:
            data = file.get("data")
            members = [data[name] for name in data] if isinstance(data, Group) else []
            return any(isinstance(m, Group) and isinstance(m.get("states"), Group) for m in members)
    except InputError:
        return False


def import_isaac_lab(path: str | Path, config: ImportConfig | None = None, *, remark: Remark = warn) -> tuple[Demo, ...]:
    """Read an Isaac Lab recording as demonstrations.

    Parameters
    ----------
    path : str or Path
    config : ImportConfig, optional
        `rate_hz` is needed where the file does not say it.
    remark : callable
        Is told, line by line, what is left out; Python's warnings, if nothing is given.

    Raises
    ------
    InputError
        If it does not say the rate, or the fingers do not follow the gripper's commands.
    FormatError
        If it is damaged, or lacks the hand's pose.
    """
    path, config = Path(path), config or ImportConfig()
    with opened(path) as file:
        data = file["data"]
        assert isinstance(data, Group)
        names = config.chosen(sorted(data, key=natural_key), filter_keys(file), f"'{path}'")
        env = _env(data.attrs, path)
        told = each(names, lambda name: _Episode(path, name, data[name]).told(env, config), f"'{path}'", remark)
    return with_commands(told, f"'{path}'", remark, column=config.gripper_column, opens=config.gripper_open)


def _env(attributes: Mapping[str, Any], path: Path) -> dict[str, Any]:
    try:
        env = parse_json(str(attributes.get("env_args", "{}")), str(path))
    except FormatError:
        env = None
    if not isinstance(env, dict):
        raise FormatError(f"'{path}': data: attribute 'env_args' has to be a JSON object")
    return env


class _Episode:
    """One demonstration of a file."""

    def __init__(self, path: Path, name: str, group: Any) -> None:
        self.path, self.name, self.group = path, name, group

    def fail(self, message: str) -> FormatError:
        return FormatError(f"'{self.path}': data/{self.name}: {message}")

    def told(self, env: Mapping[str, Any], config: ImportConfig) -> Told:
        actions = self.array("actions")
        n = len(actions)
        if any(self.member(f"obs/{name}") is None for name in ("eef_pos", "eef_quat", "gripper_pos")):
            raise self.fail(
                "this is a recording of Isaac Lab without the hand's pose (obs/eef_pos, obs/eef_quat, obs/gripper_pos, as its "
                f"manipulation tasks record them), and the robot's model is not in it; record these, or: {HOW}"
            )
        poses = self.bodies(n)
        if not poses:
            raise self.fail("there is no object: states/rigid_object and states/articulation hold the robot alone")
        try:
            demo = Demo(
                name=self.name,
                source=self.path.stem,
                task=config.task or task_name(str(env.get("env_name") or "unknown")),
                times=np.arange(n) / self.rate(env, config),
                T_world_ee=Pose(self.array("obs/eef_pos", 3, n), self.array("obs/eef_quat", 4, n)),
                aperture=np.abs(self.array("obs/gripper_pos", None, n)).sum(axis=1),
                gripper_closed=np.zeros(n, bool),
                objects={name: config.types.get(name, type_name(name)) for name in poses},
                T_world_objects=Pose.from_vector(np.stack(list(poses.values()), axis=1)),
                attributes={"imported_from": "isaac-lab"},
            )
        except FormatError:
            raise
        except InputError as error:
            raise self.fail(str(error).removeprefix(f"{self.path.stem}:{self.name}: ")) from None
        return Told(demo, actions, Convention(actions.shape[1] - 1, 0.0, -1))

    def bodies(self, n: int) -> dict[str, Array]:
        """Poses (n, 7) by name."""
        found = {}
        for kind in ("articulation", "rigid_object"):
            holder = self.member(f"states/{kind}")
            for name in holder if isinstance(holder, Group) else ():
                if name != ROBOT and self.member(f"states/{kind}/{name}/root_pose") is not None:
                    found[name] = self.array(f"states/{kind}/{name}/root_pose", 7, n)
        return found

    def rate(self, env: Mapping[str, Any], config: ImportConfig) -> float:
        """Samples per second."""
        if config.rate_hz is not None:
            return config.rate_hz
        sim = env.get("sim_args")
        dt, every = (sim.get("dt"), sim.get("decimation")) if isinstance(sim, dict) else (None, None)
        if not (isinstance(dt, int | float) and isinstance(every, int | float) and dt > 0 and every > 0):
            raise InputError(
                f"'{self.path}' does not say its rate (env_args: sim_args with dt and decimation): give it with --rate HZ; "
                "Isaac Lab's stacking tasks run at 20"
            )
        return 1.0 / (dt * every)

    def member(self, name: str) -> Any:
        """A group or data set, by its path in the episode; None if it is not there."""
        found: Any = self.group
        for part in name.split("/"):
            found = found.get(part) if isinstance(found, Group) else None
        return found

    def array(self, name: str, width: int | None = None, n: int | None = None) -> Array:
        """A dataset (n, width) of finite numbers."""
        dataset = self.member(name)
        if not isinstance(dataset, Dataset):
            raise self.fail(f"there is no dataset '{name}'; it has: {alternatives(self.group)}")
        if dataset.ndim != 2 or dataset.shape[0] < 2 or dataset.shape[1] < 1 or dataset.dtype.kind not in "fiu":
            raise self.fail(f"'{name}' has to be numbers (n >= 2, m >= 1), found {dataset.dtype} {dataset.shape}")
        if n not in (None, dataset.shape[0]) or width not in (None, dataset.shape[1]):
            raise self.fail(f"'{name}' has shape {dataset.shape}, expected ({n}, {width or 'm'})")
        values = np.asarray(dataset[...], dtype=np.float64)
        if not np.isfinite(values).all():
            raise self.fail(f"'{name}' holds a number that is not finite, at row {np.argwhere(~np.isfinite(values))[0][0]}")
        return values
