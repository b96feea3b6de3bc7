"""What the segmentation finds: episodes, in which the hand comes, moves one object and leaves, and the rests between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symskill_pddl.demos import Demo
from symskill_pddl.geometry import Pose, karcher_mean

RestKey = tuple[str, str, int, int]
"""What tells one rest from every other: demonstration, object, first and last sample."""


@dataclass(frozen=True, eq=False)
class Rest:
    """Where an object rested: its pose over samples [start, stop), next to a motion, or (`static`) all through a demonstration.

    `where` is the demonstration's identifier; `parts` hang on the object: it does not rest at them. `held`: it is in the hand,
    when the recording ends or when what it is a part of begins to move with it.
    """

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
        """Its identity, the same in every process and for every copy."""
        return self.where, self.obj, self.start, self.stop


@dataclass(frozen=True, eq=False)
class Episode:
    """The hand comes, moves one object, and leaves. All times are sample indices into `demo`.

    Attributes
    ----------
    demo : Demo
    obj : str
        `o_int`, the object that the hand acts on.
    begin : int
        Where the hand has left what it moved before, and begins to come to this object.
    start, stop : int
        The object has left its resting place at `start` and has come to the next one at `stop`.
    leave : int or None
        The hand has let go (geometrically); None if the recording ends before.
    end : int
        End of the retreat.
    passengers : tuple of str
        Other objects that moved along.
    before, after : Rest or None
        Where the object rested. `before` is None if the recording begins with it in the hand, `after` if it ends so.
    body : str or None
        What the object is a part of and moved in the end, a latch's door; then `after` is the body's rest and `body_before` the
        one it had.
    body_before : Rest or None
    grasped : int or None
        When the fingers closed on the object, perhaps long before `start`; None if it is pushed.
    follows : float or None
        How far the object follows the hand across their common way: 1 if it is free, 0 if a joint guides it; None if the hand
        strayed too little to tell (`acts.follows`).
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
    grasped: int | None = None
    follows: float | None = None

    @property
    def held(self) -> bool:
        """Whether it is in the fingers while it moves; else it is pushed."""
        return self.grasped is not None

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
    """The rest of an object over samples [start, stop), from those at which it is seen."""
    seen = np.flatnonzero(demo.sees(obj)[start:stop]) + start
    T = demo.pose(obj)[seen if len(seen) else slice(start, stop)]
    return Rest(demo.where, obj, start, stop, Pose(np.median(T.p, axis=0), karcher_mean(T.q)), static)
