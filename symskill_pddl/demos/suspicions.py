"""What is suspicious about recordings, and what learning would stumble over: one line each, with what would help."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from symskill_pddl.demos.demo import Demo, extent_conflicts
from symskill_pddl.demos.gravity import up_axis
from symskill_pddl.demos.inspection import Inspection, Span

_CLOCK_S = 5.0
"""A gap that is longer than this is rather a clock that was set than a pause of the recorder."""
_WIDE_M, _FAR_M = 0.4, 20.0
"""No hand opens farther, no table top is larger: numbers beyond are millimetres."""
_LEAD = 0.25
"""With less of a lead, nothing is said of the way up."""
_FIXED_M, _REACH_M = 0.005, 0.3
"""What keeps its place in the hand this well, and lies within its reach, goes with it."""
_FEW = 5
"""Lines of one kind before the rest is counted."""


def suspicions(demos: Sequence[Demo], inspections: Sequence[Inspection]) -> tuple[str, ...]:
    """Lines about the recordings, the same about several in one, then about all of them together."""
    same: dict[str, list[str]] = {}
    for demo, found in zip(demos, inspections, strict=True):
        for line in (*_clock(found), *_hand(demo, found), *_objects(demo, found)):
            same.setdefault(line, []).append(found.where)
    return (*(f"{_listed(where)}: {line}" for line, where in same.items()), *_of_all(demos, inspections))


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:_FEW]) + (f" and {len(names) - _FEW} more" if len(names) > _FEW else "")


def _clock(found: Inspection) -> Iterator[str]:
    clock = found.clock
    long = [gap for gap in clock.gaps if gap[1] - gap[0] > _CLOCK_S]
    for start, stop in long[:_FEW]:
        yield f"the clock jumps by {stop - start:.1f} s at {start:.2f} s: cut the recording there if things were moved meanwhile"
    short = [gap for gap in clock.gaps if gap not in long]
    if short:
        widest = max(short, key=lambda gap: gap[1] - gap[0])
        yield f"{len(short)} gaps in time, the longest {widest[1] - widest[0]:.2f} s at {widest[0]:.2f} s"
    if clock.rate_hz < 8:
        yield f"only {clock.rate_hz:.1f} samples per second: short grasps and rests may lie between two of them"


def _hand(demo: Demo, found: Inspection) -> Iterator[str]:
    grip = found.grip
    moved = [track for track in found.tracks if track.moves]
    if grip.widest_m > _WIDE_M:
        yield f"the hand opens to {grip.widest_m:g} m: are apertures given in millimetres?"
    carried = [track.name for track in moved if any(_carried(demo, track.name, span) for span in track.moves)]
    if grip.follows is None and carried:
        told = "though it is told to" if grip.switches else "and is never told to"
        yield (
            f"the gripper never moves, {told}, while {', '.join(carried)} goes with the hand: is its opening missing in the "
            "recording? It would be learned as a push"
        )
    elif grip.follows is not None and grip.follows < 0.5:
        other = "the command may be turned round" if grip.follows < -0.5 else "the command may be another column"
        yield f"the fingers do not follow the gripper's command ({grip.follows:.0%} of their travel): {other}"
    if grip.at_first and grip.follows is not None:
        yield "begins with a closed gripper: what it holds has no pick"
    if grip.at_last and grip.follows is not None and moved:
        yield "ends with a closed gripper: what it holds has no place"


def _carried(demo: Demo, obj: str, span: Span) -> bool:
    """Whether an object goes a way with the hand and keeps its place in it, through the middle half of a motion."""
    times = demo.times - demo.times[0]
    quarter = 0.25 * (span[1] - span[0])
    rows = np.flatnonzero((times >= span[0] + quarter) & (times <= span[1] - quarter))
    if len(rows) < 3:
        return False
    held = (demo.T_world_ee[rows].inverse() @ demo.pose(obj)[rows]).p
    way = np.linalg.norm(np.diff(demo.pose(obj).p[rows], axis=0), axis=1).sum()
    return bool(np.ptp(held, axis=0).max() < _FIXED_M < 0.1 * way and np.linalg.norm(held.mean(axis=0)) < _REACH_M)


def _objects(demo: Demo, found: Inspection) -> Iterator[str]:
    if np.abs(demo.T_world_objects.p).max(initial=0.0) > _FAR_M:
        yield f"an object is {np.abs(demo.T_world_objects.p).max():.0f} m from the origin: are positions given in millimetres?"
    if not any(track.moves for track in found.tracks):
        yield "no object moves: nothing can be learned from it"
    for track in found.tracks:
        if track.unseen:
            longest = max(stop - start for start, stop in track.unseen)
            yield f"{track.name} is not seen in {len(track.unseen)} stretches, the longest {longest:.2f} s"
        if track.frozen:
            longest = max(stop - start for start, stop in track.frozen)
            yield f"the tracker of {track.name} freezes {len(track.frozen)} times, up to {longest:.2f} s: counted as not seen"
        if track.jumps:
            yield f"{track.name} jumps away for single samples, {track.jumps} times"
        if track.jitter_m > 0.003 or track.jitter_rad > np.radians(3):
            yield (
                f"{track.name} jitters by {1000 * track.jitter_m:.1f} mm, {np.degrees(track.jitter_rad):.1f} deg: motions "
                "that are not much larger are lost"
            )


def _of_all(demos: Sequence[Demo], inspections: Sequence[Inspection]) -> Iterator[str]:
    up = up_axis(demos)
    if up is not None and up.axis != "+z" and up.lead > _LEAD:
        yield f"{up.axis} seems to be up, not +z (lead {up.lead:.2f}): turn the world frame, or say so where it is learned from"
    every = dict.fromkeys(obj for demo in demos for obj in demo.objects)
    for obj in every:
        lacking = [demo.where for demo in demos if obj not in demo.objects]
        types = sorted({demo.objects[obj] for demo in demos if obj in demo.objects})
        if lacking:
            yield f"{obj} is not in {', '.join(lacking[:_FEW])}: what they show counts without it"
        if len(types) > 1:
            yield f"{obj} is of types {', '.join(types)}: operators are learned for each of them"
    rates = [found.clock.rate_hz for found in inspections]
    if max(rates) > 1.5 * min(rates):
        yield f"rates differ, from {min(rates):.1f} to {max(rates):.1f} samples per second"
    for one, other in combinations(demos, 2):
        if len(one) == len(other) and np.array_equal(one.T_world_ee.p, other.T_world_ee.p):
            yield f"{one.where} and {other.where} are the same recording: it is no second demonstration"
    yield from extent_conflicts(demos)
