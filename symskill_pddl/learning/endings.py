"""What a segment alone does not show: recordings that end early, and parts that move the body they hang on.

People stop recording when the task is done, often a moment too soon for a rest window or a retreat. Where a thing rests can still
be said if the fingers let go of it and it lay still for a moment, or if it is hinged or slides and so stays where it was left. A
thing that is in the air when the recording ends rests nowhere.

A latch turns in the door's frame, then the door turns with it: the hand acts on the latch all the time, but what it brings
somewhere is the door. Of such an episode the latch is `obj` and the door `body`. An ordinary passenger (food in a drawer) moves
with its carrier from the first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from symskill_pddl.geometry import Pose, rotation_distance
from symskill_pddl.learning.articulation import ArticulationConfig, fit_joint
from symskill_pddl.learning.motions import Mask, SegmentConfig
from symskill_pddl.learning.segments import Episode, Rest, rest


@dataclass(frozen=True)
class EndingConfig:
    """When a thing counts as left where it is."""

    final_rest_s: float = 0.2
    """A released thing that lies still for this long when the recording ends rests there."""
    articulation: ArticulationConfig = field(default_factory=ArticulationConfig)


def complete(
    episodes: Sequence[Episode], config: EndingConfig | None = None, segments: SegmentConfig | None = None
) -> tuple[Episode, ...]:
    """The episodes with their bodies, and with the rests that their recordings just about show."""
    config, segments = config or EndingConfig(), segments or SegmentConfig()
    return tuple(_ended(_with_body(e, config, segments), config, segments) for e in episodes)


def _with_body(e: Episode, config: EndingConfig, segments: SegmentConfig) -> Episode:
    for name in e.passengers:
        T_world_body = e.demo.pose(name)[e.start : e.stop]
        T_body_obj = T_world_body.inverse() @ e.demo.pose(e.obj)[e.start : e.stop]
        away = np.flatnonzero(_off(T_world_body, T_world_body[0], segments.settle_m, segments.settle_rad))
        if not len(away) or not _off(T_body_obj[: away[0]], T_body_obj[0], segments.min_shift_m, segments.min_turn_rad).any():
            continue  # the object did not move on its own before
        hung = fit_joint([T_body_obj], config.articulation) and fit_joint([T_world_body[away[0] :]], config.articulation)
        if hung:
            before, after = (
                None if r is None else replace(rest(e.demo, name, r.start, r.stop), parts=(e.obj,)) for r in (e.before, e.after)
            )
            return replace(e, body=name, body_before=before, after=after)
    return e


def _ended(e: Episode, config: EndingConfig, segments: SegmentConfig) -> Episode:
    if e.after is not None or e.leave is not None:
        return e
    parts = (e.obj,) if e.body is not None else ()
    T, n, command = e.demo.pose(e.moved), len(e.demo), e.demo.gripper_closed
    if not command[-1] and command[e.start :].any():
        released = e.start + int(np.flatnonzero(command[e.start :])[-1]) + 1
        moving = np.flatnonzero(_off(T[released:], T[n - 1], segments.settle_m, segments.settle_rad))
        still = released + (int(moving[-1]) + 1 if len(moving) else 0)
        if e.demo.times[-1] - e.demo.times[still] >= config.final_rest_s - 1e-9:
            return replace(e, stop=still, end=n - 1, after=replace(rest(e.demo, e.moved, still, n), parts=parts))
    joint = fit_joint([e.moved_along()], config.articulation)
    if joint is not None and (joint.kind == "hinge" or not command[-1]):
        return replace(e, end=n - 1, after=Rest(e.demo.where, e.moved, n - 1, n, T[n - 1], parts=parts))
    return e


def _off(T: Pose, T_at: Pose, metres: float, radians: float) -> Mask:
    return np.asarray((np.linalg.norm(T.p - T_at.p, axis=-1) > metres) | (rotation_distance(T, T_at) > radians))
