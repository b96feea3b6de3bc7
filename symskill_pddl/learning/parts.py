"""What one episode shows in two steps, and what it leaves in the hand.

A latch turns in the door's frame, then the door turns with it. The hand acts on the latch all the time, but its turn is a state
of its own, which opening requires: such an episode becomes two, and the second goes on with what the first has hold of.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from symskill_pddl.geometry import rotation_distance
from symskill_pddl.learning.segments import Episode, rest

MOVED = 0.06
"""A body has moved when it is this far from where it rested, in openings of the hand, or turned by as many radians."""


def stepwise(episodes: Iterable[Episode]) -> tuple[Episode, ...]:
    """The episodes, those that move a body by a part of it in two steps, and those that end early with where they do."""
    return tuple(step for e in episodes for step in map(_ended, _steps(e)))


def continues(e: Episode) -> bool:
    """Whether the hand has hold of the object already when the episode begins."""
    return e.begin >= e.start


def _steps(e: Episode) -> Iterator[Episode]:
    if e.body is None or e.body_before is None or e.before is None:
        yield e
        return
    T, at = e.demo.pose(e.body)[e.start : e.stop], e.body_before.T_world_obj
    away = np.linalg.norm(T.p - at.p, axis=-1) > MOVED * e.demo.aperture.max()
    moving = np.flatnonzero(away | (rotation_distance(T, at) > MOVED))
    middle = e.start + int(moving[0]) if len(moving) else e.start
    if middle - e.start < 2:
        yield e
        return
    turned = replace(rest(e.demo, e.obj, max(middle - 3, e.start), middle), held=True)
    along = tuple(p for p in e.passengers if p != e.body)
    yield replace(e, stop=middle, leave=None, end=middle, passengers=along, after=turned, body=None, body_before=None)
    yield replace(e, begin=middle, start=middle, before=turned)


def _ended(e: Episode) -> Episode:
    """With where the recording leaves the object: in the hand, or where the fingers have let go of it and it hardly moves."""
    if e.before is None or e.after is not None or not e.held:
        return e
    last, closed = len(e.demo), bool(e.demo.gripper_closed[-1])
    at = rest(e.demo, e.moved, max(last - 3, e.start), last)
    moves = float(np.ptp(e.demo.pose(e.moved).p[at.start : last], axis=0).max()) > MOVED * e.demo.aperture.max()
    return e if moves and not closed else replace(e, after=replace(at, held=closed))
