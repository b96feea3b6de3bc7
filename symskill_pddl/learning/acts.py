"""What was done to one object: from leaving one rest to coming to the next, with the evidence of whose doing it was.

The hand does it if the object's points at the hand move as the hand does, or if the fingers move it while the wrist stands still.
It is a grasp if for most of its way the object is constant in a hand that was around it when it was told to close; else a push.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symskill_pddl.geometry import Array, Pose, rotation_distance
from symskill_pddl.learning.decoding import Span
from symskill_pddl.learning.segments import Rest, rest
from symskill_pddl.learning.states import DWELL, HAND, REST, IntArray, Measured
from symskill_pddl.scene import GRIPPER

REACH = 2.0
"""A hand farther than this from an object's box, in A, does not move it: trackers' frames are off by as much."""
ABOUT = 6.0
"""As `REACH`, from the origin of an object of unknown size."""
SETTLES = 0.5
"""What comes to rest so soon, in tau, after a recording begins falls into place; nobody moves it."""
LONGEST_REST = 2.0
"""A rest pose is taken from at most this long, in tau, before or after a motion."""


@dataclass(frozen=True, eq=False)
class Act:
    """An object moves during samples [start, stop).

    Attributes
    ----------
    spans : tuple of Span
        Its states meanwhile.
    before, after : Rest or None
        None where the recording begins or ends meanwhile.
    hand_on : ndarray (3,)
        Where on the object, in its frame, the hand is meanwhile.
    shift : float
        How far that point was brought, in A; a radian counts as A.
    with_hand, near : bool
        Whether it moves as the hand does, and whether the hand is near enough to touch it.
    grasped : int or None
        See `Episode`.
    first : int
        Where the first try began, or `start`.
    """

    obj: str
    start: int
    stop: int
    spans: tuple[Span, ...]
    before: Rest | None
    after: Rest | None
    hand_on: Array
    shift: float = np.inf
    with_hand: bool = False
    near: bool = False
    grasped: int | None = None
    first: int = 0


def acts(measured: Measured, obj: str, spans: Sequence[Span]) -> list[Act]:
    """The acts on one object, pauses closed, nudges left out."""
    runs: list[list[Span]] = []
    for span in spans:
        if span.state == REST:
            continue
        if runs and (span.start == runs[-1][-1].stop or _pause(measured, obj, runs[-1][-1].stop - 1, span.start)):
            runs[-1].append(span)
        else:
            runs.append([span])
    bounds = [0, *(bound for run in runs for bound in (run[0].start, run[-1].stop)), len(measured.demo)]
    times, found = measured.demo.times, list[Act]()
    for k, run in enumerate(runs):
        act = _act(measured, obj, tuple(run), (bounds[2 * k], bounds[2 * k + 3]))
        if act.shift >= measured.config.slight:
            act = _judged(measured, act)
            settles = act.before is None and act.grasped is None and times[act.stop - 1] - times[0] < SETTLES * measured.tau
            if not settles:
                found.append(act)
    return found


def _pause(measured: Measured, obj: str, stop: int, start: int) -> bool:
    """Whether between samples `stop` and `start` the hand stays where it is on the object, with one command."""
    gap = slice(stop, start + 1)
    p = (measured.demo.pose(obj)[gap].inverse() @ measured.demo.T_world_ee[gap]).p
    command = measured.demo.gripper_closed[gap]
    farthest = np.linalg.norm(p - p[0], axis=-1).max()
    return bool(np.all(command == command[0]) and farthest < measured.config.around / 2 * measured.A)


def _act(measured: Measured, obj: str, spans: tuple[Span, ...], limits: tuple[int, int]) -> Act:
    """With its rests, which lie within `limits`, and its bounds at the recording's own rate."""
    demo, slight = measured.demo, measured.config.slight
    T, start, stop = demo.pose(obj), spans[0].start, spans[-1].stop
    hand_on = np.median((T[start:stop].inverse() @ demo.T_world_ee[start:stop]).p, axis=0)
    act = Act(obj, start, stop, spans, None, None, hand_on)
    earliest, latest = measured.after(-LONGEST_REST), measured.after(LONGEST_REST)
    before = rest(demo, obj, max(int(earliest[start]), limits[0]), start) if start > limits[0] else None
    after = rest(demo, obj, stop, min(max(int(latest[stop - 1]), stop + 1), limits[1])) if stop < limits[1] else None
    if before is not None:  # until it has gone, it has not left for good where it stays for a moment
        home = _apart(measured, act, T[start:stop], before.T_world_obj) < slight
        until = len(home) if home.all() else int(np.argmin(home))
        stayed = np.flatnonzero(measured.stays(obj, measured.after(-DWELL))[start : start + until])
        start += int(stayed[-1]) + 1 if len(stayed) and not home.all() else 0
    if after is not None:
        away = np.flatnonzero(_apart(measured, act, T[start:stop], after.T_world_obj) >= slight / 2)
        arrived = start + int(away[-1]) + 1 if len(away) else start
        stays = np.flatnonzero(measured.stays(obj, measured.after(DWELL))[arrived:stop])
        stop = max(arrived + int(stays[0]) if len(stays) else stop, start + 1)
    first, last = (T[i] if r is None else r.T_world_obj for r, i in ((before, start), (after, stop - 1)))
    shift = float(_apart(measured, act, last, first))
    return replace(act, start=start, stop=stop, before=before, after=after, shift=shift, first=start)


def _apart(measured: Measured, act: Act, T: Pose, T_other: Pose) -> Array:
    """How far poses are from another one, in A: where the hand is on the object, and in radians."""
    shift = np.linalg.norm(T.apply(act.hand_on) - T_other.apply(act.hand_on), axis=-1) / measured.A
    return np.hypot(shift, rotation_distance(T, T_other))


