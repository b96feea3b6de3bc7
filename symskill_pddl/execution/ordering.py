"""The order of a plan's steps: what has been begun is finished before anything else is begun.

A planner cares for costs, and to it all orders of the same steps cost the same. To a robot they do not: a door that is left half
open while the pans are filled hangs in the arm's way, though no atom says so.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from symskill_pddl.symbols import Atom, GroundOperator, State

_MOST_TRIES = 2_000


def one_by_one(
    steps: tuple[GroundOperator, ...], state: State, goal: State, begun: frozenset[str] = frozenset()
) -> tuple[GroundOperator, ...]:
    """The same steps, each time the one most of whose objects were used before; where several are equal, the plan's first.

    Steps that have to do with the same atom of an object keep the plan's order; what has no object, as the hand that has to be
    free, decides only whether a step can be next. The order can be carried out from `state` and reaches the goal, as the plan
    does. When none is found within some thousand tries, the plan stays as it is.

    Parameters
    ----------
    steps : tuple of GroundOperator
        A plan, in an order that works.
    state, goal : State
        Atoms it starts from, and reaches.
    begun : frozenset of str
        Objects that were used before the plan.
    """
    later = _later(steps)
    waiting = [0] * len(steps)
    for i in (i for after in later for i in after):
        waiting[i] += 1

    def choices(ready: frozenset[int], now: State, used: frozenset[str]) -> Iterator[int]:
        able = [i for i in ready if steps[i].applicable(now)]
        return iter(sorted(able, key=lambda i: (-_share(steps[i], used), i)))

    ready = frozenset(i for i, count in enumerate(waiting) if not count)
    order: list[int] = []
    ways = [(choices(ready, state, begun), ready, state, begun)]
    for _ in range(max(_MOST_TRIES, 4 * len(steps))):
        following, ready, now, used = ways[-1]
        if len(order) == len(steps) and goal <= now:
            return tuple(steps[i] for i in order)
        if (best := next(following, None)) is None:
            ways.pop()
            if not ways:
                break
            for i in later[order.pop()]:
                waiting[i] += 1
            continue
        order.append(best)
        for i in later[best]:
            waiting[i] -= 1
        ready = ready - {best} | {i for i in later[best] if not waiting[i]}
        now, used = steps[best].apply(now), used.union(steps[best].args)
        ways.append((choices(ready, now, used), ready, now, used))
    return steps


def _later(steps: Sequence[GroundOperator]) -> list[set[int]]:
    """For each step those that have to stay behind it, as far as no step between them says so already.

    One of two steps changes an atom of an object that the other needs or changes.
    """
    later: list[set[int]] = [set() for _ in steps]
    changed: dict[Atom, int] = {}
    needed: dict[Atom, list[int]] = {}
    for j, step in enumerate(steps):
        changes = step.add | step.delete
        for atom in ((step.pre | step.absent) - changes) | changes:
            if not atom.args:
                continue
            if atom in changed:
                later[changed[atom]].add(j)
            if atom in changes:
                for i in needed.pop(atom, ()):
                    later[i].add(j)
                changed[atom] = j
            else:
                needed.setdefault(atom, []).append(j)
    return later


def _share(step: GroundOperator, used: frozenset[str]) -> float:
    """How many of the step's objects are among those used, from 0 to 1."""
    return sum(name in used for name in step.args) / max(1, len(step.args))
