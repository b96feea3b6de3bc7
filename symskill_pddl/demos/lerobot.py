"""Reader of LeRobot datasets of a simulator, as RoboCasa 365 ships them: actions in parquet, states and model of each episode.

A LeRobot dataset by itself holds pictures and the robot's own state, and no object. RoboCasa adds a folder ``extras`` with what
its own replay needs (``episode_*/states.npz, model.xml.gz, ep_meta.json`` and ``dataset_meta.json``); from these the poses come.
"""

from __future__ import annotations

import gzip
import io
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from symskill_pddl.arrays import read_npz
from symskill_pddl.demos.gripper import Convention
from symskill_pddl.demos.importing import HOW, ImportConfig, Remark, each, warn
from symskill_pddl.demos.model_xml import LONGEST
from symskill_pddl.demos.recorded import Recorded, check_one_arm, finite, times_of
from symskill_pddl.errors import FormatError, InputError, MissingDependencyError, alternatives, shown
from symskill_pddl.geometry import Array
from symskill_pddl.reading import parse_json, read_bytes, read_text

T = TypeVar("T")
LARGEST, MOST_VALUES, BATCH = 1_000_000_000, 30_000_000, 4096
"""Bytes of a file of actions, numbers that it may state, and rows that are unpacked at a time."""
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
    arrays = read_npz(_file(extras / "states.npz", fail), f"{where}: states.npz")
    xml = _unpacked(_file(extras / "model.xml.gz", fail), fail)
    if "states" not in arrays or arrays["states"].dtype.kind not in "fiu":
        raise fail(f"states.npz: no array 'states' of numbers; it has: {alternatives(arrays)}")
    states = np.asarray(arrays["states"], dtype=np.float64)
    if states.ndim != 2 or len(states) < 2:
        raise fail(f"states have to be (n >= 2, m), found {states.shape}")
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


def _file(path: Path, fail: Callable[[str], FormatError]) -> bytes:
    try:
        return read_bytes(path, "file of the episode")
    except InputError as error:
        raise fail(str(error)) from None


def _unpacked(content: bytes, fail: Callable[[str], FormatError]) -> str:
    """The text of a gzip file, which is no longer than a model may be."""
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(content)) as file:
            text = file.read(LONGEST + 1)
        if len(text) > LONGEST:
            raise fail(f"model.xml.gz: is longer than {LONGEST} bytes when it is decompressed")
        return text.decode("utf-8")
    except (OSError, EOFError, zlib.error, UnicodeError) as error:
        raise fail(f"model.xml.gz: cannot be read (damaged or truncated): {shown(error, 160)}") from None


def _actions(folder: Path, index: int, fail: Callable[[str], FormatError]) -> Array:
    """Actions (n, m) of an episode."""
    try:
        import pyarrow
        import pyarrow.compute as compute
        import pyarrow.parquet
    except ImportError as error:
        raise MissingDependencyError(f"LeRobot datasets are read with pyarrow: {INSTALL} ({error})") from error
    own = sorted(folder.glob(f"data/*/episode_{index:06d}.parquet"))
    shared = [] if own else sorted(folder.glob("data/*/file-*.parquet"))
    found = []
    try:
        for file in own or shared:
            with pyarrow.parquet.ParquetFile(io.BytesIO(read_bytes(file, "file of actions", limit=LARGEST))) as table:
                _check_size(table, f"'{file}'")
                # a part at a time: of many episodes one is kept
                for part in table.iter_batches(BATCH, columns=["action", "episode_index"]):
                    found += part.filter(compute.equal(part["episode_index"], index))["action"].to_pylist()
        if not found:
            raise fail("no actions: there is no parquet file of it in data/")
        return np.array(found, dtype=np.float64).reshape(len(found), -1)
    except (pyarrow.ArrowException, OSError, LookupError, ValueError, TypeError, OverflowError, MemoryError) as error:
        raise fail(f"its parquet file cannot be read: {shown(error, 160)}") from error


def _check_size(table: Any, where: str) -> None:
    """Compare what a file states of itself with what it can mean, before a column is unpacked."""
    values = size = 0
    for i in range(table.metadata.num_row_groups):
        group = table.metadata.row_group(i)
        for column in map(group.column, range(group.num_columns)):
            if column.path_in_schema.split(".")[0] in ("action", "episode_index"):
                values, size = values + column.num_values, size + column.total_uncompressed_size
    if values > MOST_VALUES or size > LARGEST:
        raise FormatError(
            f"{where}: states {values} numbers of actions in {size} bytes, more than a dataset of demonstrations has"
        )


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
    value = parse_json(read_text(file, "file of the dataset"), f"'{file}'")
    if not isinstance(value, dict):
        raise FormatError(f"'{file}' has to be a JSON object")
    return value
