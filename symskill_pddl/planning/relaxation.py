"""Heuristics by delete relaxation: what facts cost when nothing is ever deleted.

h_max (Bonet and Geffner, 2001) never overestimates. h_FF (Hoffmann and Nebel, 2001) is the cost of a relaxed plan built from the
cheapest supporters by h_add; it sees costs and is closer to the truth, and can overestimate.
"""

from __future__ import annotations

import heapq

from symskill_pddl.planning.grounding import Task

INFINITE = float("inf")


class Relaxation:
    """One instance serves all states of a task."""

    def __init__(self, task: Task) -> None:
        self._goal = task.goal or ()
        self._actions = task.actions
        self._n = task.n_facts
        self._needed_by: list[list[int]] = [[] for _ in range(task.n_facts)]
        self._without = [i for i, a in enumerate(task.actions) if not a.pre]
        for i, action in enumerate(task.actions):
            for fact in action.pre:
                self._needed_by[fact].append(i)

    def _explore(self, state: int, *, maximum: bool) -> tuple[list[float], list[int]]:
        """Dijkstra over facts: cost of each, and the action that first adds it (-1 where the state holds it)."""
        cost, supporter = [INFINITE] * self._n, [-1] * self._n
        missing = [len(a.pre) for a in self._actions]
        paid = [a.cost for a in self._actions]
        heap: list[tuple[float, int]] = []
        bits = state
        while bits:
            low = bits & -bits
            fact = low.bit_length() - 1
            cost[fact] = 0.0
            heap.append((0.0, fact))
            bits ^= low

        def reach(index: int) -> None:
            total = paid[index]
            for fact in self._actions[index].add:
                if total < cost[fact]:
                    cost[fact], supporter[fact] = total, index
                    heapq.heappush(heap, (total, fact))

        for index in self._without:
            reach(index)
        done = [False] * self._n
        goals = set(self._goal)
        left = len(goals)
        while heap and left:
            value, fact = heapq.heappop(heap)
            if done[fact]:
                continue
            done[fact] = True
            left -= fact in goals
            for index in self._needed_by[fact]:
                missing[index] -= 1
                if maximum:
                    paid[index] = max(paid[index], value + self._actions[index].cost)
                else:
                    paid[index] += value
                if missing[index] == 0:
                    reach(index)
        return cost, supporter

    def h_max(self, state: int) -> float:
        """Admissible: no plan is cheaper."""
        cost, _ = self._explore(state, maximum=True)
        return max((cost[g] for g in self._goal), default=0.0)

    def h_ff(self, state: int) -> float:
        """Cost of a relaxed plan; infinite only where there is truly no plan."""
        return self.h_ff_with_plan(state)[0]

    def h_ff_with_plan(self, state: int) -> tuple[float, frozenset[int]]:
        """The same, with the numbers of the relaxed plan's actions that are applicable in the state."""
        cost, supporter = self._explore(state, maximum=False)
        if any(cost[g] == INFINITE for g in self._goal):
            return INFINITE, frozenset()
        chosen: set[int] = set()
        stack, seen = list(self._goal), set(self._goal)
        while stack:
            index = supporter[stack.pop()]
            if index < 0 or index in chosen:
                continue
            chosen.add(index)
            for fact in self._actions[index].pre:
                if fact not in seen:
                    seen.add(fact)
                    stack.append(fact)
        helpful = frozenset(i for i in chosen if state & self._actions[i].pre_mask == self._actions[i].pre_mask)
        return sum(self._actions[i].cost for i in sorted(chosen)), helpful
