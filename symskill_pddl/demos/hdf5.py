"""Demonstrations on disk: HDF5, laid out as robosuite's and robomimic's users expect.

::

    data                    attributes: format, schema_version, units, quaternion_order, total, checksum
      demo_0                attributes: task, num_samples, object_order and extents (JSON), and the recorder's own (seed, ...)
        times          (n,)    s
        ee_pose        (n, 7)  m and quaternion (w, x, y, z), world frame; NaN where the hand is not seen
        aperture       (n,)    m, or NaN
        gripper_closed (n,)    0 or 1
        objects
          <name>       (n, 7)  as ee_pose, NaN where the object is not seen; attribute: type

A row of NaN is a missing pose (`Demo.seen`); an object that is never seen is left out. A moment without the hand, or without its
aperture, is left out whole: a gap in time.

Beside `data` there may be a group `truth` (`truth`): what really happened, for scores. Nothing here reads it.

The same demonstrations give the same bytes: no time stamps, fixed order, fixed library version. `checksum` covers all that is
read. Nothing is trusted on the way in: every fault becomes one `FormatError` that names the file and the path inside it.
"""

from __future__ import annotations

import hashlib
import io
import json
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from symskill_pddl.demos.demo import Demo
from symskill_pddl.demos.importing import no_hdf5
from symskill_pddl.demos.safe_hdf5 import Dataset, Group, opened
from symskill_pddl.demos.truth import Truth, write_truth
from symskill_pddl.errors import FormatError, InputError, alternatives
from symskill_pddl.files import DEMOS, Output
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.reading import parse_json

FORMAT = "symskill-demos"
SCHEMA_VERSION = 2
"""Version 2 may hold rows of NaN; version 1, which may not, is read too."""
_RESERVED = frozenset({"task", "num_samples", "object_order", "extents"})
_NOWHERE = Pose.identity().vector()
_HEADER = {"units": "m, s, rad", "quaternion_order": "wxyz"}


def natural_key(name: str) -> tuple[tuple[int, int, str], ...]:
    """Sort key under which demo_2 comes before demo_10."""
    parts = (part for part in re.split(r"([0-9]+)", name) if part)
    # a number of more digits is greater, however many they are
    return tuple((0, len(p.lstrip("0")), p.lstrip("0")) if p[0] in "0123456789" else (1, 0, p) for p in parts)


def save_demos(path: str | Path, demos: Iterable[Demo], truths: Mapping[str, Truth] | None = None) -> None:
    """Write demonstrations atomically, in place of older ones of this format; on any failure the file at `path` is as it was.

    `truths`: what really happened in those of these names, which goes beside them.

    Raises
    ------
    InputError
        If there is none, two share a name, an attribute's name is taken by the format, or the file cannot be written or holds
        something else than demonstrations.
    """
    Output(Path(path), DEMOS).write(encode_demos(demos, str(path), truths))


def encode_demos(demos: Iterable[Demo], where: str = "memory", truths: Mapping[str, Truth] | None = None) -> bytes:
    """The content of a file of demonstrations: the same demonstrations, in any order, the same bytes.

    Raises
    ------
    InputError
        As `save_demos`, which calls `where` the file's path.
    """
    demos = sorted(demos, key=lambda demo: natural_key(demo.name))
    names = [demo.name for demo in demos]
    if not demos:
        raise InputError(f"no demonstrations to save in '{where}'")
    if twice := next((n for n in names if names.count(n) > 1), None):
        raise InputError(f"two demonstrations are named '{twice}'; names within one file have to differ")
    for demo in demos:
        if taken := sorted(_RESERVED & demo.attributes.keys()):
            raise InputError(f"{demo.where}: the attribute name '{taken[0]}' belongs to the file format; call it something else")
        if any("\0" in text for text in (demo.task, *map(str, demo.attributes), *map(str, demo.attributes.values()))):
            raise InputError(f"{demo.where}: a text holds a NUL character, which HDF5 cannot store")
    lengths = {demo.name: len(demo) for demo in demos}
    for name, truth in sorted((truths or {}).items()):
        if any(values.shape != (lengths.get(name),) for values in truth.relations.values()) or name not in lengths:
            raise InputError(f"'{where}': the truth of '{name}' does not belong to a demonstration of that name and length")
    return _encode(demos, truths or {})


