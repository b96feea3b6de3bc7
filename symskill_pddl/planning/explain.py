"""Why a goal cannot be reached, in words, by delete relaxation; and which part of it can. See also `conflicts`.

Nothing here looks at the clock: what may be looked at is counted, so that the same is said on every machine, however busy.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

from symskill_pddl.planning.conflicts import Pairs, forbidden
from symskill_pddl.planning.grounding import Grounding, TooLargeError, reachable
from symskill_pddl.planning.search import can_reach
from symskill_pddl.planning.unreachable import Unreachable
from symskill_pddl.symbols import Atom, Domain, GroundOperator, Problem

_TOO_LARGE = "the problem is too large to be explained"


@dataclass(frozen=True)
class Effort:
    """What an explanation may look at; a second or two of each."""

    ground_operators: int = 50_000
    matches: int = 1_000_000
    """Facts and objects tried for them."""
    facts: int = 10_000_000
    """Reached facts, for steps that are nearly applicable."""
    pairs: int = 5_000_000
    """Steps, atoms and pairs of atoms, for those that exclude one another."""
    searched: int = 800_000
    """States expanded times ground operators, for the part of the goal that can be reached, in all searches."""


def explain(domain: Domain, problem: Problem, effort: Effort = Effort()) -> tuple[str, ...]:
    """One or more lines for each goal atom that stands in the way; empty where the relaxation finds nothing wrong.

    The relaxation never deletes, so what it cannot reach, no plan can. What it reaches may still be out of reach: then the goal
    atoms exclude one another, and `why_not` says which.

    Raises
    ------
    InputError
        The problem does not fit the domain.
    """
    return _Explained(domain, problem, effort).lines()


def nearest_goal(domain: Domain, problem: Problem, effort: Effort = Effort()) -> frozenset[Atom]:
    """A largest part of the goal that a search finds a plan for, as far as the effort goes; possibly empty.

    Subsets are tried from large to small up to eight goal atoms; longer goals are built up greedily, atom by atom.
    """
    return _Explained(domain, problem, effort).nearest()[0]


def why_not(domain: Domain, problem: Problem, effort: Effort = Effort()) -> tuple[str, ...]:
    """The lines of `explain`, and what the nearest reachable goal is; for a goal that a planner found unsolvable."""
    asked = _Explained(domain, problem, effort)
    lines = list(asked.lines())
    nearest, sure = asked.nearest()
    left = problem.goal - nearest
    if not lines and left:
        lines += asked.pairs.reasons(nearest, left)
    if not lines and left and sure:
        lines.append(
            f"each goal atom could be reached by deletion-free steps, but {_listed(left)} not together with {_listed(nearest)}: "
            "deletes or negative conditions stand against it"
        )
    if nearest:
        what = "the nearest goal that can be reached" if sure else "a part of the goal that can be reached"
        lines.append(f"{what}: {_listed(nearest)}")
    return tuple(lines)


class _Explained:
    """A problem, grounded once for all that is asked about it."""

    def __init__(self, domain: Domain, problem: Problem, effort: Effort) -> None:
        self._domain, self._problem, self._effort = domain, problem, effort
        self._steps: tuple[GroundOperator, ...] | None = None
        self._reached: dict[Atom, int] = {}
        with suppress(TooLargeError):
            self._steps, self._reached = reachable(domain, problem, limit=effort.ground_operators, matches=effort.matches)

    @cached_property
    def pairs(self) -> Pairs:
        return Pairs(self._steps or (), self._problem.init, self._effort.pairs if self._steps is not None else 0)

    def lines(self) -> tuple[str, ...]:
        if self._steps is None:
            return (_TOO_LARGE,)
        lines: list[str] = []
        unreachable = Unreachable(self._domain, self._problem, self._reached, self._effort.facts)
        try:
            for atom in sorted(self._problem.goal - self._reached.keys()):
                lines += unreachable.why(atom, "goal")
        except TooLargeError:
            lines.append(_TOO_LARGE)
        return tuple(lines or forbidden(self._steps, self._problem.init, self._problem.goal))

    def nearest(self) -> tuple[frozenset[Atom], bool]:
        """The part, and whether no other is known to be larger: every larger one was searched to its end or excludes itself."""
        if self._steps is None:
            return frozenset(), False
        init = self._problem.init
        grounding = Grounding(self._steps, self._reached)
        left, sure = self._effort.searched, True

        def solved(goal: frozenset[Atom]) -> bool:
            nonlocal left, sure
            if any(self.pairs.exclude(*pair) for pair in combinations(goal, 2)):
                return False
            task = grounding.task(init, goal, {})
            # a quarter of what is left for each, so that there is always something left for the next
            width = max(1, len(task.actions))
            answer, expanded = can_reach(task, max(10, left // (4 * width)))
            left, sure = max(0, left - width * expanded), sure and answer is not None
            return answer is True

        atoms = sorted(a for a in self._problem.goal if a in self._reached)
        if len(atoms) <= 8:
            for size in range(len(atoms), 0, -1):
                for subset in combinations(atoms, size):
                    if solved(frozenset(subset)):
                        return frozenset(subset), sure
            return frozenset(), sure
        kept: frozenset[Atom] = frozenset()
        for atom in atoms:
            if solved(kept | {atom}):
                kept |= {atom}
        return kept, kept == self._problem.goal


def _listed(atoms: Iterable[Atom]) -> str:
    return " ".join(map(str, sorted(atoms))) or "anything"
