"""Plans without detours, and what is left of a plan from another state. Facts are bits, states integers.

Greedy action elimination (Nakhost and Mueller, ICAPS 2010): each step in turn is left out, together with every later step that is
then not applicable; where the rest still reaches the goal, it stays out. Beyond that, a later step that is not applicable any
more may be replaced by another that adds the same: what was carried to a place on the way is then fetched where it lay.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Generic, TypeVar

_MOST = 200_000
"""Steps looked at, in all that is tried for one plan: the same on every machine."""
_LONGEST = 100
"""Steps of the longest detour that is looked for."""
_VAIN = 3
"""Steps that cannot be replaced, after which no further one of the same try is."""
Of = TypeVar("Of")


@dataclass(frozen=True, slots=True)
class Move(Generic[Of]):
    """A ground operator over bits, and what it stands for."""

    pre: int
    absent: int
    delete: int
    add: int
    cost: float
    of: Of

    def applicable(self, state: int) -> bool:
        return self.pre & state == self.pre and not self.absent & state

    def apply(self, state: int) -> int:
        return state & ~self.delete | self.add


Replacement = Callable[[int, int], "Move[Of] | None"]
"""A move that adds all of some facts (first) and is applicable in a state (second), if there is one."""


def without_detours(plan: Sequence[Move[Of]], init: int, goal: int, other: Replacement[Of] | None = None) -> tuple[Move[Of], ...]:
    """The plan, or a cheaper one that reaches the goal too; of equal cost a shorter one.

    Parameters
    ----------
    init, goal : int
        The plan leads from one to the other.
    other : callable, optional
        What may be done in place of a step that is not applicable any more.
    """
    attempt, number, looked = _Attempt(list(plan), init, goal, other), 0, 0
    while number < len(attempt.moves) and looked < _MOST:
        rest, count = attempt.without(number)
        looked += count
        if rest is None:
            number += 1
        else:
            attempt = _Attempt([*attempt.moves[:number], *rest], init, goal, other)
    return tuple(attempt.moves)


class _Attempt(Generic[Of]):
    """A plan, its states, and what of the goal is still added from each step on."""

    def __init__(self, moves: list[Move[Of]], init: int, goal: int, other: Replacement[Of] | None) -> None:
        self.moves, self._goal, self._other = moves, goal, other
        self._states = list(accumulate(moves, lambda state, move: move.apply(state), initial=init))
        self._added = list(accumulate((m.add & goal for m in reversed(moves)), lambda a, b: a | b, initial=0))[::-1]

    def without(self, number: int) -> tuple[list[Move[Of]] | None, int]:
        """What can follow on the moves before `number` when that one is left out, if it is less; and how many were looked at."""
        moves, states, goal = self.moves, self._states, self._goal
        state = states[number]
        rest: list[Move[Of]] = []
        cost, count, vain = moves[number].cost, 1, 0  # cost and steps saved so far
        for i in range(number + 1, len(moves)):
            if state == states[i]:
                return ([*rest, *moves[i:]] if (cost, count) > (0.0, 0) else None), i - number
            if goal & ~(state | self._added[i]):
                return None, i - number  # nothing adds it any more
            move = moves[i]
            if not move.applicable(state):
                gives = move.add & ~states[i]
                instead = self._other(gives, state) if self._other is not None and gives and vain < _VAIN else None
                cost, count = cost + move.cost, count + 1
                if instead is None:
                    vain += 1
                    if count > _LONGEST:
                        return None, i - number
                    continue
                cost, count, move = cost - instead.cost, count - 1, instead
            state = move.apply(state)
            rest.append(move)
        better = goal & state == goal and (cost, count) > (0.0, 0)
        return (rest if better else None), len(moves) - number


def rest_of(plan: Sequence[Move[Of]], state: int, goal: int) -> tuple[Move[Of], ...] | None:
    """What is left of a plan in a state that may be another than it was made for; None where that does not reach the goal.

    The shortest of its last stretches that is a plan from here, or else all of its moves in turn that are applicable.
    """
    needs, against = goal, 0
    for i in range(len(plan), -1, -1):
        if needs & state == needs and not against & state:
            return tuple(plan[i:])
        move = plan[i - 1]
        if i == 0 or needs & move.delete & ~move.add or against & move.add:
            break
        needs, against = needs & ~move.add | move.pre, against & ~move.delete | move.absent
    left = []
    for move in plan:
        if move.applicable(state):
            state = move.apply(state)
            left.append(move)
    return tuple(left) if goal & state == goal else None
