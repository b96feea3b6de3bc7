"""Acts on single objects into the episodes of a recording: what the hand acted on, what went along, and the cuts between."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symskill_pddl.demos import Demo
from symskill_pddl.errors import LearningError
from symskill_pddl.geometry import Pose, rotation_distance
from symskill_pddl.learning.acts import LONGEST_REST, REACH, Act, acts, follows
from symskill_pddl.learning.articulation import fit_joint
from symskill_pddl.learning.scale import aperture_of
from symskill_pddl.learning.segments import Episode, Rest, rest
from symskill_pddl.learning.states import DWELL, BoolArray, Measured, StateConfig, spans


def segment(demo: Demo, config: StateConfig | None = None, *, length_m: float | None = None) -> tuple[Episode, ...]:
    """The episodes of one demonstration, in order of time; `length_m` is A, from this recording if it is not given."""
    measured = Measured.of(demo, length_m or aperture_of([demo]), config or StateConfig())
    found = [act for obj in demo.objects for act in acts(measured, obj, spans(measured, obj))]
    moved = sorted((act for act in found if act.with_hand), key=lambda a: (a.start, a.stop, a.obj))
    touched = [act for act in moved if act.near]
    carriers = [_carrier(demo, act, touched) for act in moved]
    kept = _without_tries([act for act, c in zip(moved, carriers, strict=True) if c is act and act.near])
    episodes, begin = [], 0
    for act, following in zip(kept, [*kept[1:], None], strict=False):
        leave, end, until = _retreat(measured, act, following)
        along = {a.obj for a, c in zip(moved, carriers, strict=True) if (c.obj, c.stop) == (act.obj, act.stop)} - {act.obj}
        episode = Episode(
            demo=demo,
            obj=act.obj,
            begin=min(begin, act.start),
            start=act.start,
            stop=act.stop,
            leave=leave,
            end=end,
            passengers=tuple(sorted(along)),
            before=act.before,
            after=act.after,
            grasped=act.grasped,
            follows=follows(measured, act),
        )
        episodes.append(_settled(_with_body(episode, measured)))
        begin = until
    return tuple(episodes)


def segment_all(demos: Sequence[Demo], config: StateConfig | None = None) -> tuple[Episode, ...]:
    """Episodes of all demonstrations, measured by one hand.

    Raises
    ------
    LearningError
        If nothing moves in any of them.
    """
    length_m = aperture_of(demos)
    episodes = tuple(e for demo in demos for e in segment(demo, config, length_m=length_m))
    if not episodes:
        raise LearningError(f"no object moves in any of the {len(demos)} demonstrations, so there is nothing to learn")
    return episodes


def _carrier(demo: Demo, act: Act, others: Sequence[Act]) -> Act:
    """The act that carries this one along: itself, or one that it shares at least half of the shorter's time with."""

    def score(a: Act, start: int, stop: int) -> float:
        p = (demo.pose(a.obj)[start:stop].inverse() @ demo.T_world_ee[start:stop]).p
        half = np.array(demo.extents.get(demo.objects[a.obj], (0.0, 0.0, 0.0)))
        away = np.linalg.norm(np.maximum(np.abs(p) - half, 0.0), axis=-1)
        return float(np.linalg.norm(p.std(axis=0)) + 0.5 * np.median(away))

    best = act
    for other in others:
        start, stop = max(act.start, other.start), min(act.stop, other.stop)
        if other.obj == act.obj or stop - start < 0.5 * min(act.stop - act.start, other.stop - other.start):
            continue
        if score(other, start, stop) < score(best, start, stop):
            best = other
    # a chain of carriers ends at the one that the hand holds
    return best if best is act else _carrier(demo, best, [a for a in others if a is not act])


def _without_tries(led: Sequence[Act]) -> list[Act]:
    """The acts, less those that bring an object less far than A before a grasp of the same object: they belong to that grasp."""
    kept: list[Act] = []
    for act in led:
        first = act.start
        while act.grasped is not None and kept and kept[-1].obj == act.obj and _nowhere(kept[-1]):
            first = kept.pop().first
        kept.append(replace(act, first=first))
    return kept


def _nowhere(act: Act) -> bool:
    return act.shift < 1.0 and act.after is not None


