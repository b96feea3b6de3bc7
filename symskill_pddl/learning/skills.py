"""Demonstrated end-effector paths of an operator into a skill: fields per stretch of one finger command.

Pick: the approach from t_0 to contact, in the moved object's frame. Place: the motion from first to last movement of the
object, in the reference's frame, then the retreat in the object's frame. Within each part the path is cut where the finger
command changes; stretches in which the hand hardly moves (it waits for the fingers) disappear, and what remains of the commands
says what the fingers do at the end.

People's detours are taken out: if most demonstrations come closer to the end all the time, loops in the others (a second
approach, a regrasp) are cut off. Retreats are cut to a common length, since hands wander off to different places.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

from symskill_pddl.errors import CertificateError, LearningError
from symskill_pddl.geometry import Pose, karcher_mean, rotation_distance
from symskill_pddl.learning.operators import OperatorGroup
from symskill_pddl.learning.transitions import Transition
from symskill_pddl.skills import FitConfig, Phase, Skill, Trajectory, fit_phases


@dataclass(frozen=True)
class SkillConfig:
    """How closely skills follow what was shown, how fast, and for which control periods."""

    tolerance_m: float = 0.004
    """Skills follow the shown way within this, beyond the demonstrations' own spread; ends, waits and via points follow."""
    tolerance_rad: float = float(np.radians(5.0))
    """As `tolerance_m`, for turning."""
    max_fields: int = 10
    """A long way is cut into at most so many fields in sequence."""
    pace: float = 1.2
    """Largest speed, as a multiple of the speed that was shown."""
    period_s: float = 0.1
    """Skills are stable at control periods up to this."""

    def fit(self) -> FitConfig:
        """The settings of a motion field."""
        return FitConfig(
            period_s=self.period_s,
            pace=self.pace,
            tolerance_m=self.tolerance_m,
            tolerance_rad=self.tolerance_rad,
            via_tolerance_m=2.5 * self.tolerance_m,
            via_tolerance_rad=1.2 * self.tolerance_rad,
            max_fields=self.max_fields,
        )


