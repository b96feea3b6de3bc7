"""Unsegmented recordings into episodes: who moved, when, with what, and where it rested (paper, Demo Segmentation; METHOD
section 2).

Velocities come from a Savitzky-Golay filter (local quadratic over `filter_s`; positions, and quaternions made sign-continuous).
An object moves from the moment its linear *or* angular speed exceeds the entering threshold until *both* are below the leaving
ones.

People hesitate, try again and bump into things. What keeps that out of the episodes:

- a gap in an object's motion is closed if it is shorter than `merge_gap_s`, or if the gripper stayed where it was on the object
  and kept its command (a pause in mid-carry or mid-push);
- a motion after which the object rests where it was (1 cm, 5 degrees) is dropped: nudges, grasps that slipped;
- later, an episode that leads from one rest cluster into the same one is dropped as well (`predicates`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from symskill_pddl.demos import Demo
from symskill_pddl.errors import LearningError
from symskill_pddl.geometry import Array, Pose, karcher_mean, quat_conjugate, quat_log, quat_multiply, rotation_distance

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class SegmentConfig:
    """Thresholds of the segmentation; each with its unit in its name."""

    filter_s: float = 0.35
    """Window of the Savitzky-Golay filter; 7 samples at 20 Hz."""
    enter_m_s: float = 0.02
    """An object moves from this speed on: slower than any stroke of a hand, three times what 1 mm of jitter looks like."""
    leave_m_s: float = 0.01
    """It moves until it is slower than this: half of the entering speed, so that an even push is not cut up."""
    enter_rad_s: float = 0.10
    """As `enter_m_s`, for turning: a door of 0.3 m then moves at its handle by 3 cm/s."""
    leave_rad_s: float = 0.05
    """As `leave_m_s`, for turning."""
    reach_m: float = 0.15
    """What moves farther than this from the hand (from its box to the hand, if its extents are known) falls or rolls."""
    merge_gap_s: float = 0.25
    """Shorter gaps in a motion are none: a filter's length, and less than people need to begin anew."""
    held_m: float = 0.02
    """A gap is a pause in contact if the hand stays this near to where it was on the object: less than a finger's width."""
    held_rad: float = float(np.radians(15.0))
    """As `held_m`, for turning."""
    settle_m: float = 0.005
    """As `settle_rad`, for shifts."""
    settle_rad: float = float(np.radians(2.0))
    """A slow end of a motion counts as motion until the object is this near to where it comes to rest."""
    left_m: float = 0.002
    """As `left_rad`, for shifts."""
    left_rad: float = float(np.radians(0.5))
    """An object has left its resting place once it is this far from it, and three times its pose's jitter, and has come to the
    next one likewise."""
    min_shift_m: float = 0.01
    """What moves less than this, and turns less than `min_turn_rad`, was nudged: people knock things by up to 1 cm."""
    min_turn_rad: float = float(np.radians(5.0))
    """As `min_shift_m`, for turning."""
    away_m: float = 0.03
    """The hand has let go of an object once it is this far from where it was on it."""
    hand_rest_m_s: float = 0.015
    """A hand slower than this is at rest: it never stands quite still."""
    hand_rest_rad_s: float = 0.10
    """As `hand_rest_m_s`, for turning."""
    hand_rest_s: float = 0.5
    """A retreat ends where the hand is this slow for this long."""
    max_retreat_s: float = 4.0
    """No retreat takes longer; what the hand does later belongs to what follows."""
    rest_window_s: float = 2.0
    """A rest pose is taken from at most this long after, or before, a motion."""


@dataclass(frozen=True)
class Motion:
    """One object moving during samples [start, stop)."""

    obj: str
    start: int
    stop: int


@dataclass(frozen=True, eq=False)
class Rest:
    """Where an object rested: its pose over samples [start, stop), next to a motion, or (`static`) all through a
    demonstration. `parts` hang on the object: it does not rest at them."""

    obj: str
    start: int
    stop: int
    T_world_obj: Pose
    static: bool = False
    parts: tuple[str, ...] = ()


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