WHOLE = 0.95
"""A hand that is as far as this fraction of its way stays there."""


def _retreat(measured: Measured, act: Act, following: Act | None) -> tuple[int | None, int, int]:
    """When the hand has let go, if it does; the end of its retreat; and the begin of the next approach.

    The last retreat of a recording ends where the hand stays. Others end where the hand first pauses when it is A away, or
    without a pause where it is out of reach or as far as it gets; the next approach begins at that pause, or without one where
    the hand is farthest from both.
    """
    demo = measured.demo
    cut = len(demo) - 1 if following is None else _cut(demo, act, following)
    last = min(act.stop - 1, cut)
    if act.after is None:
        return None, cut, cut
    distance = np.linalg.norm(demo.T_world_ee.p[last : cut + 1] - demo.T_world_ee.p[last], axis=-1)
    left, away, gone = (np.flatnonzero(distance > d * measured.A) for d in (measured.config.around / 2, 1.0, REACH))
    if not len(left):
        return (None if following is None else cut), cut, cut
    if following is None:  # nothing cuts it short: a door that was pushed shut is left until the hand is where it stays
        end = last + int(np.argmax(distance >= WHOLE * distance.max()))
        return last + int(left[0]), end, end
    clear = last + int(away[0] if len(away) else np.argmax(distance))
    soon = min(int(measured.after(LONGEST_REST)[clear]), cut)
    end = min(last + int(gone[0] if len(gone) else np.argmax(distance)), soon)
    pauses = clear + np.flatnonzero(_pauses(measured)[clear : soon + 1])
    if len(pauses):
        end = cut = int(pauses[0])
    return last + int(left[0]), end, cut


def _cut(demo: Demo, act: Act, following: Act) -> int:
    """The sample at which the hand is as far as it gets from both, where it let the one go and where it touches the next."""
    first, last = act.stop - 1, max(following.first, act.stop - 1)
    p = demo.T_world_ee.p[first : last + 1]
    apart = np.minimum(np.linalg.norm(p - p[0], axis=-1), np.linalg.norm(p - p[-1], axis=-1))
    return first + int(np.argmax(apart))


def _pauses(measured: Measured) -> BoolArray:
    """Where the hand is slower than a fifth of its usual speed for the least dwell."""
    p = measured.demo.T_world_ee.p
    way = np.linalg.norm(p[measured.after(DWELL)] - p, axis=-1)
    return np.asarray(way < DWELL / 5 * measured.A)


def _settled(e: Episode) -> Episode:
    """With a rest after where the recording ends too soon to show one: what is pushed, or turns about an axis, stays there."""
    last = len(e.demo) - 1
    if e.after is not None or e.stop <= last:
        return e
    joint = fit_joint([e.moved_along()])
    if e.held and (joint is None or joint.kind != "hinge" or (e.follows or 0.0) > 0.5):
        return e
    parts = (e.obj,) if e.body is not None else ()
    return replace(e, after=Rest(e.demo.where, e.moved, last, last + 1, e.demo.pose(e.moved)[last], parts=parts))


def _with_body(e: Episode, measured: Measured) -> Episode:
    """With the body that its object is a part of: one that follows after the object has moved by itself, as a door its latch."""
    slight = measured.config.slight

    def moved(T: Pose, least: float) -> BoolArray:
        return np.hypot(np.linalg.norm(T.p - T.p[0], axis=-1) / measured.A, rotation_distance(T, T[0])) > least

    for name in e.passengers:
        T_world_body = e.demo.pose(name)[e.start : e.stop]
        T_body_obj = T_world_body.inverse() @ e.demo.pose(e.obj)[e.start : e.stop]
        follows_at = np.flatnonzero(moved(T_world_body, slight / 2))
        if not len(follows_at) or not moved(T_body_obj[: follows_at[0]], slight).any():
            continue
        if fit_joint([T_body_obj]) and fit_joint([T_world_body[follows_at[0] :]]):
            before, after = (
                None if r is None else replace(rest(e.demo, name, r.start, r.stop), parts=(e.obj,)) for r in (e.before, e.after)
            )
            return replace(e, body=name, body_before=before, after=after)
    return e
