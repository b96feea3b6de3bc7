"""Unsegmented recordings into episodes: who moved what, when, and where it rested (paper, Demo Segmentation).

`motions` says what moved when. An episode is a motion by the hand, from before it comes until after it has left. Later, an
episode that leads from one rest cluster into the same one is dropped (`predicates`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symskill_pddl.demos import Demo
from symskill_pddl.errors import LearningError
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.learning.motions import Mask, Motion, SegmentConfig, intervals, motions, pose_over, speeds

RestKey = tuple[str, str, int, int]
"""Demonstration, object, and samples [start, stop)."""


@dataclass(frozen=True, eq=False)
class Rest:
    """Where an object rested: its pose over samples [start, stop), next to a motion, or (`static`) all through a
    demonstration. `where` names the demonstration (`Demo.where`); `parts` hang on the object: it does not rest at them.

    `held`: it is in the hand when the recording ends. Then the pose says where it has been lifted to."""

    where: str
    obj: str
    start: int
    stop: int
    T_world_obj: Pose
    static: bool = False
    parts: tuple[str, ...] = ()
    held: bool = False

    @property
    def key(self) -> RestKey:
        """What identifies a rest among those of all demonstrations."""
        return self.where, self.obj, self.start, self.stop


@dataclass(frozen=True, eq=False)
class Episode:
    """The gripper comes, moves one object, and leaves. All times are sample indices into `demo`.

    Attributes
    ----------
    demo : Demo
    obj : str
        `o_int`, the object that the gripper acts on.
    begin : int
        t_0, the earliest sample since which nothing but the end effector moved, not before the previous retreat's end.
    start, stop : int
        The object moves during [start, stop).
    leave : int or None
        The gripper has let go (geometrically); None if the recording ends before.
    end : int
        End of the retreat: the hand's first rest after leaving.
    passengers : tuple of str
        Other objects that moved along.
    before, after : Rest or None
        Where the object rested; `after` is None if the recording ends with the object in the hand.
    body : str or None
        What the object is a part of and moved in the end (`endings`); then `after` is the body's rest and `body_before` the one
        it had.
    """

    demo: Demo
    obj: str
    begin: int
    start: int
    stop: int
    leave: int | None
    end: int
    passengers: tuple[str, ...]
    before: Rest | None
    after: Rest | None
    body: str | None = None
    body_before: Rest | None = None

    @property
    def moved(self) -> str:
        """What the motion brings somewhere: the object, or the body that it is a part of."""
        return self.body or self.obj

    @property
    def moved_type(self) -> str:
        return self.demo.objects[self.moved]

    def moved_along(self) -> Pose:
        """`T_world_moved` over the motion."""
        return self.demo.pose(self.moved)[self.start : self.stop]

    def rests(self, type_: str) -> tuple[Rest, ...]:
        """The rests of what is of this type."""
        found = (self.before, self.body_before, self.after)
        return tuple(r for r in found if r is not None and self.demo.objects[r.obj] == type_)

    def way(self, type_: str) -> Pose | None:
        """How what is of this type moved, apart from the body it is a part of; None if nothing of the type did."""
        span = slice(self.start, self.stop)
        if type_ == self.type:
            T = self.demo.pose(self.obj)[span]
            return T if self.body is None else self.moved_along().inverse() @ T
        return self.moved_along() if type_ == self.moved_type else None

    @property
    def type(self) -> str:
        return self.demo.objects[self.obj]

    def __str__(self) -> str:
        t = self.demo.times
        return f"{self.demo.where} {self.obj} {t[self.begin]:.2f}-{t[self.start]:.2f}-{t[self.stop - 1]:.2f} s"


def rest(demo: Demo, obj: str, start: int, stop: int, *, static: bool = False) -> Rest:
    """The rest of an object over samples [start, stop)."""
    return Rest(demo.where, obj, start, stop, pose_over(demo.pose(obj), start, stop), static)


def lifted(e: Episode) -> Episode:
    """An episode that ends in the hand, with the pose it ends at in place of a rest."""
    if e.before is None or e.after is not None or e.leave is not None:
        return e
    last = len(e.demo)
    return replace(e, after=replace(rest(e.demo, e.moved, max(last - 3, e.start), last), held=True))


def segment(demo: Demo, config: SegmentConfig | None = None) -> tuple[Episode, ...]:
    """The episodes of one demonstration, in order of time."""
    config = config or SegmentConfig()
    moved = motions(demo, config)
    carriers = [_carrier(demo, m, moved) for m in moved]
    hand_v, hand_w = speeds(demo.T_world_ee, demo.times, config.filter_s)
    still = (hand_v < config.hand_rest_m_s) & (hand_w < config.hand_rest_rad_s)
    episodes: list[Episode] = []
    free_since = 0
    for motion, carrier in zip(moved, carriers, strict=True):
        if carrier is not motion or not _by_hand(demo, motion, still, config):
            continue
        along = tuple(sorted({m.obj for m, c in zip(moved, carriers, strict=True) if c is motion and m is not motion}))
        following = min(
            (m.start for m, c in zip(moved, carriers, strict=True) if m.start >= motion.stop and c is not motion),
            default=len(demo),
        )
        leave = _leave(demo, motion, following, config)
        end = motion.stop if leave is None else _retreat_end(demo, motion, leave, following, still, config)
        previous = max(
            (m.stop for m, c in zip(moved, carriers, strict=True) if m.stop <= motion.start and c is not motion), default=0
        )
        episodes.append(
            Episode(
                demo=demo,
                obj=motion.obj,
                begin=min(max(previous, free_since), motion.start),
                start=motion.start,
                stop=motion.stop,
                leave=leave,
                end=end,
                passengers=along,
                before=_rest_before(demo, motion, moved, config),
                after=None if leave is None else _rest_after(demo, motion, moved, config),
            )
        )
        free_since = end
    return tuple(episodes)


def _by_hand(demo: Demo, motion: Motion, still: Mask, config: SegmentConfig) -> bool:
    """Whether the hand can have moved it: it moves too, and it is near."""
    span = slice(motion.start, motion.stop)
    half = demo.extents.get(demo.objects[motion.obj])
    gap = np.linalg.norm(_outside(demo, motion, half), axis=-1) if half is not None else np.zeros(1)
    return bool(not still[span].all() and np.median(gap) < config.reach_m)


def _outside(demo: Demo, motion: Motion, half: tuple[float, float, float]) -> Array:
    """How far the hand is from the object's box, per axis of the object (n, 3)."""
    span = slice(motion.start, motion.stop)
    in_obj = demo.pose(motion.obj)[span].inverse() @ demo.T_world_ee[span]
    return np.maximum(np.abs(in_obj.p) - np.array(half), 0.0)


