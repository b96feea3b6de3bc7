"""What is in a recording, before anything is learned from it: its clock, its hand, and how each object is seen and moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symskill_pddl.demos.demo import BoolArray, Demo
from symskill_pddl.demos.gripper import following
from symskill_pddl.demos.noise import freezes, jitter
from symskill_pddl.geometry import Pose, rotation_distance

Span = tuple[float, float]
"""Seconds since the recording's beginning, from and to."""

_GAP = 3.0
"""Steps of the clock longer than this many usual ones are gaps."""
_WINDOW_S = 0.25
"""What moves is compared with itself so long before."""
_MEAN_S = 0.2
"""Poses are averaged over this much before they are compared."""
_SIGMAS = 8.0
_LEAST_M, _LEAST_RAD = 0.003, 0.025
"""What shifts and turns less than this, or than eight times the jitter of the averages, rests."""
_PAUSE_S = 0.5
"""Shorter rests within a motion are none."""
_JUMP_M = 0.05
"""A pose that is this far off for one sample is the tracker's mistake."""


@dataclass(frozen=True)
class Clock:
    """Number of samples, seconds from first to last, samples per second (median), and the gaps."""

    samples: int
    duration_s: float
    rate_hz: float
    gaps: tuple[Span, ...]


@dataclass(frozen=True)
class Grip:
    """Narrowest and widest opening [m], the share of samples at which the command is to close, and how often it changes.

    `follows`: how far the fingers do as they are told, from -1 to 1, None if they hardly move; whether the gripper is told to be
    closed at first and at last.
    """

    narrowest_m: float
    widest_m: float
    closed: float
    switches: int
    follows: float | None
    at_first: bool
    at_last: bool


@dataclass(frozen=True)
class Track:
    """How one object is seen, and when it moves.

    `seen` is a share of the samples; `unseen` and `frozen` are spans without a measurement, the latter without a word of the
    tracker; `jumps` counts samples that are far off; jitter is per axis.
    """

    name: str
    type: str
    seen: float
    unseen: tuple[Span, ...]
    frozen: tuple[Span, ...]
    jitter_m: float
    jitter_rad: float
    jumps: int
    moves: tuple[Span, ...]


@dataclass(frozen=True)
class Inspection:
    """One recording."""

    where: str
    task: str
    clock: Clock
    grip: Grip
    tracks: tuple[Track, ...]


def inspect_demo(demo: Demo) -> Inspection:
    """Look at one recording."""
    closed = demo.gripper_closed
    grip = Grip(
        float(demo.aperture.min()),
        float(demo.aperture.max()),
        float(closed.mean()),
        int(np.count_nonzero(np.diff(closed.astype(int)))),
        following([(demo.aperture, closed)]),
        bool(closed[0]),
        bool(closed[-1]),
    )
    return Inspection(demo.where, demo.task, _clock(demo), grip, tuple(_track(demo, obj) for obj in demo.objects))


def _clock(demo: Demo) -> Clock:
    times = demo.times - demo.times[0]
    step = np.diff(times)
    usual = float(np.median(step))
    gaps = tuple((float(times[i]), float(times[i + 1])) for i in np.flatnonzero(step > _GAP * usual))
    return Clock(len(demo), demo.duration_s, 1.0 / usual, gaps)


def _track(demo: Demo, obj: str) -> Track:
    frozen, seen, noise = freezes(demo, obj), demo.sees(obj), jitter(demo, obj)
    T = demo.pose(obj)
    off = np.linalg.norm(np.diff(T.p, axis=0), axis=1)
    back = np.linalg.norm(T.p[2:] - T.p[:-2], axis=1)
    jumps = (off[:-1] > _JUMP_M) & (off[1:] > _JUMP_M) & (back < 0.2 * _JUMP_M)
    jumped = np.concatenate([[False], jumps, [False]])
    return Track(
        obj,
        demo.objects[obj],
        float((seen & ~frozen).mean()),
        spans(demo, ~seen),
        spans(demo, frozen),
        noise.p_m,
        noise.r_rad,
        int(jumps.sum()),
        _moves(demo, obj, seen & ~frozen & ~jumped, (_SIGMAS * noise.p_m, _SIGMAS * noise.r_rad)),
    )


def _moves(demo: Demo, obj: str, measured: BoolArray, least: tuple[float, float]) -> tuple[Span, ...]:
    """When the object is elsewhere than a little earlier."""
    rows = np.flatnonzero(measured)
    times = demo.times[rows]
    few = max(1, round(_MEAN_S / float(np.median(np.diff(demo.times)))))
    T = _averaged(demo.pose(obj)[rows], few)
    least = (least[0] / np.sqrt(few), least[1] / np.sqrt(few))
    before = np.minimum(np.searchsorted(times, times - _WINDOW_S), np.maximum(np.arange(len(rows)) - 1, 0))
    shifted = np.linalg.norm(T.p - T.p[before], axis=1) > max(_LEAST_M, least[0])
    turned = rotation_distance(T[before], T) > max(_LEAST_RAD, least[1])
    found = np.zeros(len(demo), bool)
    for row in np.flatnonzero(shifted | turned):
        found[rows[before[row]] : rows[row] + 1] = True
    joined: list[Span] = []
    for start, stop in spans(demo, found):
        if joined and start - joined[-1][1] < _PAUSE_S:
            joined[-1] = (joined[-1][0], stop)
        else:
            joined.append((start, stop))
    return tuple(joined)


def _averaged(T: Pose, few: int) -> Pose:
    """Poses (n,), each the mean over `few` samples around it."""
    if few < 2 or len(T) < few:
        return T
    # q and -q are one rotation: along a recording they are brought to one side
    turned = np.cumprod(np.concatenate([[1.0], np.where((T.q[1:] * T.q[:-1]).sum(axis=1) < 0, -1.0, 1.0)]))
    rows = np.concatenate([T.p, turned[:, None] * T.q], axis=1)
    ends = ((few - 1) // 2, few // 2)
    padded = np.concatenate([np.repeat(rows[:1], ends[0], axis=0), rows, np.repeat(rows[-1:], ends[1], axis=0)])
    return Pose.from_vector(np.lib.stride_tricks.sliding_window_view(padded, few, axis=0).mean(axis=-1))


def spans(demo: Demo, where: BoolArray) -> tuple[Span, ...]:
    """The stretches (n,) of a recording, in seconds since its beginning, to the first sample after each; none crosses a gap."""
    times = demo.times - demo.times[0]
    step = np.diff(times)
    usual = float(np.median(step))
    starts = where & np.concatenate([[True], ~where[:-1] | (step > _GAP * usual)])
    found = []
    for a in np.flatnonzero(starts):
        b = a + 1
        while b < len(demo) and where[b] and not starts[b]:
            b += 1
        found.append((float(times[a]), float(min(times[min(b, len(demo) - 1)], times[b - 1] + usual))))
    return tuple(found)