_WAIT = (3.0, 1.6)
"""A stretch in which the hand moves less than these multiples of the tolerances is a wait for the fingers."""
_ENDS = {"approach": ((1.0, 2.0), (0.6, 1.2)), "motion": ((1.5, 3.0), (0.6, 1.4)), "retreat": ((5.0, 10.0), (1.6, 3.0))}
"""Bounds of how exactly each part ends, in tolerances of position and turning. Within them it follows the spread of the shown
ends: fingers have a centimetre to spare, what is put down may lie a centimetre aside, a retreat has only to be clear."""
_DETOUR, _JOIN = 0.4, 0.75
"""In openings of the hand: going away from the end by more than this is a detour, unless most demonstrations do; a loop is cut
out where its ends are this near to each other, else the path begins after it."""
_RETREAT_QUANTILE = 0.25
"""Hands wander off to different places: retreats are cut at this quantile of the distances they reach."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """A piece of one demonstration under one finger command: 'approach', 'motion' or 'retreat'."""

    part: str
    closed: bool
    path: Trajectory


def learn_skill(group: OperatorGroup, config: SkillConfig | None = None) -> tuple[Skill, tuple[str, ...]]:
    """The skill of an operator, and notes on demonstrations that were left out of it.

    Raises
    ------
    LearningError
        If the hand does not move in the demonstrations, or no stable field fits them; the message names the operator.
    """
    config = config or SkillConfig()
    name = group.learned.operator.name
    shown = [_stretches(t, config) for t in group.transitions]
    patterns = [(tuple((s.part, s.closed) for s in stretches), end) for stretches, end in shown]
    counts = Counter(patterns)
    pattern = max(sorted(counts, key=str), key=lambda p: counts[p])
    notes = tuple(
        f"{t.demo.where}: the fingers do something else than in most demonstrations; left out of the skill"
        for t, p in zip(group.transitions, patterns, strict=True)
        if p != pattern
    )
    if not pattern[0]:
        raise LearningError(f"operator '{name}': the hand does not move in its demonstrations, there is no skill to learn")
    fitting = [stretches for (stretches, _), p in zip(shown, patterns, strict=True) if p == pattern]
    parameters = group.learned.operator.parameters
    opening = max(float(np.quantile(t.demo.aperture, 0.99)) for t in group.transitions)
    phases: list[Phase] = []
    for k, (part, closed) in enumerate(pattern[0]):
        paths = [stretches[k].path for stretches in fitting]
        paths = _common_length(paths) if part == "retreat" else _direct(paths, opening)
        frame = parameters[1] if part == "motion" and len(parameters) > 1 else parameters[0]
        tolerance_p, tolerance_r = _tolerances(paths, part, config)
        # an approach may set out from anywhere; with something in the hand, or from it, the hand starts where it was shown
        fit = config.fit() if part == "approach" else replace(config.fit(), max_stray_m=np.inf)
        try:
            with threadpool_limits(1):
                phases += fit_phases(paths, frame.name, closed, tolerance_p, tolerance_r, fit)
        except CertificateError as error:
            raise CertificateError(f"operator '{name}', {part}: {error}") from error
    return Skill(tuple(phases), pattern[1]), notes


def _stretches(t: Transition, config: SkillConfig) -> tuple[tuple[Stretch, ...], bool]:
    """The stretches of one demonstration, and the finger command after the last one."""
    e = t.label.episode
    command = e.demo.gripper_closed
    found: list[Stretch] = []
    if not t.moves:
        found += _runs("approach", t.begin, e.start, _approached(t).inverse() @ e.demo.T_world_ee, t, config)
        return tuple(found), bool(command[t.end])
    reference = _reference(t)
    still = _pressed(t)
    found += _runs("motion", e.start, still, reference.inverse() @ e.demo.T_world_ee, t, config)
    rest = e.after.T_world_obj if e.after is not None else e.demo.pose(e.obj)[still]
    last = min(max(e.end, t.end), len(e.demo) - 1)
    found += _runs("retreat", still, last, rest.inverse() @ e.demo.T_world_ee, t, config)
    return tuple(found), bool(command[last])


def _pressed(t: Transition) -> int:
    """Where a motion of the hand ends: at the first sample at rest; a sample earlier what is put down is still above its place.

    A hand that pushes goes on until it is as far as it gets, before it leaves: it presses a door into its frame.
    """
    e = t.label.episode
    still, until = min(e.stop, len(e.demo) - 1), min(e.leave or e.end, len(e.demo) - 1)
    p = e.demo.T_world_ee.p
    ahead = p[still] - p[max(still - 2, 0)]
    if e.held or until <= still or not ahead.any():
        return still
    return still + int(np.argmax((p[still : until + 1] - p[still]) @ ahead))


def _approached(t: Transition) -> Pose:
    """`T_world_obj` (n,) that an approach is seen from: where the object rests, until the fingers close on it for the last time.

    From then on it is the object itself: a hand that lifts it a little before it counts as moved does not approach any more.
    """
    e, T = t.label.episode, t.demo.pose(t.label.episode.obj)
    rest = e.before.T_world_obj if e.before is not None else T[e.start]
    closes = np.flatnonzero(np.diff(t.demo.gripper_closed[t.begin : e.start + 1].astype(np.int8)) > 0)
    seen = Pose.stack([rest] * len(t.demo))
    if not len(closes) or not t.demo.gripper_closed[e.start]:
        return seen
    first = t.begin + 1 + int(closes[-1])
    return Pose(np.concatenate([seen.p[:first], T.p[first:]]), np.concatenate([seen.q[:first], T.q[first:]]))


def _reference(t: Transition) -> Pose:
    """`T_world_ref` (n,): constant where the reference stands still during the motion, so that its noise does not enter."""
    e, ref = t.label.episode, t.label.ref
    if ref is None:
        return Pose.stack([Pose.identity()] * len(e.demo))
    T = e.demo.pose(ref)
    span = T[e.start : e.stop]
    mean = Pose(np.median(span.p, axis=0), karcher_mean(span.q))
    moved = np.linalg.norm(span.p - mean.p, axis=-1).max() > 0.01 or rotation_distance(span, mean).max() > np.radians(5.0)
    return T if moved else Pose.stack([mean] * len(e.demo))


def _runs(part: str, first: int, last: int, T_frame_ee: Pose, t: Transition, config: SkillConfig) -> list[Stretch]:
    """Samples [first, last] cut at changes of the finger command, waits left out."""
    command = t.demo.gripper_closed[first : last + 1]
    cuts = [first, *(first + 1 + np.flatnonzero(np.diff(command.astype(np.int8)))).tolist(), last + 1]
    found: list[Stretch] = []
    for a, b in pairwise(cuts):
        T = T_frame_ee[a:b]
        far = np.linalg.norm(T.p - T.p[0], axis=-1).max() > _WAIT[0] * config.tolerance_m
        turned = rotation_distance(T, T[0]).max() > _WAIT[1] * config.tolerance_rad
        if not (far or turned):
            continue
        stretch = Stretch(part, bool(t.demo.gripper_closed[a]), Trajectory(t.demo.times[a:b], T))
        if found and found[-1].closed == stretch.closed:  # only a wait lay between them
            joined = (found[-1].path, stretch.path)
            path = Trajectory(
                np.concatenate([p.times for p in joined]),
                Pose(np.concatenate([p.T_frame_ee.p for p in joined]), np.concatenate([p.T_frame_ee.q for p in joined])),
            )
            found[-1] = Stretch(part, stretch.closed, path)
        else:
            found.append(stretch)
    return found


def _direct(paths: Sequence[Trajectory], opening_m: float) -> list[Trajectory]:
    """Loops cut out of the paths that have one, if most have none."""
    kept = [_progressing(p, _DETOUR * opening_m) for p in paths]
    looping = [not mask.all() for mask in kept]
    if sum(looping) * 2 > len(paths):
        return list(paths)
    return [
        _without_loops(p, mask, _JOIN * opening_m) if loops else p for p, mask, loops in zip(paths, kept, looping, strict=True)
    ]


def _progressing(path: Trajectory, slack_m: float) -> NDArray[np.bool_]:
    """Samples that are not nearer to the end than any later one is (with slack): what is left of a path without its loops."""
    distance = np.linalg.norm(path.T_frame_ee.p - path.T_frame_ee.p[-1], axis=-1)
    later = np.maximum.accumulate(distance[::-1])[::-1]
    if np.all(distance >= later - slack_m):
        return np.ones(len(path), dtype=bool)
    return np.asarray(distance >= later - 0.003)


def _without_loops(path: Trajectory, mask: NDArray[np.bool_], join_m: float) -> Trajectory:
    index = np.flatnonzero(mask)
    jumps = np.linalg.norm(np.diff(path.T_frame_ee.p[index], axis=0), axis=-1)
    wide = np.flatnonzero(jumps > join_m)
    if len(wide):
        index = index[wide[-1] + 1 :]
    steps = np.diff(path.times)
    usual = float(np.median(steps))
    times = np.concatenate([[0.0], np.cumsum(np.where(np.diff(index) > 1, usual, np.diff(path.times[index])))])
    return Trajectory(times, path.T_frame_ee[index])


def _common_length(paths: Sequence[Trajectory]) -> list[Trajectory]:
    """Every path cut where it is as far from its start as a short one among them gets."""
    distances = [np.linalg.norm(p.T_frame_ee.p - p.T_frame_ee.p[0], axis=-1) for p in paths]
    reach = float(np.quantile([d.max() for d in distances], _RETREAT_QUANTILE))
    out = []
    for path, distance in zip(paths, distances, strict=True):
        beyond = np.flatnonzero(distance >= reach - 1e-9)
        out.append(path.cut(0, max(int(beyond[0]), 1)) if len(beyond) else path)
    return out


def _tolerances(paths: Sequence[Trajectory], part: str, config: SkillConfig) -> tuple[float, float]:
    """Spread of the ends, within the part's bounds [m], [rad]."""
    ends = Pose.stack([p.end for p in paths])
    spread_p = float(np.sqrt(ends.p.var(axis=0).sum()))
    mean = Pose(ends.p.mean(axis=0), karcher_mean(ends.q))
    spread_r = float(np.sqrt(np.mean(rotation_distance(ends, mean) ** 2)))
    bounds = [config.tolerance_m * np.array(_ENDS[part][0]), config.tolerance_rad * np.array(_ENDS[part][1])]
    # one demonstration says nothing about the spread: the upper bound; many take it down
    least_p, least_r = (high / len(paths) for _, high in bounds)
    return float(np.clip(max(spread_p, least_p), *bounds[0])), float(np.clip(max(spread_r, least_r), *bounds[1]))