def _judged(measured: Measured, act: Act) -> Act:
    """Whose doing it was, and whether it was in the fingers."""
    own = measured.noise(act.obj)
    blur_m = np.hypot(own.p_m, float(np.linalg.norm(act.hand_on)) * own.r_rad)
    by_noise = 2.0 * np.sqrt(6.0) * float(np.hypot(blur_m / measured.A, own.r_rad))
    moved, hand, at = _steps(measured, act, max(DWELL, 2.0 * by_noise))
    way = np.maximum(np.linalg.norm(moved, axis=-1) - by_noise, 0.0)
    larger = np.maximum(np.sum(moved**2, axis=-1), np.sum(hand**2, axis=-1))
    along = np.clip(np.sum(moved * hand, axis=-1) / np.where(larger > 0.0, larger, 1.0), 0.0, 1.0)
    near = _near(measured, act)
    span = slice(act.start, act.stop)
    wrist_m = float(np.linalg.norm(np.ptp(measured.demo.T_world_ee.p[span], axis=0)))
    fingers = float(np.ptp(measured.demo.aperture[span])) > measured.config.slight * measured.A > 0.5 * wrist_m
    with_hand = float(way @ along) > measured.config.along * float(way.sum()) or (near and fingers)
    closings = {span: _closing(measured, act, span) for span in act.spans}
    held = {span: closing for span, closing in closings.items() if closing is not None}
    in_fingers = sum(float(way[(at >= span.start) & (at < span.stop)].sum()) for span in held)
    grasped = min(held.values()) if with_hand and held and in_fingers > 0.5 * float(way.sum()) else None
    return replace(act, with_hand=with_hand, near=near, grasped=grasped)


def _steps(measured: Measured, act: Act, taus: float) -> tuple[Array, Array, IntArray]:
    """In steps of so many tau: how the object's point at the hand moves (k, 6), in A and radians, how the hand does, and the
    samples (k,) at which the steps begin."""
    demo = measured.demo
    dt = float(np.median(np.diff(demo.times)))
    at = np.arange(act.start, act.stop, max(round(taus * measured.tau / dt), 1))
    at = np.append(at, min(act.stop, len(demo) - 1))
    T, hand = demo.pose(act.obj)[at], demo.T_world_ee[at]
    change, hands = T[1:] @ T[:-1].inverse(), hand[1:] @ hand[:-1].inverse()
    moved = np.concatenate([(change.apply(hand.p[:-1]) - hand.p[:-1]) / measured.A, change.rotvec()], axis=-1)
    return moved, np.concatenate([np.diff(hand.p, axis=0) / measured.A, hands.rotvec()], axis=-1), at[:-1]


def _near(measured: Measured, act: Act) -> bool:
    """Whether the hand is near the object's box while it moves; without extents, whether it is anywhere about it."""
    half = measured.demo.extents.get(measured.demo.objects[act.obj])
    span = slice(act.start, act.stop)
    p = np.abs((measured.demo.pose(act.obj)[span].inverse() @ measured.demo.T_world_ee[span]).p)
    outside = p if half is None else np.maximum(p - np.array(half), 0.0)
    return bool(np.median(np.linalg.norm(outside, axis=-1)) < (ABOUT if half is None else REACH) * measured.A)


def _closing(measured: Measured, act: Act, span: Span) -> int | None:
    """When the fingers closed on the object, if it is in them during this span."""
    command = measured.demo.gripper_closed
    if span.state != HAND or np.mean(command[span.start : span.stop]) <= 0.5:
        return None
    last = int(np.flatnonzero(command[: span.stop])[-1])
    opened = np.flatnonzero(~command[:last])
    first = int(opened[-1]) + 1 if len(opened) else 0
    if first == 0 and act.before is not None:
        return None  # a fist from the first sample on, which came to the object later
    p = (measured.demo.pose(act.obj).inverse() @ measured.demo.T_world_ee).p
    place = np.median(p[max(span.start, first) : span.stop], axis=0)
    return first if np.linalg.norm(p[first] - place) < measured.config.around * measured.A else None


def follows(measured: Measured, act: Act) -> float | None:
    """The gain from what the hand strays across its way to what the object's point at the hand does; None if that tells nothing.

    Only of what is in the fingers: what is pushed follows as friction wants. The ways of both are fitted as quintics of how far
    the hand has come, and what is left over is compared: a free object leaves over what the hand does, a drawer nothing.
    """
    if act.grasped is None:
        return None
    span = slice(act.spans[0].start, act.stop)
    hand = measured.demo.T_world_ee.p[span]
    both = np.concatenate([hand, measured.demo.pose(act.obj)[span].apply(act.hand_on)], axis=1)
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(hand, axis=0), axis=-1))])
    if len(way) < 12 or way[-1] < measured.config.slight * measured.A:
        return None
    basis = np.polynomial.legendre.legvander(2 * way / way[-1] - 1, 5)
    across = both - basis @ np.linalg.lstsq(basis, both, rcond=None)[0]
    strays = float(np.sqrt(np.mean(np.sum(across[:, :3] ** 2, axis=-1))))
    own = measured.noise(act.obj)
    blur_m = np.hypot(own.p_m, float(np.linalg.norm(act.hand_on)) * own.r_rad) / np.sqrt(len(way))
    if strays < max(3 * measured.noise(GRIPPER).p_m, 5 * blur_m, measured.config.still / 20 * measured.A):
        return None
    return float(np.sum(across[:, :3] * across[:, 3:]) / np.sum(across[:, :3] ** 2))
