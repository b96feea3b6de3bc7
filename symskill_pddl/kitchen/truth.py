"""What really happens in an episode, from the simulator's own state: who was moved by the hand, when, and what lies where.

For scores only. Contacts say what the hand moves and what an object rests on, unfiltered poses say when; nothing of this is in
the scenes that learning gets.
"""

from __future__ import annotations

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.demos.truth import Move, Relation, Truth
from symskill_pddl.geometry import Pose, rotation_distance
from symskill_pddl.kitchen.physics import ROBOT
from symskill_pddl.kitchen.world import Kitchen
from symskill_pddl.scene import Scene

STILL_M, STILL_RAD = 0.0002, float(np.radians(0.1))
"""What differs by less than this from one sample to the next is at rest (4 mm/s, 2 deg/s at 20 Hz)."""
LEFT_M, LEFT_RAD = 0.002, float(np.radians(1.0))
"""An object has left its resting place once it is farther from it than this, and has come to one from when on it is not."""
MOVE_M, MOVE_RAD = 0.01, float(np.radians(5.0))
"""Less than this is no move: a nudge, a grasp that slipped."""
GAP_S = 0.25
"""Rests shorter than this, or with the hand on the object and its fingers as they were, are pauses of one move."""
REST_S = 0.5
"""What an object lay on most over this long before or after a move is what it rested at."""

Mask = NDArray[np.bool_]


class TruthLog:
    """Watches an episode from now on; `truth()` says what has happened."""

    def __init__(self, kitchen: Kitchen) -> None:
        self._physics, self._period_s = kitchen.physics, kitchen.period_s
        self._parts = kitchen.physics.scene.parts
        self._scenes: list[Scene] = []
        self._contacts: list[frozenset[tuple[str, str]]] = []
        self._positions: list[dict[str, float]] = []
        kitchen.watchers.append(self._look)
        self._look(kitchen.observe())

    def _look(self, scene: Scene) -> None:
        self._scenes.append(scene)
        self._contacts.append(self._physics.contacts())
        self._positions.append({part: self._physics.position(part) for part in self._physics.scene.parts})

    def truth(self) -> Truth:
        """Moves and relations so far, on a clock that starts with the first scene."""
        loose, parts = self._physics.loose, self._physics.scene.parts
        moves = [move for obj in (*parts, *loose) for move in self._moves(obj)]
        relations: dict[Relation, Mask] = {}
        for name, part in parts.items():
            positions = np.array([p[name] for p in self._positions])
            relations["open", name, part.unit] = positions >= part.opened
            relations["shut", name, part.unit] = positions <= part.shut
        for obj in loose:
            for ref in sorted({ref for k in range(len(self._scenes)) for ref in self._under(obj, k)}):
                relations["at", obj, ref] = np.array([ref in self._under(obj, k) for k in range(len(self._scenes))])
        return Truth(tuple(sorted(moves, key=lambda move: (move.start_s, move.obj))), relations)

    def _under(self, obj: str, k: int) -> list[str]:
        """What the object touches and lies on or in: everything but the robot, and of other loose objects the lower ones."""
        near = [b if a == obj else a for a, b in self._contacts[k] if obj in (a, b)]
        height = self._scenes[k].pose(obj).p[2]
        loose = self._physics.loose
        return [o for o in near if o != ROBOT and (o not in loose or self._scenes[k].pose(o).p[2] < height)]

    def _moves(self, obj: str) -> list[Move]:
        T = Pose.stack([scene.pose(obj) for scene in self._scenes])
        moving = _differs(T[1:], T[:-1], STILL_M, STILL_RAD)
        touched = np.array([(obj, ROBOT) in pairs or (ROBOT, obj) in pairs for pairs in self._contacts])
        found = []
        for a, b in self._runs(T, np.concatenate([[False], moving]), touched):
            # a: still at the old place; b: at the new one already
            far = np.flatnonzero(_differs(T[a : b + 1], T[a], MOVE_M, MOVE_RAD))
            if not _differs(T[b], T[a], MOVE_M, MOVE_RAD) or not touched[a : b + 1].any() or not len(far):
                continue
            home = np.flatnonzero(~_differs(T[a : a + far[0] + 1], T[a], LEFT_M, LEFT_RAD))
            start = a + int(home[-1]) + 1
            away = np.flatnonzero(_differs(T[start : b + 1], T[b], LEFT_M, LEFT_RAD))
            stop = start + (int(away[-1]) + 1 if len(away) else 0)
            ends = b < len(T) - 1
            found.append(
                Move(
                    obj,
                    self._clock(start),
                    self._clock(stop),
                    self._rested_at(obj, a, -1),
                    self._rested_at(obj, b, 1) if ends else None,
                    self._state(obj, a),
                    self._state(obj, b),
                )
            )
        return found

    def _runs(self, T: Pose, moving: Mask, touched: Mask) -> list[tuple[int, int]]:
        """(last sample before, first sample after) of each move, pauses closed."""
        edges = np.flatnonzero(np.diff(np.concatenate([[False], moving, [False]]).astype(np.int8))).tolist()
        closed = np.array([scene.gripper_closed for scene in self._scenes])
        chains: list[list[tuple[int, int]]] = []
        for a, b in zip(edges[::2], edges[1::2], strict=True):
            run = a - 1, min(b, len(moving) - 1)
            last = chains[-1][-1][1] if chains else -len(moving)
            held = last >= 0 and touched[last:a].all() and len(set(closed[last : a + 1].tolist())) == 1
            if held or (a - last) * self._period_s < GAP_S:
                chains[-1].append(run)
            else:
                chains.append([run])
        found = []
        for chain in chains:  # a nudge before or after a move is none of it
            kept = [(a, b) for a, b in chain if _differs(T[b], T[a], MOVE_M, MOVE_RAD)] or chain
            found.append((kept[0][0], kept[-1][1]))
        return found

    def _rested_at(self, obj: str, k: int, way: int) -> str | None:
        if obj in self._parts:
            return self._parts[obj].unit
        # a hand that closes on an object may lift it a little before it moves it
        step, n = round(REST_S / self._period_s), len(self._scenes)
        lies = next((i for i in range(k, n if way > 0 else -1, way) if self._under(obj, i)), k)
        span = range(max(min(lies, lies + way * step), 0), min(max(lies, lies + way * step) + 1, n))
        counts = Counter(ref for i in span for ref in self._under(obj, i))
        return max(sorted(counts), key=lambda ref: counts[ref], default=None)

    def _state(self, obj: str, k: int) -> str:
        if obj not in self._parts:
            return ""
        part, position = self._parts[obj], self._positions[k][obj]
        return "open" if position >= part.opened else "shut" if position <= part.shut else "between"

    def _clock(self, k: int) -> float:
        return round(self._scenes[k].time - self._scenes[0].time, 6)


def _differs(a: Pose, b: Pose, metres: float, radians: float) -> Mask:
    return np.asarray((np.linalg.norm(a.p - b.p, axis=-1) > metres) | (rotation_distance(a, b) > radians))
