"""What recordings of a simulator have in common, whichever file they came in: states, the model's XML, and what was done.

Poses of objects are in no such file; they are replayed from the states, by who knows which frames matter.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from symskill_pddl.demos.demo import BoolArray
from symskill_pddl.demos.gripper import Convention
from symskill_pddl.demos.hdf5 import FORMAT, natural_key
from symskill_pddl.demos.importing import HOW, ImportConfig, Remark, each, no_hdf5, task_name, warn
from symskill_pddl.demos.safe_hdf5 import Dataset, Group, opened
from symskill_pddl.errors import FormatError, InputError, alternatives
from symskill_pddl.geometry import Array
from symskill_pddl.reading import parse_json, read_text

T = TypeVar("T")

DEFAULT_CONTROL_HZ = 20.0
ARM_ACTION = 6
"""Numbers of an action that move the end effector; where the arm stands on a base that drives, the gripper's follows them."""
OLD_GRIPPER, OLD_MIDDLE = "gripper_actuations", -0.5
"""What robosuite 0.x calls the gripper's commands: -1 opens, 0 and 1 close."""


@dataclass(frozen=True, eq=False)
class Recorded:
    """One recorded episode.

    Attributes
    ----------
    where : str
        For messages: the file and the episode in it.
    source, name : str
        Stem of the file, and name of the episode.
    env : dict
        The environment's description, or nothing.
    meta : dict
        RoboCasa's description of the episode, or nothing.
    xml : str
        The model.
    states : ndarray (n, 1 + nq + nv)
        Time, joint positions, joint velocities.
    actions : ndarray (n, m)
        What the robot was commanded to do.
    convention : Convention
        Which of their columns is the gripper's in this layout, and how it is read.
    times : ndarray (n,)
        Seconds from the first state.
    kept : dict
        Attributes for the demonstration.
    problem : dict
        LIBERO's description of the task, or nothing.
    """

    where: str
    source: str
    name: str
    env: Mapping[str, Any]
    meta: Mapping[str, Any]
    xml: str
    states: Array
    actions: Array
    convention: Convention
    times: Array
    kept: Mapping[str, str | int | float] = field(default_factory=dict)
    problem: Mapping[str, Any] = field(default_factory=dict)

    @property
    def closed(self) -> BoolArray:
        """What the fingers were commanded to do (n,), if they were told as this layout tells them."""
        return self.convention.closed(self.actions)

    @property
    def task(self) -> str:
        """What was shown: the language instruction, else the environment's name."""
        return task_name(self.lang) or str(self.env["env_name"])

    @property
    def lang(self) -> str:
        """The language instruction, if there is one: RoboCasa's and MimicGen's, or LIBERO's."""
        found = [self.meta.get("lang"), self.problem.get("language_instruction")]
        texts = ["".join(text) if isinstance(text, list) and all(isinstance(t, str) for t in text) else text for text in found]
        return next((text for text in texts if isinstance(text, str) and text.strip()), "")

    def fail(self, message: str) -> FormatError:
        """An error about this episode."""
        return FormatError(f"{self.where}: {message}")

    def check_states(self, size: int) -> None:
        """Raise if the states have another number of columns than the model's `size`."""
        if self.states.shape[1] != size:
            raise self.fail(f"states have {self.states.shape[1]} numbers, the model needs {size} (time, positions, velocities)")


def read_recording(
    path: str | Path, make: Callable[[Recorded], T], config: ImportConfig | None = None, remark: Remark = warn
) -> tuple[T, ...]:
    """Apply `make` to each episode of a robosuite or robomimic recording, sorted by name, one in memory at a time.

    Parameters
    ----------
    path : str or Path
        HDF5 with ``data/demo_*/{states, actions}``, or ``gripper_actuations`` in place of actions (robosuite 0.x). The model XML
        is the demonstration's attribute ``model_file``, or, in old recordings, a file of that name: beside the recording, in
        ``models/`` there, or with the recording's stem in front (``lift.hdf5``: ``lift_model_1.xml``).
    make : callable
    config : ImportConfig, optional
        Which episodes.
    remark : callable
        Is told what is left out.

    Raises
    ------
    InputError
        If the file does not exist, an episode that is asked for is not there, or its model is missing.
    FormatError
        If the file is damaged or is no such recording, or no episode of it can be used.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(
            f"'{path}' {'is a folder without meta/info.json' if path.is_dir() else 'does not exist'}; "
            "expected an HDF5 recording of robosuite, robomimic, RoboCasa or Isaac Lab, or the folder of a LeRobot dataset"
        )
    if (foreign := no_hdf5(path)) is not None:
        raise foreign
    with opened(path) as file:
        data = file.get("data")
        names = sorted((k for k in data if isinstance(data[k], Group)), key=natural_key) if isinstance(data, Group) else []
        if not isinstance(data, Group) or not names:
            raise FormatError(f"'{path}': data: no demonstrations (data/demo_1, ...); the file has: {alternatives(file)}; {HOW}")
        if data.attrs.get("format") == FORMAT:
            raise InputError(f"'{path}' holds demonstrations already: learn from them with 'symskill learn'")
        chosen = (config or ImportConfig()).chosen(names, filter_keys(file), f"'{path}'")
        return each(chosen, lambda name: make(_Episode(path, data, name).recorded()), f"'{path}'", remark)


def filter_keys(file: Group) -> dict[str, tuple[str, ...]]:
    """Lists of episodes by name: robomimic's ``mask``."""
    mask = file.get("mask")
    if not isinstance(mask, Group):
        return {}
    return {key: found.texts() for key in mask if isinstance(found := mask[key], Dataset)}


