"""What moved when: runs of motion in an unsegmented recording, without pauses and nudges.

Velocities come from a Savitzky-Golay filter (local quadratic over `filter_s`; positions, and quaternions made sign-continuous).
An object moves from the moment its linear *or* angular speed exceeds the entering threshold until *both* are below the leaving
ones.

People hesitate, try again and bump into things. What keeps that out:

- a gap in an object's motion is closed if it is shorter than `merge_gap_s`, or if the gripper stayed where it was on the object
  and kept its command (a pause in mid-carry or mid-push);
- a motion after which the object rests where it was (1 cm, 5 degrees) is dropped: nudges, grasps that slipped.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from symskill_pddl.demos import Demo
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
            before, after = pose_over(T, max(a - 5, 0), max(a, 1)), pose_over(T, min(b, len(demo) - 1), min(b + 5, len(demo)))
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
    rest_pose = pose_over(T_world_obj, max(until - 3, stop), until)
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


def pose_over(T: Pose, start: int, stop: int) -> Pose:
    """Median position and mean orientation over samples [start, stop)."""
    return Pose(np.median(T.p[start:stop], axis=0), karcher_mean(T.q[start:stop]))
