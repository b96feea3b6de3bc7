"""What geometry cannot know, said by a person: hints, all optional, checked against the recordings.

A file of hints is TOML:

    up = "z"                          # the world's axis that points up: x, y, z, -x, -y or -z
    fingers = "as-recorded"           # or "inverted": the command that is recorded as closed means open
    [types]                           # type of an object
    cube_1 = "cube"
    [joints]                          # how things of a type move: free, revolute or prismatic
    block = "free"
    [symmetry]                        # axis about which a type looks the same however it is turned
    can = "z"
    [closed]                          # a moment at which things of a type are closed: recording@seconds
    door = "demos:demo_0@0.0"
    [references]                      # type of what things of a type rest at
    milk = "box"
    [leave_out]
    objects = ["lamp_2"]
    spans = ["demos:demo_3@4.0-6.5"]  # seconds of a recording
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from symskill_pddl.demos import Demo
from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.geometry import Pose, quat_multiply

AXES = {sign + axis: float(f"{sign}1") * np.eye(3)[i] for i, axis in enumerate("xyz") for sign in ("", "-")}
JOINTS = ("free", "revolute", "prismatic")
FINGERS = ("as-recorded", "inverted")
_SPAN = re.compile(r"(.+)@([0-9.]+)-([0-9.]+)")
_MOMENT = re.compile(r"(.+)@([0-9.]+)s?")


@dataclass(frozen=True)
class Hints:
    """See this module's text. Tables are sorted pairs, so that hints can be compared and kept.

    Raises
    ------
    InputError
        If a value is none of those that a hint may have.
    """

    up: str = "z"
    fingers: str = "as-recorded"
    types: Mapping[str, str] = field(default_factory=dict)
    joints: Mapping[str, str] = field(default_factory=dict)
    symmetry: Mapping[str, str] = field(default_factory=dict)
    closed: Mapping[str, str] = field(default_factory=dict)
    references: Mapping[str, str] = field(default_factory=dict)
    objects: tuple[str, ...] = ()
    spans: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for what, value, known in (
            ("up", self.up, tuple(AXES)),
            ("fingers", self.fingers, FINGERS),
            *((f"joints.{t}", joint, JOINTS) for t, joint in self.joints.items()),
            *((f"symmetry.{t}", axis, ("x", "y", "z")) for t, axis in self.symmetry.items()),
        ):
            if value not in known:
                raise InputError(f"hint {what}: '{value}' is none of {alternatives(known)}")
        for t, moment in self.closed.items():
            if not _MOMENT.fullmatch(moment):
                raise InputError(f"hint closed.{t}: '{moment}' is no moment such as demos:demo_0@1.5")
        for span in self.spans:
            if not _SPAN.fullmatch(span):
                raise InputError(f"hint leave_out.spans: '{span}' is no span such as demos:demo_0@1.5-3.0")

    @classmethod
    def of(cls, document: Mapping[str, Any], source: str = "hints") -> Hints:
        """From TOML's tables.

        Raises
        ------
        InputError
            If there is no such hint, or a value has the wrong type.
        """
        if not isinstance(document, Mapping) or not isinstance(document.get("leave_out", {}), Mapping):
            raise InputError(f"{source}: hints, and 'leave_out' among them, have to be a table")
        flat = {k: v for k, v in document.items() if k != "leave_out"}
        left = document.get("leave_out", {})
        names = {f.name for f in fields(cls)} - {"objects", "spans"}
        unknown = [*sorted(flat.keys() - names), *(f"leave_out.{k}" for k in sorted(set(left) - {"objects", "spans"}))]
        if unknown:
            raise InputError(f"{source}: there is no hint '{unknown[0]}'; there are: {alternatives(names | {'leave_out'})}")
        for name, value in flat.items():
            table = name not in ("up", "fingers")
            texts = value.values() if table and isinstance(value, dict) else [value]
            if table != isinstance(value, dict) or not all(isinstance(text, str) for text in texts):
                raise InputError(f"{source}: hint '{name}' has to be {'a table of texts' if table else 'a text'}, got {value!r}")
        for name, value in left.items():
            if not isinstance(value, list) or not all(isinstance(text, str) for text in value):
                raise InputError(f"{source}: hint 'leave_out.{name}' has to be a list of texts, got {value!r}")
        return cls(**flat, objects=tuple(left.get("objects", ())), spans=tuple(left.get("spans", ())))

    def document(self) -> dict[str, Any]:
        """What `of` reads, without what is as if nothing had been said."""
        plain = {f.name: getattr(self, f.name) for f in fields(self) if getattr(self, f.name) not in ((), {}, "z", "as-recorded")}
        left = {name: list(plain.pop(name)) for name in ("objects", "spans") if name in plain}
        tables = {name: dict(sorted(v.items())) if isinstance(v, Mapping) else v for name, v in plain.items()}
        return {**tables, **({"leave_out": left} if left else {})}


def hinted(demos: Sequence[Demo], hints: Hints) -> tuple[Demo, ...]:
    """The demonstrations as the hints say they are to be read.

    Raises
    ------
    InputError
        If a hint names what no demonstration has, or the recordings contradict it; the message says how.
    """
    _check_names(demos, hints)
    result = []
    for demo in demos:
        demo = _without(demo, hints)
        if hints.fingers == "inverted":
            demo = replace(demo, gripper_closed=~demo.gripper_closed)
        if hints.up != "z":
            demo = _upright(demo, AXES[hints.up])
        result.append(_typed(demo, hints.types))
    _check_fingers(result, hints)
    _check_symmetry(result, hints)
    return tuple(result)


def _check_names(demos: Sequence[Demo], hints: Hints) -> None:
    objects = {o for d in demos for o in d.objects}
    types = {hints.types.get(o, t) for d in demos for o, t in d.objects.items()}
    wheres = {d.where for d in demos}
    for what, name, known in (
        *((f"types.{o}", o, objects) for o in hints.types),
        *(("leave_out.objects", o, objects) for o in hints.objects),
        *((f"{table}.{t}", t, types) for table in ("joints", "symmetry", "closed", "references") for t in getattr(hints, table)),
        *((f"references.{t}", ref, types) for t, ref in hints.references.items()),
        *(("leave_out.spans", _match(_SPAN, span)[1], wheres) for span in hints.spans),
        *((f"closed.{t}", _match(_MOMENT, moment)[1], wheres) for t, moment in hints.closed.items()),
    ):
        if name not in known:
            raise InputError(f"hint {what}: no demonstration has '{name}'; there are: {alternatives(known)}")


def _match(pattern: re.Pattern[str], text: str) -> re.Match[str]:
    found = pattern.fullmatch(text)
    assert found is not None  # `Hints` has checked it
    return found


def moment(text: str) -> tuple[str, float]:
    """Recording and time [s] of ``demos:demo_0@1.5``."""
    where, time = _match(_MOMENT, text).groups()
    return where, float(time)


def _without(demo: Demo, hints: Hints) -> Demo:
    """Left-out objects and times taken away; a time that is left out is a gap."""
    kept = np.ones(len(demo), dtype=bool)
    for span in hints.spans:
        where, start, stop = _match(_SPAN, span).groups()
        if where == demo.where:
            kept &= (demo.times < float(start)) | (demo.times > float(stop))
    if kept.sum() < 2:
        raise InputError(f"hint leave_out.spans: nothing is left of {demo.where}, which lasts {demo.duration_s:.1f} s")
    columns = [i for i, o in enumerate(demo.objects) if o not in hints.objects]
    if kept.all() and len(columns) == len(demo.objects):
        return demo
    objects = {o: t for o, t in demo.objects.items() if o not in hints.objects}
    return replace(
        demo,
        times=demo.times[kept],
        T_world_ee=demo.T_world_ee[kept],
        aperture=demo.aperture[kept],
        gripper_closed=demo.gripper_closed[kept],
        objects=objects,
        T_world_objects=demo.T_world_objects[kept][:, columns],
        extents={t: half for t, half in demo.extents.items() if t in objects.values()},
        seen=demo.seen[kept][:, columns],
    )


def _upright(demo: Demo, up: np.ndarray[Any, Any]) -> Demo:
    """In a world whose z axis points up."""
    z = np.array([0.0, 0.0, 1.0])
    axis, cosine = np.cross(up, z), float(up @ z)
    turn = np.array([0.0, 1.0, 0.0, 0.0]) if cosine < -0.5 else np.concatenate([[1.0 + cosine], axis])
    T = Pose(np.zeros(3), turn / np.linalg.norm(turn))

    def turned(poses: Pose) -> Pose:
        return Pose(T.rotate(poses.p), quat_multiply(T.q, poses.q))

    return replace(demo, T_world_ee=turned(demo.T_world_ee), T_world_objects=turned(demo.T_world_objects))


def _typed(demo: Demo, types: Mapping[str, str]) -> Demo:
    if not types.keys() & demo.objects.keys():
        return demo
    objects = {o: types.get(o, t) for o, t in demo.objects.items()}
    extents: dict[str, tuple[float, float, float]] = {}
    for o, old in demo.objects.items():
        half = demo.extents.get(old)
        if half is None:
            continue
        known = extents.setdefault(objects[o], half)
        if not np.allclose(known, half, rtol=0.25, atol=0.01):
            sizes = " and ".join(" x ".join(f"{200 * h:.1f}" for h in size) for size in (known, half))
            raise InputError(f"hint types.{o}: {demo.where} has objects of the sizes {sizes} cm, too different for one type")
    return replace(demo, objects=objects, extents=extents)


def _check_fingers(demos: Sequence[Demo], hints: Hints) -> None:
    """Fingers that are told to close are nearer to each other in the end than fingers that are told to open."""
    if hints.fingers != "inverted":
        return
    closed = np.concatenate([d.aperture[d.gripper_closed] for d in demos])
    opened = np.concatenate([d.aperture[~d.gripper_closed] for d in demos])
    if len(closed) and len(opened) and np.median(closed) > np.median(opened):
        raise InputError(
            f"hint fingers: inverted, the fingers are {100 * np.median(closed):.1f} cm apart when told to close and "
            f"{100 * np.median(opened):.1f} cm when told to open; as recorded they agree"
        )


def _check_symmetry(demos: Sequence[Demo], hints: Hints) -> None:
    """What looks the same however it is turned about an axis is as deep as it is wide."""
    for type_, axis in hints.symmetry.items():
        across = [i for i in range(3) if "xyz"[i] != axis]
        for demo in demos:
            half = demo.extents.get(type_)
            if half is not None and not np.isclose(half[across[0]], half[across[1]], rtol=0.1):
                sizes = " by ".join(f"{200 * half[i]:.1f}" for i in across)
                raise InputError(f"hint symmetry.{type_}: in {demo.where} it measures {sizes} cm across its {axis} axis")