def _carrier(demo: Demo, motion: Motion, moved: Sequence[Motion]) -> Motion:
    """The motion that carries this one along: itself, or one that it shares at least half of the shorter's time with."""

    def score(m: Motion, start: int, stop: int) -> float:
        T_ee_obj = demo.T_world_ee[start:stop].inverse() @ demo.pose(m.obj)[start:stop]
        slip = float(np.linalg.norm(T_ee_obj.p.std(axis=0)))
        half = demo.extents.get(demo.objects[m.obj], (0.0, 0.0, 0.0))
        away = np.linalg.norm(_outside(demo, Motion(m.obj, start, stop), half), axis=-1)
        return slip + 0.5 * float(np.median(away))

    best = motion
    for other in moved:
        start, stop = max(motion.start, other.start), min(motion.stop, other.stop)
        if other.obj == motion.obj or stop - start < 0.5 * min(motion.stop - motion.start, other.stop - other.start):
            continue
        if score(other, start, stop) < score(best, start, stop):
            best = other
    # a chain of carriers ends at the one that the gripper holds
    return best if best is motion else _carrier(demo, best, [m for m in moved if m is not motion])


def _leave(demo: Demo, motion: Motion, following: int, config: SegmentConfig) -> int | None:
    T_obj_ee = demo.pose(motion.obj).inverse() @ demo.T_world_ee
    last = motion.stop - 1
    away = np.linalg.norm(T_obj_ee.p[motion.stop : following] - T_obj_ee.p[last], axis=-1) > config.away_m
    if away.any():
        return motion.stop + int(np.argmax(away))
    # it moved again before the hand was gone, by a regrasp or by the hand's leaving: that ends this episode too
    return following if following < len(demo) else None


def _retreat_end(demo: Demo, motion: Motion, leave: int, following: int, still: Mask, config: SegmentConfig) -> int:
    """The first rest of the hand after leaving; without one before the next motion, where the hand was farthest away."""
    long = max(round(config.hand_rest_s / float(np.median(np.diff(demo.times)))), 1)
    bound = min(
        int(np.searchsorted(demo.times, demo.times[leave] + config.max_retreat_s)), max(following - 1, leave), len(demo) - 1
    )
    distance = np.linalg.norm(demo.T_world_ee.p[leave : bound + 1] - demo.T_world_ee.p[motion.stop - 1], axis=-1)
    for a, b in intervals(still[leave : bound + 1], still[leave : bound + 1]):
        if b - a < long and leave + b < len(demo):
            continue
        if distance[a] < 0.5 * distance[: a + 1].max():
            break  # it is on its way back already, to act on the same thing again
        return leave + a
    if following == len(demo) or demo.times[bound] - demo.times[leave] >= config.max_retreat_s:
        return bound if distance[-1] >= 0.5 * distance.max() else leave + int(np.argmax(distance))
    return leave + int(np.argmax(distance))


def _rest_before(demo: Demo, motion: Motion, moved: Sequence[Motion], config: SegmentConfig) -> Rest | None:
    earliest = int(np.searchsorted(demo.times, demo.times[motion.start] - config.rest_window_s))
    start = max([earliest, *(m.stop for m in moved if m.obj == motion.obj and m.stop <= motion.start)])
    return rest(demo, motion.obj, start, motion.start) if motion.start > start else None


def _rest_after(demo: Demo, motion: Motion, moved: Sequence[Motion], config: SegmentConfig) -> Rest | None:
    latest = int(np.searchsorted(demo.times, demo.times[motion.stop - 1] + config.rest_window_s))
    stop = min([latest, len(demo), *(m.start for m in moved if m.obj == motion.obj and m.start >= motion.stop)])
    return rest(demo, motion.obj, motion.stop, stop) if stop > motion.stop else None


def segment_all(demos: Sequence[Demo], config: SegmentConfig | None = None) -> tuple[Episode, ...]:
    """Episodes of all demonstrations.

    Raises
    ------
    LearningError
        If nothing moves in any of them.
    """
    episodes = tuple(e for demo in demos for e in segment(demo, config))
    if not episodes:
        raise LearningError(f"no object moves in any of the {len(demos)} demonstrations: there is nothing to learn from")
    return episodes
