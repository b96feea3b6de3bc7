"""Importer of robosuite's own recordings: HDF5 with simulator states and the model's XML (robomimic keeps the same layout).

The states are replayed through the recorded model, reduced to its kinematics (`replay`); only poses of named frames, the finger
opening and the commanded gripper are kept. No joint angle enters a demonstration.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from symskill_pddl.demos.demo import BoolArray, Demo
from symskill_pddl.demos.hdf5 import natural_key
from symskill_pddl.demos.replay import KinematicModel, type_name
from symskill_pddl.errors import FormatError, InputError, alternatives
from symskill_pddl.geometry import Array

DEFAULT_CONTROL_HZ = 20.0


def import_robosuite(path: str | Path, *, types: Mapping[str, str] | None = None) -> tuple[Demo, ...]:
    """Read a robosuite or robomimic recording as demonstrations.

    Parameters
    ----------
    path : str or Path
        HDF5 with ``data/demo_*/{states, actions}``. The model XML is the demonstration's attribute ``model_file``, or, in old
        recordings, a file of that name: beside the recording, in ``models/`` there, or with the recording's stem in front
        (``lift.hdf5``: ``lift_model_1.xml``).
    types : mapping of str to str, optional
        Type for objects by name, ``{"cubeA": "cube", "cubeB": "cube"}``. Others get their name without trailing digits.

    Returns
    -------
    tuple of Demo
        Sorted by name. The gripper is closed where the last entry of an action is positive (robosuite: -1 opens, 1 closes,
        0 holds).

    Raises
    ------
    InputError
        If the file does not exist, its model is missing, or `types` names an object that is in no demonstration.
    FormatError
        If the file is damaged or is no such recording, or is one of two arms or of a gripper without sliding fingers.
    """
    import h5py

    path = Path(path)
    if not path.is_file():
        raise InputError(
            f"'{path}' {'is a folder' if path.is_dir() else 'does not exist'}; expected a robosuite or robomimic HDF5 recording"
        )
    try:
        with h5py.File(path, "r") as file:
            data = file.get("data")
            if not isinstance(data, h5py.Group) or not any(isinstance(data[k], h5py.Group) for k in data):
                raise FormatError(
                    f"'{path}': data: no demonstrations (data/demo_1, ...); the file has: {alternatives(map(str, file))}"
                )
            names = sorted((str(k) for k in data if isinstance(data[k], h5py.Group)), key=natural_key)
            demos = tuple(_Recording(path, data, name).demo(types or {}) for name in names)
    except InputError:
        raise
    except PermissionError as error:
        raise InputError(f"cannot read '{path}': {error.strerror or 'permission denied'}") from error
    except (OSError, RuntimeError, KeyError, ValueError, TypeError, UnicodeError, OverflowError, MemoryError) as error:
        reason = " ".join(str(error).split())[:160]
        raise FormatError(f"'{path}' is not a readable HDF5 file (damaged or truncated): {reason}") from error
    known = {name for demo in demos for name in demo.objects}
    if unknown := sorted(set(types or {}) - known):
        raise InputError(
            f"'{path}': a type is given for the unknown object '{unknown[0]}'; the recordings have: {alternatives(known)}"
        )
    return demos


class _Recording:
    """One demonstration of a file."""

    def __init__(self, path: Path, data: Any, name: str) -> None:
        self.path, self.name, self.group = path, name, data[name]
        self.attributes = {**dict(data.attrs), **dict(self.group.attrs)}
        self.env = self._env()

    def fail(self, message: str) -> FormatError:
        return FormatError(f"'{self.path}': data/{self.name}: {message}")

    def demo(self, types: Mapping[str, str]) -> Demo:
        robots = self.env.get("env_kwargs", self.env).get("robots")
        if isinstance(robots, list) and len(robots) > 1:
            raise self.fail(
                f"only recordings of one arm can be imported, this one has {len(robots)} robots ({', '.join(map(str, robots))})"
            )
        xml = self._model_xml()
        states = self._array("states")
        actions = self._array("actions")
        if len(actions) != len(states):
            raise self.fail(f"{len(actions)} actions do not match {len(states)} states")
        try:
            model = KinematicModel(xml)
        except FormatError as error:
            raise self.fail(str(error)) from None
        if states.shape[1] != model.state_size:
            raise self.fail(
                f"states have {states.shape[1]} numbers, the model needs {model.state_size} (time, positions, velocities)"
            )
        replayed = model.replay(states)
        objects = {o.name: types.get(o.name, type_name(o.name)) for o in model.objects}
        extents: dict[str, tuple[float, float, float]] = {}
        for tracked in model.objects:
            if tracked.half_size is not None:
                type_ = objects[tracked.name]
                a, b, c = (max(x, y) for x, y in zip(tracked.half_size, extents.get(type_, tracked.half_size), strict=True))
                extents[type_] = (a, b, c)
        try:
            return Demo(
                name=self.name,
                source=self.path.stem,
                task=str(self.env.get("env_name") or self.attributes.get("env") or "unknown"),
                times=self._times(states[:, 0]),
                T_world_ee=replayed.T_world_ee,
                aperture=replayed.aperture,
                gripper_closed=commanded_closed(actions[:, -1]),
                objects=objects,
                T_world_objects=replayed.T_world_objects,
                extents=extents,
                attributes=self._kept_attributes(),
            )
        except InputError as error:
            raise self.fail(str(error).removeprefix(f"{self.path.stem}:{self.name}: ")) from None

    def _env(self) -> dict[str, Any]:
        """The environment's description: robomimic's `env_args`, robosuite's `env_info`; empty where neither is."""
        for key in ("env_args", "env_info"):
            if key in self.attributes:
                try:
                    env = json.loads(self.attributes[key])
                except (json.JSONDecodeError, TypeError):
                    env = None
                if not isinstance(env, dict) or not isinstance(env.get("env_kwargs", {}), dict):
                    raise self.fail(f"attribute '{key}' has to be a JSON object")
                return env
        return {}

    def _model_xml(self) -> str:
        model = self.attributes.get("model_file")
        if isinstance(model, bytes):
            model = model.decode("utf-8")
        if not isinstance(model, str) or not model.strip():
            raise self.fail(
                "has no attribute 'model_file': without the model's XML its states cannot be read; export the states file with it"
            )
        if model.lstrip().startswith("<"):
            return str(model)
        file = Path(model.replace("\\", "/")).name  # the folder in front of it is of another machine
        folder = self.path.parent
        candidates = (folder / f"{self.path.stem}_{file}", folder / "models" / file, folder / file)
        for candidate in candidates:
            if candidate.is_file():
                try:
                    return candidate.read_text(encoding="utf-8")
                except (OSError, UnicodeError) as error:
                    raise self.fail(f"cannot read the model '{candidate}': {error}") from error
        looked = ", ".join(f"'{c}'" for c in candidates)
        raise InputError(f"'{self.path}': data/{self.name}: its model '{file}' is missing; put it at one of {looked}")

    def _array(self, name: str) -> Array:
        import h5py

        dataset = self.group.get(name)
        if not isinstance(dataset, h5py.Dataset):
            raise self.fail(f"there is no dataset '{name}'; it has: {alternatives(map(str, self.group))}")
        if dataset.ndim != 2 or dataset.shape[0] < 2 or dataset.shape[1] < 1 or dataset.dtype.kind not in "fiu":
            raise self.fail(f"'{name}' has to be numbers (n >= 2, m >= 1), found {dataset.dtype} {dataset.shape}")
        values = np.asarray(dataset[...], dtype=np.float64)
        bad = np.argwhere(~np.isfinite(values))
        if bad.size:
            raise self.fail(f"'{name}' holds a number that is not finite, at row {bad[0][0]}")
        return values

    def _times(self, recorded: Array) -> Array:
        if np.all(np.diff(recorded) > 0):
            return recorded - recorded[0]
        # some collectors reset the simulator's clock in between: the rate is what they all share
        rate = self.env.get("env_kwargs", self.env).get("control_freq", DEFAULT_CONTROL_HZ)
        if not isinstance(rate, int | float) or not rate > 0:
            raise self.fail(f"control_freq has to be a positive number of hertz, found {rate!r}")
        return np.arange(len(recorded)) / float(rate)

    def _kept_attributes(self) -> dict[str, str | int | float]:
        kept: dict[str, str | int | float] = {"imported_from": "robosuite"}
        for ours, theirs in (("env_version", "repository_version"), ("recorded_on", "date")):
            if isinstance(value := self.attributes.get(theirs), str):
                kept[ours] = value
        return kept


def commanded_closed(command: Array) -> BoolArray:
    """The gripper's commanded state (n,) from robosuite's gripper action (n,): > 0 closes, < 0 opens, 0 holds; open at first."""
    last = np.maximum.accumulate(np.where(command != 0, np.arange(len(command)), -1))
    return np.asarray((last >= 0) & (command[np.maximum(last, 0)] > 0))