def speeds(T: Pose, times: Array, filter_s: float) -> tuple[Array, Array]:
    """Linear [m/s] and angular [rad/s] speed (n,) of a frame from its poses (n,), filtered as this module's text says."""
    dt = float(np.median(np.diff(times)))
    window = min(max(2 * round(filter_s / dt / 2) + 1, 3), 2 * ((len(times) - 1) // 2) + 1)
    if window < 3:
        gap = dt * (len(times) - 1)
        turn = rotation_distance(T[0], T[-1])
        return np.full(len(times), np.linalg.norm(T.p[-1] - T.p[0]) / gap), np.full(len(times), turn / gap)
    flips = np.where(np.sum(T.q[1:] * T.q[:-1], axis=-1) < 0.0, -1.0, 1.0)
    q = T.q * np.concatenate([[1.0], np.cumprod(flips)])[:, None]
    rate_p = savgol_filter(T.p, window, 2, deriv=1, delta=dt, axis=0)
    rate_q = savgol_filter(q, window, 2, deriv=1, delta=dt, axis=0)
    omega = 2.0 * quat_multiply(quat_conjugate(savgol_filter(q, window, 2, axis=0)), rate_q)[..., 1:]
    return np.linalg.norm(rate_p, axis=-1), np.linalg.norm(omega, axis=-1)


def intervals(enter: Mask, stay: Mask) -> list[tuple[int, int]]:
    """Maximal runs [a, b) that contain a sample of `enter` and in which every sample is in `stay` (hysteresis)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], stay | enter, [False]]).astype(np.int8)))
    runs = zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
    return [(a, b) for a, b in runs if enter[a:b].any()]


def motions(demo: Demo, config: SegmentConfig) -> list[Motion]:
    """What moved when, pauses closed and nothing-came-of-it dropped, by start."""
    found = []
    for obj in demo.objects:
        T = demo.pose(obj)
        if not (
            np.linalg.norm(T.p - T.p[0], axis=-1).max() >= config.min_shift_m
            or rotation_distance(T, T[0]).max() >= config.min_turn_rad
        ):
            continue
        v, w = speeds(T, demo.times, config.filter_s)
        runs = intervals((v > config.enter_m_s) | (w > config.enter_rad_s), (v > config.leave_m_s) | (w > config.leave_rad_s))
        merged = _merged(demo, T, runs, config)
        for k, (a, fast) in enumerate(merged):
            b = _settled(demo, T, fast, merged[k + 1][0] if k + 1 < len(merged) else len(demo), config)
            before, after = _pose_over(T, max(a - 5, 0), max(a, 1)), _pose_over(T, min(b, len(demo) - 1), min(b + 5, len(demo)))
            shift = float(np.linalg.norm(after.p - before.p))
            if shift >= config.min_shift_m or float(rotation_distance(before, after)) >= config.min_turn_rad:
                start, stop = _bounds(T, a, b, before, after, config)
                found.append(Motion(obj, start, stop if b == fast else b))  # where it creeps on, `after` is not yet its rest
    return sorted(found, key=lambda m: (m.start, m.stop, m.obj))


def _merged(demo: Demo, T_world_obj: Pose, runs: list[tuple[int, int]], config: SegmentConfig) -> list[tuple[int, int]]:
    """Runs with the pauses between them closed, nudges before and after them left out."""
    chains: list[list[tuple[int, int]]] = []
    for a, b in runs:
        if chains and _pause(demo, T_world_obj, chains[-1][-1][1] - 1, a, config):
            chains[-1].append((a, b))
        else:
            chains.append([(a, b)])
    return [_without_nudges(T_world_obj, chain, config) for chain in chains]


def _without_nudges(T: Pose, chain: list[tuple[int, int]], config: SegmentConfig) -> tuple[int, int]:
    """From the first to the last run that brings the object anywhere; from end to end if none does by itself."""
    wide = [
        np.linalg.norm(T.p[b - 1] - T.p[a]) >= config.min_shift_m or rotation_distance(T[b - 1], T[a]) >= config.min_turn_rad
        for a, b in chain
    ]
    kept = [run for run, far in zip(chain, wide, strict=True) if far] or chain
    return kept[0][0], kept[-1][1]


def _pause(demo: Demo, T_world_obj: Pose, stop: int, start: int, config: SegmentConfig) -> bool:
    """Whether the gap between samples `stop` and `start` is a pause: short, or spent in contact."""
    if demo.times[start] - demo.times[stop] < config.merge_gap_s:
        return True
    gap = slice(stop, start + 1)
    T_obj_ee = T_world_obj[gap].inverse() @ demo.T_world_ee[gap]
    command = demo.gripper_closed[gap]
    return bool(
        np.all(command == command[0])
        and np.max(np.linalg.norm(T_obj_ee.p - T_obj_ee.p[0], axis=-1)) < config.held_m
        and np.max(rotation_distance(T_obj_ee, T_obj_ee[0])) < config.held_rad
    )


def _settled(demo: Demo, T_world_obj: Pose, stop: int, limit: int, config: SegmentConfig) -> int:
    """The end of a motion that dies away more slowly than the thresholds see, while the hand stays where it was on the object."""
    T_obj_ee = T_world_obj.inverse() @ demo.T_world_ee
    gone = np.linalg.norm(T_obj_ee.p[stop:limit] - T_obj_ee.p[stop - 1], axis=-1) > config.away_m
    gone |= demo.gripper_closed[stop:limit] != demo.gripper_closed[stop - 1]
    until = stop + int(np.argmax(gone)) if gone.any() else limit
    if until <= stop:
        return stop
    rest_pose = _pose_over(T_world_obj, max(until - 3, stop), until)
    T = T_world_obj[stop:until]
    still = (np.linalg.norm(T.p - rest_pose.p, axis=-1) < config.settle_m) & (rotation_distance(T, rest_pose) < config.settle_rad)
    return stop if still.all() else stop + int(np.flatnonzero(~still)[-1]) + 1


def _bounds(T: Pose, a: int, b: int, before: Pose, after: Pose, config: SegmentConfig) -> tuple[int, int]:
    """When an object that moves during samples [a, b) has left its old resting place for good, and has come to the new one.

    Speeds are filtered, so they rise before the object moves and fall after it has; where it is says it more exactly.
    """
    metres, radians = (least + 3.0 * jitter for least, jitter in zip((config.left_m, config.left_rad), jitters(T), strict=True))
    span = T[a:b]
    from_before = np.linalg.norm(span.p - before.p, axis=-1), rotation_distance(span, before)
    gone = (from_before[0] >= config.min_shift_m) | (from_before[1] >= config.min_turn_rad)
    home = (from_before[0] <= metres) & (from_before[1] <= radians)
    until = int(np.argmax(gone)) if gone.any() else len(span)
    left = np.flatnonzero(home[:until])
    start = a + (int(left[-1]) + 1 if len(left) else 0)
    away = (np.linalg.norm(span.p - after.p, axis=-1) > metres) | (rotation_distance(span, after) > radians)
    stop = a + int(np.flatnonzero(away)[-1]) + 1 if away.any() else b
    return (start, stop) if stop > start else (a, b)


def jitters(T: Pose) -> tuple[float, float]:
    """Standard deviation from sample to sample of a frame's poses (n,), position [m] and rotation [rad], per axis.

    From second differences, of which a motion shows little; robust, so that it needs rest in half of the recording only.
    """
    if len(T) < 3:
        return 0.0, 0.0
    turn = quat_log(quat_multiply(quat_conjugate(T.q[:-1]), T.q[1:]))
    scale = 0.6745 * np.sqrt(6.0)
    p = np.abs(np.diff(T.p, n=2, axis=0))
    return float(np.median(p) / scale), float(np.median(np.abs(np.diff(turn, axis=0))) / scale)


def _pose_over(T: Pose, start: int, stop: int) -> Pose:
    """Median position and mean orientation over samples [start, stop)."""
    return Pose(np.median(T.p[start:stop], axis=0), karcher_mean(T.q[start:stop]))


def rest(demo: Demo, obj: str, start: int, stop: int, *, static: bool = False) -> Rest:
    """The rest of an object over samples [start, stop)."""
    return Rest(obj, start, stop, _pose_over(demo.pose(obj), start, stop), static)


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