def load_demos(path: str | Path) -> tuple[Demo, ...]:
    """Read demonstrations, sorted by name (demo_2 before demo_10); their `source` is the file's stem.

    Raises
    ------
    InputError
        If the file does not exist.
    FormatError
        If it is not HDF5, truncated, damaged, of another format or version, or holds anything but what the layout asks for.
    """
    return _Reader(Path(path)).demos()


def is_ours(path: str | Path) -> bool:
    """Whether a file calls itself one of demonstrations."""
    try:
        with opened(path) as file:
            data = file.get("data")
            return isinstance(data, Group) and data.attrs.get("format") == FORMAT
    except InputError:
        return False


def decode_demos(content: bytes, source: str) -> tuple[Demo, ...]:
    """What `encode_demos` made; faults are named after `source`.

    Raises
    ------
    FormatError
        As `load_demos`.
    """
    return _Reader(Path(f"{source}.hdf5")).decoded(content)


# ---------------------------------------------------------------------------------------------------------------- writing


def _encode(demos: list[Demo], truths: Mapping[str, Truth]) -> bytes:
    import h5py

    buffer = io.BytesIO()
    # libver pinned: its metadata blocks carry checksums, and the bytes do not change with the installed HDF5
    with h5py.File(buffer, "w", libver=("v110", "v110")) as file:
        data = _group(file, "data")
        data.attrs["format"] = FORMAT
        data.attrs["schema_version"] = SCHEMA_VERSION
        data.attrs.update(_HEADER)
        data.attrs["total"] = sum(len(demo) for demo in demos)
        data.attrs["checksum"] = _checksum(demos)
        for demo in demos:
            _write_demo(_group(data, demo.name), demo)
        if truths:
            write_truth(file, truths, _group)
    return buffer.getvalue()


def _group(parent: Any, name: str) -> Any:
    import h5py

    # high-level create_group stamps the time of creation into the header; this does not
    properties = h5py.h5p.create(h5py.h5p.GROUP_CREATE)
    properties.set_obj_track_times(False)
    return h5py.Group(h5py.h5g.create(parent.id, name.encode(), gcpl=properties))


def _dataset(parent: Any, name: str, values: Any) -> Any:
    return parent.create_dataset(
        name,
        data=values,
        track_times=False,
        chunks=values.shape,
        compression="gzip",
        compression_opts=6,
        shuffle=True,
        fletcher32=True,
    )


def _write_demo(group: Any, demo: Demo) -> None:
    group.attrs["task"] = demo.task
    group.attrs["num_samples"] = len(demo)
    group.attrs["object_order"] = json.dumps(list(demo.objects))
    group.attrs["extents"] = json.dumps(demo.extents, sort_keys=True)
    for key in sorted(demo.attributes):
        group.attrs[key] = demo.attributes[key]
    for name, values in _arrays(demo).items():
        _dataset(group, name, values)
    objects = _group(group, "objects")
    poses = _sighted(demo)
    for i, (name, type_) in enumerate(demo.objects.items()):
        _dataset(objects, name, poses[:, i]).attrs["type"] = type_


def _arrays(demo: Demo) -> dict[str, Any]:
    return {
        "times": demo.times,
        "ee_pose": demo.T_world_ee.vector(),
        "aperture": demo.aperture,
        "gripper_closed": demo.gripper_closed.astype(np.uint8),
    }


def _sighted(demo: Demo) -> Array:
    """Poses of the objects (n, n_obj, 7), NaN where they are not seen."""
    return np.where(demo.seen[..., None], demo.T_world_objects.vector(), np.nan)


