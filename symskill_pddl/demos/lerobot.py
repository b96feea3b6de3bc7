"""Reader of LeRobot datasets of a simulator, as RoboCasa 365 ships them: actions in parquet, states and model of each episode.

A LeRobot dataset by itself holds pictures and the robot's own state, and no object. RoboCasa adds a folder ``extras`` with what
its own replay needs (``episode_*/states.npz, model.xml.gz, ep_meta.json`` and ``dataset_meta.json``); from these the poses come.
"""

from __future__ import annotations

import gzip
import json
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from symskill_pddl.demos.gripper import Convention
from symskill_pddl.demos.importing import HOW, ImportConfig, Remark, each, warn
from symskill_pddl.demos.recorded import Recorded, check_one_arm, finite, times_of
from symskill_pddl.errors import FormatError, InputError, MissingDependencyError, alternatives
from symskill_pddl.geometry import Array

T = TypeVar("T")
INSTALL = "pip install 'symskill-pddl[lerobot]'"


def is_lerobot(path: str | Path) -> bool:
    """Whether a path is the folder of a LeRobot dataset."""
    return (Path(path) / "meta" / "info.json").is_file()


def read_lerobot(
    path: str | Path, make: Callable[[Recorded], T], config: ImportConfig | None = None, remark: Remark = warn
) -> tuple[T, ...]:
    """Apply `make` to each episode of a dataset, in order, one in memory at a time.

    Parameters
    ----------
    path : str or Path
        The dataset's folder, with ``meta``, ``data`` (one parquet file for each episode, as of version 2, or for many, as of
        version 3) and ``extras``.
    make : callable
    config : ImportConfig, optional
        Which episodes: ``demo_3`` is ``episode_000003``.
    remark : callable
        Is told what is left out.

    Raises
    ------
    InputError
        If the folder does not exist or is no LeRobot dataset, or has no ``extras``.
    FormatError
        If a file of it is damaged or does not hold what it should.
    MissingDependencyError
        Without pyarrow.
    """
    folder = Path(path)
    if not is_lerobot(folder):
        raise InputError(f"'{folder}' is no LeRobot dataset: there is no meta/info.json in it")
    episodes = sorted((folder / "extras").glob("episode_*"))
    if not episodes:
        raise InputError(
            f"'{folder}' is a LeRobot dataset without poses of objects (RoboCasa's have them in "
            f"extras/episode_000000): pictures and joint angles do not say where things are; {HOW}"
        )
    for extras in episodes:
        if not extras.name.removeprefix("episode_").isdecimal():
            raise FormatError(f"'{folder}': extras/{extras.name}: the name of an episode's folder has to end in its number")
    env = _json(folder / "extras" / "dataset_meta.json").get("env_args", {})
    if not isinstance(env, dict) or not isinstance(env.get("env_kwargs", {}), dict):
        raise FormatError(f"'{folder}': extras/dataset_meta.json: env_args has to be a JSON object")
    column = _gripper_column(folder)
    by_name = {f"demo_{int(extras.name.removeprefix('episode_'))}": extras for extras in episodes}
    chosen = (config or ImportConfig()).chosen(tuple(by_name), {}, f"'{folder}'")
    return each(chosen, lambda name: make(_episode(folder, by_name[name], env, column)), f"'{folder}'", remark)


def _episode(folder: Path, extras: Path, env: dict[str, Any], column: int) -> Recorded:
    where = f"'{folder}': {extras.name}"

    def fail(message: str) -> FormatError:
        return FormatError(f"{where}: {message}")

    index = int(extras.name.removeprefix("episode_"))
    check_one_arm(env, fail)
    try:
        with np.load(extras / "states.npz", allow_pickle=False) as file:
            states = np.asarray(file["states"], dtype=np.float64)
        xml = gzip.decompress((extras / "model.xml.gz").read_bytes()).decode("utf-8")
    except FileNotFoundError as error:
        raise fail(f"'{Path(str(error.filename)).name}' is missing") from None
    except (OSError, KeyError, ValueError, EOFError, zlib.error, zipfile.BadZipFile, UnicodeError) as error:
        raise fail(f"states.npz or model.xml.gz cannot be read (damaged or truncated): {error}") from error
    if states.ndim != 2 or len(states) < 2:
        raise fail(f"states have to be (n >= 2, m), found {states.shape}")
    states = finite("states", states, fail)
    actions = finite("action", _actions(folder, index, fail), fail)
    if len(actions) != len(states):
        raise fail(f"{len(actions)} actions do not match {len(states)} states")
    if actions.shape[1] <= column:
        raise fail(f"an action has {actions.shape[1]} numbers, the gripper's would be number {column + 1} (meta/modality.json)")
    return Recorded(
        where=where,
        source=folder.name,
        name=f"demo_{index}",
        env={"env_name": "unknown", **env},
        meta=_json(extras / "ep_meta.json"),
        xml=xml,
        states=states,
        actions=actions,
        convention=Convention(column),
        times=times_of(states[:, 0], env, fail),
    )


def _actions(folder: Path, index: int, fail: Callable[[str], FormatError]) -> Array:
    """Actions (n, m) of an episode."""
    try:
        import pyarrow.compute as compute
        import pyarrow.parquet as parquet
        from pyarrow import ArrowException
    except ImportError as error:
        raise MissingDependencyError(f"LeRobot datasets are read with pyarrow: {INSTALL} ({error})") from error
    own = sorted(folder.glob(f"data/*/episode_{index:06d}.parquet"))
    shared = [] if own else sorted(folder.glob("data/*/file-*.parquet"))
    found = []
    try:
        for file in own or shared:
            table = parquet.read_table(file, columns=["action", "episode_index"])
            table = table.filter(compute.equal(table["episode_index"], index))
            found += table["action"].to_pylist()
        if not found:
            raise fail("no actions: there is no parquet file of it in data/")
        return np.array(found, dtype=np.float64).reshape(len(found), -1)
    except (ArrowException, OSError, KeyError, ValueError, TypeError) as error:
        raise fail(f"its parquet file cannot be read: {' '.join(str(error).split())[:160]}") from error


def _gripper_column(folder: Path) -> int:
    """Which number of an action closes the gripper."""
    actions = _json(folder / "meta" / "modality.json").get("action", {})
    gripper = actions.get("gripper_close") if isinstance(actions, dict) else None
    start = gripper.get("start") if isinstance(gripper, dict) else None
    if not isinstance(start, int) or start < 0:
        names = alternatives(actions) if isinstance(actions, dict) else "none"
        raise FormatError(f"'{folder}': meta/modality.json: no action.gripper_close.start; its actions are: {names}")
    return start


def _json(file: Path) -> dict[str, Any]:
    try:
        value = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"'{file}' is missing") from None
    except (OSError, UnicodeError, json.JSONDecodeError) as error:
        raise FormatError(f"'{file}' is not readable JSON: {error}") from error
    if not isinstance(value, dict):
        raise FormatError(f"'{file}' has to be a JSON object")
    return value
