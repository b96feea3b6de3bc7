"""What really happened in a demonstration, for scores only: learning is never given it.

A recorder that knows (a simulator, a person who labels) writes it beside the demonstrations, in the same HDF5 file::

    truth                   attributes: schema_version
      demo_0                attributes: moves (JSON: object, start and stop [s], resting places), relations (JSON: names)
        relations   (m, n)  0 or 1: which relation held at which sample of the demonstration

`load_demos` does not look at it, so files with and without it are read alike.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter

from symskill_pddl.demos.safe_hdf5 import Dataset, Group, opened
from symskill_pddl.errors import InputError
from symskill_pddl.reading import validated

TRUTH = "truth"
SCHEMA_VERSION = 1

Relation = tuple[str, ...]
"""Kind and objects: ``("at", "cheese", "counter")``, ``("open", "door", "cabinet")``."""


@dataclass(frozen=True)
class Move:
    """The hand took an object from one resting place to another.

    Attributes
    ----------
    obj : str
        What the hand moved.
    start_s, stop_s : float
        When it left its resting place and when it had come to the next one [s], on the demonstration's clock.
    before, after : str or None
        The objects that it rested at; None where it hung in the air.
    state_before, state_after : str
        What else tells its resting place: ``open``, ``shut`` or ``between`` for what is hinged or slides.
    """

    obj: str
    start_s: float
    stop_s: float
    before: str | None
    after: str | None
    state_before: str = ""
    state_after: str = ""


@dataclass(frozen=True, eq=False)
class Truth:
    """All moves of one demonstration in order, and each relation's value (n,) over its n samples."""

    moves: tuple[Move, ...]
    relations: Mapping[Relation, NDArray[np.bool_]] = field(default_factory=dict)


_MOVES, _RELATIONS = TypeAdapter(tuple[Move, ...]), TypeAdapter(tuple[Relation, ...])


def write_truth(file: Any, truths: Mapping[str, Truth], group: Any) -> None:
    """Add the side group to an open HDF5 file; `group` makes a group without time stamps (`hdf5`)."""
    root = group(file, TRUTH)
    root.attrs["schema_version"] = SCHEMA_VERSION
    for name in sorted(truths):
        truth, own = truths[name], group(root, name)
        order = sorted(truth.relations)
        own.attrs["moves"] = json.dumps([asdict(move) for move in truth.moves])
        own.attrs["relations"] = json.dumps([list(relation) for relation in order])
        if order:
            rows = np.stack([truth.relations[relation] for relation in order]).astype(np.uint8)
            own.create_dataset("relations", data=rows, track_times=False, chunks=rows.shape, compression="gzip", fletcher32=True)


def load_truths(path: str | Path) -> dict[str, Truth]:
    """The truth by name of demonstration; empty for a file that has none.

    Raises
    ------
    InputError
        If the file does not exist.
    FormatError
        If it is not HDF5, or its truth is damaged.
    """
    if not Path(path).is_file():
        raise InputError(f"'{path}' does not exist; 'symskill record' writes demonstrations with their truth")
    with opened(path) as file:
        root = file.get(TRUTH)
        if not isinstance(root, Group):
            return {}
        if root.attrs.get("schema_version") != SCHEMA_VERSION:
            raise root.fail(
                f"schema_version {root.attrs.get('schema_version')!r} cannot be read, this release reads version {SCHEMA_VERSION}"
            )
        return {name: _truth(root[name], str(path)) for name in root}


def _truth(group: Group | Dataset, path: str) -> Truth:
    if not isinstance(group, Group):
        raise group.fail("has to be a group")
    where = f"'{path}': {group.name}"
    moves = validated(_MOVES.validate_python, str(group.attrs.get("moves")), f"{where}: moves")
    order = validated(_RELATIONS.validate_python, str(group.attrs.get("relations")), f"{where}: relations")
    if not order:
        return Truth(moves)
    rows = group["relations"]
    if not isinstance(rows, Dataset) or rows.ndim != 2 or rows.shape[0] != len(order):
        raise rows.fail(f"has to hold a row for each of {len(order)} relations")
    return Truth(moves, dict(zip(order, np.asarray(rows.read(), dtype=bool), strict=True)))