def _checksum(demos: Iterable[Demo]) -> str:
    """SHA-256 over everything that is read back, in reading order."""
    digest = hashlib.sha256()
    for demo in demos:
        plain = [demo.name, demo.task, list(demo.objects.items()), sorted(demo.extents.items()), sorted(demo.attributes.items())]
        digest.update(json.dumps(plain).encode())
        for values in (*_arrays(demo).values(), _sighted(demo)):
            digest.update(np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<")).tobytes())
    return f"sha256:{digest.hexdigest()}"


# ---------------------------------------------------------------------------------------------------------------- reading


class _Reader:
    """Reads one file; knows its name and says it in every message."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def fail(self, inside: str, message: str) -> FormatError:
        return FormatError(f"'{self.path}': {inside}: {message}")

    def demos(self) -> tuple[Demo, ...]:
        if not self.path.is_file():
            what = "is a folder, not a demonstrations file" if self.path.is_dir() else "does not exist"
            raise InputError(f"'{self.path}' {what}; 'symskill record' and 'symskill import' write one")
        if (foreign := no_hdf5(self.path)) is not None:
            raise foreign
        with opened(self.path) as file:
            return self._demos(file)

    def decoded(self, content: bytes) -> tuple[Demo, ...]:
        with opened(content, self.path) as file:
            return self._demos(file)

    def _demos(self, file: Group) -> tuple[Demo, ...]:
        data = file.get("data")
        if not isinstance(data, Group):
            raise self.fail("data", f"there is no such group; the file has: {alternatives(map(str, file))}")
        self._check_header(data)
        names = sorted(map(str, data), key=natural_key)
        if not names:
            raise self.fail("data", "holds no demonstration; expected data/demo_0, ...")
        demos = tuple(self._demo(data, name) for name in names)
        stated = data.attrs.get("checksum")
        if stated is not None and stated != _checksum(demos):
            raise self.fail("data", "the checksum does not match the content: the file was damaged or edited")
        return demos

    def _check_header(self, data: Group) -> None:
        found = data.attrs.get("format")
        if found != FORMAT:
            if found is None and any(key in data.attrs for key in ("env", "env_args", "env_name", "problem_info")):
                raise self.fail("data", "this is a simulator's recording; convert it with 'symskill import'")
            raise self.fail("data", f"attribute 'format' has to be '{FORMAT}', found {found!r}")
        version = data.attrs.get("schema_version")
        if version not in range(1, SCHEMA_VERSION + 1):
            known = f"versions 1 to {SCHEMA_VERSION}"
            raise self.fail("data", f"schema_version {version!r} cannot be read, this release reads {known}")
        for key, wanted in _HEADER.items():
            if data.attrs.get(key) != wanted:
                raise self.fail("data", f"attribute '{key}' has to be '{wanted}', found {data.attrs.get(key)!r}")

    def _demo(self, data: Group, name: str) -> Demo:
        inside, group = f"data/{name}", data[name]
        if not isinstance(group, Group):
            raise self.fail(inside, "has to be a group")
        times = self._values(group, inside, "times", ())
        n = len(times)
        ee = self._poses(group, inside, "ee_pose", n)
        aperture = self._values(group, inside, "aperture", (), n, gaps=True)
        closed = self._values(group, inside, "gripper_closed", (), n)
        if not np.all((closed == 0) | (closed == 1)):
            raise self.fail(f"{inside}/gripper_closed", "has to hold 0 (open) and 1 (closed) only")
        objects = group.get("objects")
        if not isinstance(objects, Group):
            raise self.fail(f"{inside}/objects", "there is no such group")
        order = self._json(
            group, inside, "object_order", lambda v: isinstance(v, list) and all(isinstance(o, str) for o in v), "a list of names"
        )
        if sorted(order) != sorted(map(str, objects)):
            raise self.fail(
                f"{inside}/objects",
                f"object_order names {alternatives(order)}, the group holds {alternatives(map(str, objects))}",
            )
        extents = self._json(group, inside, "extents", _is_extents, "half sizes [x, y, z] per type")
        poses = np.stack([np.zeros((n, 7)), *(self._poses(objects, f"{inside}/objects", o, n) for o in order)], axis=1)[:, 1:]
        types = {o: self._text(objects[o], f"{inside}/objects/{o}", "type") for o in order}
        # a moment without the hand shows nothing that can be learned: it is a gap in time
        hand = ~np.isnan(ee[:, 0]) & ~np.isnan(aperture)
        if n >= 2 and hand.sum() < 2:
            raise self.fail(inside, f"the hand's pose or its aperture is missing (NaN) in {n - hand.sum()} of {n} samples")
        seen = ~np.isnan(poses[hand, :, 0])
        shown = seen.any(axis=0)
        there = [types[o] for o, ever in zip(order, shown, strict=True) if ever]
        try:
            return Demo(
                name=name,
                source=self.path.stem,
                task=self._text(group, inside, "task"),
                times=times[hand],
                T_world_ee=Pose.from_vector(ee[hand]),
                aperture=aperture[hand],
                gripper_closed=closed[hand].astype(bool),
                objects={o: types[o] for o, ever in zip(order, shown, strict=True) if ever},
                T_world_objects=Pose.from_vector(np.where(seen[..., None], poses[hand], _NOWHERE)[:, shown]),
                extents={t: (h[0], h[1], h[2]) for t, h in extents.items() if t in there or t not in types.values()},
                attributes={k: group.attrs[k] for k in group.attrs if k not in _RESERVED},
                seen=seen[:, shown],
            )
        except FormatError:
            raise
        except InputError as error:
            raise self.fail(inside, str(error).removeprefix(f"{self.path.stem}:{name}: ")) from None

    def _values(
        self, group: Group, inside: str, name: str, row: tuple[int, ...], n: int | None = None, *, gaps: bool = False
    ) -> Array:
        """A numeric dataset (n, *row) as float64, finite, or with NaN where there are gaps."""
        inside = f"{inside}/{name}"
        dataset = group.get(name)
        if not isinstance(dataset, Dataset):
            raise self.fail(inside, "there is no such dataset")
        wanted = f"({'n' if n is None else n}{''.join(f', {r}' for r in row) or ','})"
        if dataset.ndim != 1 + len(row) or dataset.shape[1:] != row or n not in (None, dataset.shape[0]):
            raise self.fail(inside, f"has shape {dataset.shape}, expected {wanted}")
        values = np.asarray(dataset.read(), dtype=np.float64)
        bad = np.argwhere(np.isinf(values) if gaps else ~np.isfinite(values))
        if bad.size:
            raise self.fail(inside, f"holds a number that is not finite, at index {', '.join(map(str, bad[0]))}")
        return values

    def _poses(self, group: Group, inside: str, name: str, n: int) -> Array:
        """Poses (n, 7): position and quaternion; all of a row is NaN where any of it is."""
        values = self._values(group, inside, name, (7,), n, gaps=True)
        values[np.isnan(values).any(axis=1)] = np.nan
        off = np.nan_to_num(np.abs(np.linalg.norm(values[:, 3:], axis=1) - 1.0))
        if n and off.max() > 1e-3:
            raise self.fail(
                f"{inside}/{name}", f"row {int(off.argmax())}: columns 3 to 6 have to be a unit quaternion (w, x, y, z)"
            )
        return values

    def _text(self, holder: Group | Dataset, inside: str, key: str) -> str:
        value = holder.attrs.get(key)
        if not isinstance(value, str):
            raise self.fail(inside, f"attribute '{key}' has to be a text, found {value!r}")
        return value

    def _json(self, group: Group, inside: str, key: str, valid: Callable[[Any], bool], wanted: str) -> Any:
        try:
            value = parse_json(self._text(group, inside, key), inside)
        except FormatError:
            value = None
        if not valid(value):
            raise self.fail(inside, f"attribute '{key}' has to be JSON: {wanted}")
        return value


def _is_extents(value: Any) -> bool:
    return isinstance(value, dict) and all(
        isinstance(half, list) and len(half) == 3 and all(isinstance(h, int | float) for h in half) for half in value.values()
    )
