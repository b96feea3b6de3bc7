"""`Demo`: one recording, a sequence of scenes over a fixed set of objects, unlabelled and unsegmented."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.geometry import Array, Pose, frozen
from symskill_pddl.scene import GRIPPER, Scene

BoolArray = NDArray[np.bool_]

# Names become HDF5 links and, later, PDDL names: no slash, no white space, no control character, and not the link ".".
_NAME = re.compile(r"(?!\.{1,2}$)[^/\s\x00-\x1f]+")


@dataclass(frozen=True, eq=False)
class Demo:
    """One demonstration, recorded at a fixed rate (20 Hz by convention); arrays are read-only copies.

    Attributes
    ----------
    name : str
        Name within its file, ``demo_0``.
    source : str
        Stem of the file it came from; `source` and `name` together identify a demonstration.
    task : str
        What was shown, ``StoreCheese``; learning groups goals by it.
    times : ndarray (n,)
        Seconds, strictly increasing, n >= 2.
    T_world_ee : Pose (n,)
        End-effector frame: between the finger tips, z along the approach direction, y along the finger opening.
    aperture : ndarray (n,)
        Opening between the finger pads [m], not negative.
    gripper_closed : ndarray of bool (n,)
        What the fingers are commanded to do.
    objects : dict of str to str
        Type of each object, in a fixed order.
    T_world_objects : Pose (n, n_obj)
        Poses of the objects, in that order. Where an object is not seen this is its last seen pose, before the first sight the
        first one, whatever was given there.
    seen : ndarray of bool (n, n_obj)
        Whether the pose is a measurement; all are, if nothing else is said. Every object is seen at least once.
    extents : dict of str to (float, float, float)
        Half sizes [m] of the bounding box per type, in the object's axes; types may be missing.
    attributes : dict of str to str, int or float
        Anything else worth keeping: seed, environment, date.

    Raises
    ------
    InputError
        If lengths disagree, a number is not finite, the times do not increase, there are fewer than two samples, an object is
        never seen, or a name cannot be used.
    """

    name: str
    source: str
    task: str
    times: Array
    T_world_ee: Pose
    aperture: Array
    gripper_closed: BoolArray
    objects: dict[str, str]
    T_world_objects: Pose
    extents: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    attributes: dict[str, str | int | float] = field(default_factory=dict)
    seen: BoolArray = field(default_factory=lambda: np.array(True))

    @classmethod
    def from_scenes(
        cls,
        scenes: Sequence[Scene],
        *,
        name: str,
        task: str,
        source: str = "recording",
        extents: Mapping[str, tuple[float, float, float]] | None = None,
        attributes: Mapping[str, str | int | float] | None = None,
    ) -> Demo:
        """What a world showed while somebody drove it: the scenes that its `observe` and `step` returned, in order.

        Objects may come and go: one that a scene does not hold is not seen in it.

        Raises
        ------
        InputError
            As above; fewer than two scenes, or an object whose type changes.
        """
        where = f"{source}:{name}"
        if len(scenes) < 2:
            raise InputError(f"{where}: a demonstration needs at least 2 scenes, got {len(scenes)}")
        objects, T_world_objects, seen = _sighted(scenes, where)
        return cls(
            name=name,
            source=source,
            task=task,
            times=np.array([s.time for s in scenes]),
            T_world_ee=Pose.stack([s.T_world_ee for s in scenes]),
            aperture=np.array([s.aperture for s in scenes]),
            gripper_closed=np.array([s.gripper_closed for s in scenes], bool),
            objects=objects,
            T_world_objects=T_world_objects,
            extents=dict(extents or {}),
            attributes=dict(attributes or {}),
            seen=seen,
        )

    def __post_init__(self) -> None:
        for name in ("times", "aperture"):
            object.__setattr__(self, name, frozen(getattr(self, name)))
        closed = np.array(self.gripper_closed)
        if closed.dtype != np.bool_:
            raise InputError(f"{self.where}: gripper_closed has to be boolean, got {closed.dtype}")
        closed.setflags(write=False)
        object.__setattr__(self, "gripper_closed", closed)
        object.__setattr__(self, "objects", dict(self.objects))
        object.__setattr__(self, "extents", {t: (float(a), float(b), float(c)) for t, (a, b, c) in self.extents.items()})
        object.__setattr__(self, "attributes", dict(self.attributes))
        self._check_names()
        self._check_arrays()
        self._hold_unseen()

    def _check_names(self) -> None:
        for what, text in (
            ("name", self.name),
            *(("object name", o) for o in self.objects),
            *(("type", t) for t in self.objects.values()),
        ):
            if not _NAME.fullmatch(text):
                raise InputError(f"{self.where}: {what} {text!r} is empty or holds a slash or white space")
        if GRIPPER in self.objects:
            raise InputError(f"{self.where}: '{GRIPPER}' is the end effector's name, an object must have another one")
        for type_, half in self.extents.items():
            if type_ not in self.objects.values():
                raise InputError(
                    f"{self.where}: extents of the unknown type '{type_}'; types here: {alternatives(self.objects.values())}"
                )
            if not all(np.isfinite(h) and h > 0 for h in half):
                raise InputError(f"{self.where}: extents of '{type_}' have to be three positive half sizes in metres, got {half}")
        for key, value in self.attributes.items():
            if type(value) not in (str, int, float):
                raise InputError(f"{self.where}: attribute '{key}' has to be a text or a number, got {type(value).__name__}")

    def _check_arrays(self) -> None:
        n = len(self.times) if self.times.ndim == 1 else 0
        if n < 2:
            raise InputError(f"{self.where}: a demonstration needs times (n,) with at least 2 samples, got {self.times.shape}")
        for name, shape, wanted in (
            ("aperture", self.aperture.shape, (n,)),
            ("gripper_closed", self.gripper_closed.shape, (n,)),
            ("T_world_ee", self.T_world_ee.shape, (n,)),
            ("T_world_objects", self.T_world_objects.shape, (n, len(self.objects))),
        ):
            if shape != wanted:
                raise InputError(
                    f"{self.where}: {name} has shape {shape}, {n} times and {len(self.objects)} objects need {wanted}"
                )
        for name in ("times", "aperture"):
            bad = np.flatnonzero(~np.isfinite(getattr(self, name)))
            if bad.size:
                raise InputError(f"{self.where}: {name}[{bad[0]}] is not a finite number")
        back = np.flatnonzero(np.diff(self.times) <= 0)
        if back.size:
            i = int(back[0]) + 1
            raise InputError(
                f"{self.where}: times have to increase, times[{i}] = {self.times[i]:g} s follows {self.times[i - 1]:g} s"
            )
        if np.any(self.aperture < -1e-3):  # encoders of a closed hand read a little below zero
            raise InputError(f"{self.where}: an aperture is negative ({self.aperture.min():g} m)")

    def _hold_unseen(self) -> None:
        """Give every sample without a measurement the last pose that was one."""
        shape = (len(self.times), len(self.objects))
        seen = np.array(self.seen)
        if seen.dtype != np.bool_ or seen.shape not in ((), shape):
            raise InputError(f"{self.where}: seen has to be boolean {shape}, got {seen.dtype} {seen.shape}")
        seen = np.array(np.broadcast_to(seen, shape))
        seen.setflags(write=False)
        object.__setattr__(self, "seen", seen)
        if seen.all():
            return
        never = [obj for obj, ever in zip(self.objects, seen.any(axis=0), strict=True) if not ever]
        if never:
            raise InputError(f"{self.where}: '{never[0]}' is never seen; leave it out of this demonstration")
        last = np.maximum.accumulate(np.where(seen, np.arange(len(seen))[:, None], -1), axis=0)
        last = np.where(last < 0, seen.argmax(axis=0), last)
        object.__setattr__(self, "T_world_objects", self.T_world_objects[last, np.arange(len(self.objects))])

    @property
    def where(self) -> str:
        """Identifier for messages and evidence, ``file:demo_0``."""
        return f"{self.source}:{self.name}"

    @property
    def duration_s(self) -> float:
        """Seconds from the first to the last sample."""
        return float(self.times[-1] - self.times[0])

    def __len__(self) -> int:
        return len(self.times)

    def scene(self, i: int) -> Scene:
        """The moment `i`; negative indices count from the end."""
        return Scene(
            time=float(self.times[i]),
            T_world_ee=self.T_world_ee[i],
            aperture=float(self.aperture[i]),
            gripper_closed=bool(self.gripper_closed[i]),
            objects=self.objects,
            T_world_objects=self.T_world_objects[i],
            unseen=frozenset(obj for obj, there in zip(self.objects, self.seen[i], strict=True) if not there),
        )

    def pose(self, frame: str) -> Pose:
        """`T_world_frame` (n,) of an object, or of the end effector under the name 'gripper'."""
        return self.T_world_ee if frame == GRIPPER else self.T_world_objects[:, self._column(frame)]

    def sees(self, frame: str) -> BoolArray:
        """Whether the pose (n,) of an object is a measurement; that of the end effector, 'gripper', always is."""
        return np.ones(len(self), bool) if frame == GRIPPER else self.seen[:, self._column(frame)]

    def _column(self, obj: str) -> int:
        try:
            return list(self.objects).index(obj)
        except ValueError:
            raise InputError(
                f"{self.where}: unknown object '{obj}'; the demonstration has: {alternatives(self.objects)}"
            ) from None


def _sighted(scenes: Sequence[Scene], where: str) -> tuple[dict[str, str], Pose, BoolArray]:
    """The objects that any of n scenes shows, in order of appearance, their poses (n, n_obj), and where they are seen."""
    types: dict[str, str] = {}
    for i, scene in enumerate(scenes):
        for obj, type_ in scene.objects.items():
            if types.setdefault(obj, type_) != type_:
                raise InputError(f"{where}: '{obj}' is of type '{type_}' in scene {i}, of type '{types[obj]}' before")
    shown = {obj for scene in scenes for obj in scene.objects.keys() - scene.unseen}
    objects = {obj: type_ for obj, type_ in types.items() if obj in shown}
    column = {obj: k for k, obj in enumerate(objects)}
    poses, seen = np.tile(Pose.identity().vector(), (len(scenes), len(objects), 1)), np.zeros((len(scenes), len(objects)), bool)
    for i, scene in enumerate(scenes):
        rows = [(row, column[obj]) for row, obj in enumerate(scene.objects) if obj in shown and obj not in scene.unseen]
        here, there = [row for row, _ in rows], [k for _, k in rows]
        poses[i, there] = scene.T_world_objects[here].vector()
        seen[i, there] = True
    return objects, Pose.from_vector(poses), seen


def merged_extents(demos: tuple[Demo, ...]) -> Mapping[str, tuple[float, float, float]]:
    """The largest half sizes stated for each type over all demonstrations, types sorted."""
    merged: dict[str, tuple[float, float, float]] = {}
    for demo in demos:
        for type_, half in demo.extents.items():
            a, b, c = (max(x, y) for x, y in zip(half, merged.get(type_, half), strict=True))
            merged[type_] = (a, b, c)
    return dict(sorted(merged.items()))


def extent_conflicts(demos: Sequence[Demo]) -> tuple[str, ...]:
    """A line for every type whose size differs from file to file by more than a millimetre: the largest counts for all."""
    sizes: dict[str, dict[tuple[float, float, float], str]] = {}
    for demo in demos:
        for type_, half in demo.extents.items():
            rounded = (round(half[0], 3), round(half[1], 3), round(half[2], 3))
            sizes.setdefault(type_, {}).setdefault(rounded, demo.source)
    lines = []
    for type_, by_size in sorted(sizes.items()):
        if len(set(by_size.values())) > 1:
            told = ", ".join(
                f"{' x '.join(f'{200 * h:.1f}' for h in half)} cm in '{source}'" for half, source in sorted(by_size.items())
            )
            lines.append(f"type '{type_}' has more than one size: {told}; the largest counts, give what differs types of its own")
    return tuple(lines)
