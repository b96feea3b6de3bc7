"""The order of a plan's steps: what has been begun is finished before anything else is begun.

A planner cares for costs, and to it all orders of the same steps cost the same. To a robot they do not: a door that is left half
open while the pans are filled hangs in the arm's way, though no atom says so.
"""

from __future__ import annotations

from symskill_pddl.symbols import GroundOperator, State

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
    tries = 0
    earlier = [frozenset(i for i in range(j) if _bound(steps[i], steps[j])) for j in range(len(steps))]

    def rest(left: tuple[int, ...], now: State, used: frozenset[str]) -> list[int] | None:
        nonlocal tries
        if not left:
            return [] if goal <= now else None
        choices = [i for i in left if earlier[i].isdisjoint(left) and steps[i].applicable(now)]
        for i in sorted(choices, key=lambda i: (-_share(steps[i], used), i)):
            tries += 1
            if tries > _MOST_TRIES:
                return None
            step = steps[i]
            found = rest(tuple(j for j in left if j != i), step.apply(now), used.union(step.args))
            if found is not None:
                return [i, *found]
        return None

    order = rest(tuple(range(len(steps))), state, begun)
    return steps if order is None else tuple(steps[i] for i in order)


def _bound(first: GroundOperator, then: GroundOperator) -> bool:
    """Whether one changes an atom of an object that the other needs or changes."""
    changed_first, changed_then = first.add | first.delete, then.add | then.delete
    needed_first, needed_then = first.pre | first.absent, then.pre | then.absent
    common = (changed_first & (needed_then | changed_then)) | (needed_first & changed_then)
    return any(atom.args for atom in common)


def _share(step: GroundOperator, used: frozenset[str]) -> float:
    """How many of the step's objects are among those used, from 0 to 1."""
    return sum(name in used for name in step.args) / max(1, len(step.args))
