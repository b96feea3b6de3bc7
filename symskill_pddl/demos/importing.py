"""What every importer is asked: which episodes, what they are called, how their gripper is read; and what is left out."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from symskill_pddl.errors import FormatError, InputError, UnsafeError, alternatives

T = TypeVar("T")
Remark = Callable[[str], object]
"""Is told, in one line, what was left out or decided."""

HOW = "poses of one's own become demonstrations with Demo.from_scenes and save_demos, a few lines of Python: docs/recordings.md"

_KINDS = (
    (b"\x93NUMPY", "a NumPy array"),
    (b"PK\x03\x04", "a zip archive (.npz, .zip)"),
    (b"PAR1", "a Parquet file; of a LeRobot dataset, name the folder"),
    (b"\x1f\x8b", "compressed with gzip"),
    (b"#ROSBAG", "a ROS bag"),
    (b"\x89MCAP", "an MCAP log"),
    (b"SQLite format 3", "an SQLite file, as ROS 2 bags are"),
    (b"\x80\x04", "a Python pickle"),
)


@dataclass(frozen=True)
class ImportConfig:
    """What to import, and what the file does not say.

    Attributes
    ----------
    types : mapping of str to str
        Type for objects by name, ``{"cubeA": "cube", "cubeB": "cube"}``. Others get their name without trailing digits.
    task : str
        What was shown; if empty, what the recording says: its language instruction, else its environment's name.
    names : tuple of str
        Only these episodes, ``demo_3``; if empty, all.
    filter_key : str
        Only the episodes of this list of the file (robomimic: ``mask/<key>``).
    count : int or None
        Only the first ones, of those chosen.
    gripper_column : int or None
        Column of the actions that tells the gripper, in place of the layout's.
    gripper_open : float or None
        Its value that opens, in place of the layout's.
    rate_hz : float or None
        Rate of the recording, where it does not say it.
    """

    types: Mapping[str, str] = field(default_factory=dict)
    task: str = ""
    names: tuple[str, ...] = ()
    filter_key: str = ""
    count: int | None = None
    gripper_column: int | None = None
    gripper_open: float | None = None
    rate_hz: float | None = None

    def __post_init__(self) -> None:
        if self.count is not None and self.count < 1:
            raise InputError(f"at least 1 episode has to be imported, got {self.count}")
        if self.rate_hz is not None and not 0 < self.rate_hz < 1e5:
            raise InputError(f"the rate has to be a positive number of hertz, got {self.rate_hz:g}")

    def chosen(self, names: Sequence[str], lists: Mapping[str, Sequence[str]], where: str) -> tuple[str, ...]:
        """Of the episodes of a file, in order, those that are wanted; `lists` are its filter keys.

        Raises
        ------
        InputError
            If a name or the key is unknown, or nothing is left.
        """
        if self.filter_key and self.filter_key not in lists:
            raise InputError(f"{where}: there is no filter key '{self.filter_key}'; it has: {alternatives(lists)}")
        if unknown := [n for n in self.names if n not in names]:
            raise InputError(f"{where}: there is no episode '{unknown[0]}'; it has: {alternatives(names)}")
        listed = lists[self.filter_key] if self.filter_key else names
        left = [n for n in names if n in listed and (not self.names or n in self.names)]
        if not left:
            raise InputError(f"{where}: no episode is both in filter key '{self.filter_key}' and chosen by name")
        return tuple(left[: self.count])


def each(names: Iterable[str], make: Callable[[str], T], where: str, remark: Remark) -> tuple[T, ...]:
    """Apply `make` to each episode; what cannot be used is left out with its reason.

    Raises
    ------
    InputError, FormatError
        The first reason, if no episode is left.
    UnsafeError
        At once: of a file that reaches for other files nothing is used.
    """
    made, bad = [], list[tuple[str, InputError]]()
    for name in names:
        try:
            made.append(make(name))
        except UnsafeError:
            raise
        except InputError as error:
            bad.append((name, error))
    if not made and bad:
        raise bad[0][1]
    for name, reason in bad:
        remark(f"{where}: '{name}' is left out: {str(reason).removeprefix(where).removeprefix(f': data/{name}').lstrip(': ')}")
    return tuple(made)


def task_name(text: str) -> str:
    """An instruction as a name: ``put the bowl on the plate`` is ``put_the_bowl_on_the_plate``."""
    return re.sub(r"[^\w-]+", "_", text.strip()).strip("_")


def no_hdf5(path: Path) -> FormatError | None:
    """What to say of a file that does not begin as HDF5 does; None for one that does."""
    try:
        with path.open("rb") as file:
            head = file.read(512)
    except OSError:
        return None
    if head.startswith(b"\x89HDF\r\n\x1a\n"):
        return None
    kind = next((kind for magic, kind in _KINDS if head.startswith(magic)), "")
    if not kind and len(head) > 3 and not re.search("[\x00-\x08\x0e-\x1f\ufffd]", head[:500].decode("utf-8", "replace")[:-1]):
        kind = "a text file"
    if not kind and path.suffix.lower() in (".hdf5", ".h5", ".hdf"):
        return FormatError(f"'{path}' is not a readable HDF5 file (damaged or truncated): it does not begin as one")
    return FormatError(f"'{path}' is no HDF5 file but {kind or 'of an unknown kind'}; {HOW}")


def warn(text: str) -> None:
    """A remark for who calls from Python."""
    warnings.warn(text, stacklevel=3)