class _Episode:
    """One demonstration of a file."""

    def __init__(self, path: Path, data: Group, name: str) -> None:
        self.path, self.name = path, name
        group = data[name]
        assert isinstance(group, Group)
        self.group, self.attributes = group, {**data.attrs.plain(), **group.attrs.plain()}

    def fail(self, message: str) -> FormatError:
        return FormatError(f"'{self.path}': data/{self.name}: {message}")

    def recorded(self) -> Recorded:
        env = self._json("env_args") or self._json("env_info")
        env.setdefault("env_name", str(self.attributes.get("env") or "unknown"))
        check_one_arm(env, self.fail)
        xml = self._model_xml()
        states = self._array("states")
        actions, convention = self._actions(xml)
        if len(actions) != len(states):
            raise self.fail(f"{len(actions)} actions do not match {len(states)} states")
        kept: dict[str, str | int | float] = {}
        for ours, theirs in (("env_version", "repository_version"), ("recorded_on", "date")):
            if isinstance(value := self.attributes.get(theirs), str):
                kept[ours] = value
        return Recorded(
            where=f"'{self.path}': data/{self.name}",
            source=self.path.stem,
            name=self.name,
            env=env,
            meta=self._json("ep_meta"),
            xml=xml,
            states=states,
            actions=actions,
            convention=convention,
            times=times_of(states[:, 0], env, self.fail),
            kept=kept,
            problem=self._json("problem_info"),
        )

    def _actions(self, xml: str) -> tuple[Array, Convention]:
        """Actions, and where the gripper is in them."""
        if "actions" not in self.group and OLD_GRIPPER in self.group:
            return self._array(OLD_GRIPPER), Convention(0, OLD_MIDDLE)
        actions = self._array("actions")
        # on a base that drives, the last numbers are for that
        mobile = re.search(r"name=\"mobile_?base0_", xml) and actions.shape[1] > ARM_ACTION
        return actions, Convention(ARM_ACTION if mobile else actions.shape[1] - 1)

    def _json(self, key: str) -> dict[str, Any]:
        """An attribute that is a JSON object (robomimic's `env_args`, robosuite's `env_info`, RoboCasa's `ep_meta`); or {}."""
        if key not in self.attributes:
            return {}
        try:
            value = parse_json(str(self.attributes[key]), self.name)
        except FormatError:
            value = None
        if not isinstance(value, dict) or not isinstance(value.get("env_kwargs", {}), dict):
            raise self.fail(f"attribute '{key}' has to be a JSON object")
        return value

    def _model_xml(self) -> str:
        model = self.attributes.get("model_file")
        if not isinstance(model, str) or not model.strip():
            raise self.fail(
                "has no attribute 'model_file': without the model's XML its states cannot be read; files of observations "
                f"lack it, the file that they were made from (demo.hdf5) has it; {HOW}"
            )
        if model.lstrip().startswith("<"):
            return str(model)
        file = Path(model.replace("\\", "/")).name  # the folder in front of it is of another machine
        folder = self.path.parent
        candidates = (folder / f"{self.path.stem}_{file}", folder / "models" / file, folder / file)
        for candidate in candidates:
            if candidate.is_file():
                return read_text(candidate, "model")
        looked = ", ".join(f"'{c}'" for c in candidates)
        raise InputError(f"'{self.path}': data/{self.name}: its model '{file}' is missing; put it at one of {looked}")

    def _array(self, name: str) -> Array:
        dataset = self.group.get(name)
        if not isinstance(dataset, Dataset):
            raise self.fail(f"there is no dataset '{name}'; it has: {alternatives(map(str, self.group))}")
        if dataset.ndim == 2 and dataset.shape[0] < 2:
            raise self.fail(f"it has {dataset.shape[0]} samples, a demonstration needs at least 2")
        if dataset.ndim != 2 or dataset.shape[1] < 1 or dataset.dtype.kind not in "fiu":
            raise self.fail(f"'{name}' has to be numbers (n >= 2, m >= 1), found {dataset.dtype} {dataset.shape}")
        return finite(name, np.asarray(dataset[...], dtype=np.float64), self.fail)


def check_one_arm(env: Mapping[str, Any], fail: Callable[[str], FormatError]) -> None:
    """Raise if the environment has several robots."""
    robots = env.get("env_kwargs", env).get("robots")
    if isinstance(robots, list) and len(robots) > 1:
        raise fail(
            f"only recordings of one arm can be imported, this one has {len(robots)} robots ({', '.join(map(str, robots))})"
        )


def finite(name: str, values: Array, fail: Callable[[str], FormatError]) -> Array:
    """The values, if all are finite."""
    bad = np.argwhere(~np.isfinite(values))
    if bad.size:
        raise fail(f"'{name}' holds a number that is not finite, at row {bad[0][0]}")
    return values


def times_of(recorded: Array, env: Mapping[str, Any], fail: Callable[[str], FormatError]) -> Array:
    """Seconds (n,) from the first state, by the simulator's clock where that goes on, else by the control rate."""
    if np.all(np.diff(recorded) > 0):
        return recorded - recorded[0]
    # some collectors reset the simulator's clock in between: the rate is what they all share
    rate = env.get("env_kwargs", env).get("control_freq", DEFAULT_CONTROL_HZ)
    if not isinstance(rate, int | float) or not rate > 0:
        raise fail(f"control_freq has to be a positive number of hertz, found {rate!r}")
    return np.arange(len(recorded)) / float(rate)
