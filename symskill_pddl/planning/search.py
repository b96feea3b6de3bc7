"""`builtin`: a small forward search that knows costs, negative conditions, and extra costs of single ground steps.

Best-first on ``g + h`` with h the cost of FF's relaxed plan (Hoffmann and Nebel, 2001), which sees costs, so a step that was blamed
for a failure is avoided where there is another way. h can overestimate, so plans are good but not proved to be the cheapest;
after `PATIENCE` expansions h is weighed more, and large problems are solved with longer plans instead of not at all. ``optimal=True``
takes h_max (Bonet and Geffner, 2001), which cannot, and proves it at the price of time. Both re-open states that are
reached more cheaply, and both prove unsolvability by exhausting the reachable states, or at once where even the relaxed problem has
no plan.
"""

from __future__ import annotations

import heapq
import time
from collections.abc import Mapping
from dataclasses import dataclass

from symskill_pddl import __version__
from symskill_pddl.errors import InputError
from symskill_pddl.planning.grounding import Action, OutOfTimeError, Task, TooLargeError, ground_task
from symskill_pddl.planning.protocol import NO_EXTRA_COSTS, Limits, PlanResult, Status, Step
from symskill_pddl.symbols import Domain, Plan, Problem

_INF = float("inf")
PATIENCE = 500
"""States expanded before the search turns greedy."""
GREEDY = 5.0
"""The weight of h from then on."""


class Relaxation:
    """Costs of reaching facts when nothing is ever deleted; one instance serves all states of a task."""

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
        cost, supporter = [_INF] * self._n, [-1] * self._n
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
        left = len(self._goal)
        goals = set(self._goal)
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
        """Cost of a relaxed plan built from the cheapest supporters; infinite only where there is truly no plan."""
        cost, supporter = self._explore(state, maximum=False)
        if any(cost[g] == _INF for g in self._goal):
            return _INF
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
        return sum(self._actions[i].cost for i in sorted(chosen))


@dataclass(frozen=True)
class Builtin:
    """The planner of this package; see the module's text."""

    optimal: bool = False
    name: str = "builtin"
    version: str = __version__
    licence: str = "Apache-2.0"
    dialects: tuple[str, ...] = ("strips", "negative", "costs")

    def solve(
        self,
        domain: Domain,
        problem: Problem,
        limits: Limits = Limits(),
        extra_costs: Mapping[Step, float] = NO_EXTRA_COSTS,
    ) -> PlanResult:
        """Plan.

        Parameters
        ----------
        extra_costs : mapping of (operator, arguments) to float
            What a ground step costs more than its operator says, zero or above.

        Raises
        ------
        InputError
            The problem does not fit the domain, or a cost is negative.
        """
        start = time.monotonic()
        if any(not op.cost >= 0.0 for op in domain.operators) or any(not extra >= 0.0 for extra in extra_costs.values()):
            raise InputError("the builtin planner needs costs of zero or above")

        def result(status: Status, plan: Plan | None = None, *messages: str) -> PlanResult:
            return PlanResult(status, plan, time.monotonic() - start, messages, self.name)

        deadline = start + limits.time_s
        try:
            task = ground_task(domain, problem, extra_costs=extra_costs, deadline=deadline, limit=limits.ground_operators)
            if task.goal is None:
                return result(Status.UNSOLVABLE, None, "some goal atom cannot be reached even without deletes")
            actions, expanded = self._search(task, deadline)
        except OutOfTimeError:
            return result(Status.TIMEOUT, None, f"the time limit of {limits.time_s:g} s passed")
        except TooLargeError as error:
            return result(Status.FAILED, None, str(error))
        if actions is None:
            return result(Status.UNSOLVABLE, None, f"all {expanded} reachable states were searched")
        plan = Plan(tuple(a.step for a in actions), sum(a.cost for a in actions))
        return result(Status.SOLVED, plan, f"{expanded} states expanded, {len(task.actions)} ground operators")

    def _search(self, task: Task, deadline: float) -> tuple[list[Action] | None, int]:
        relaxation = Relaxation(task)
        heuristic = relaxation.h_max if self.optimal else relaxation.h_ff
        goal = task.goal_mask
        best, estimate = {task.init: 0.0}, {task.init: heuristic(task.init)}
        parent: dict[int, tuple[int, Action]] = {}
        tie, expanded, weight = 0, 0, 1.0
        heap = [(estimate[task.init], estimate[task.init], tie, 0.0, task.init)] if estimate[task.init] < _INF else []
        while heap:
            _, _, _, g, state = heapq.heappop(heap)
            if g > best[state]:
                continue
            if state & goal == goal:
                return _trace(parent, state), expanded
            expanded += 1
            if expanded == PATIENCE and not self.optimal:
                weight = GREEDY
                heap = [(other_g + weight * h, h, order, other_g, other) for _, h, order, other_g, other in heap]
                heapq.heapify(heap)
            if time.monotonic() > deadline:
                raise OutOfTimeError
            for action in task.actions:
                if state & action.pre_mask != action.pre_mask:
                    continue
                successor = (state & ~action.delete_mask) | action.add_mask
                cost = g + action.cost
                if cost >= best.get(successor, _INF):
                    continue
                best[successor] = cost
                if successor not in estimate:
                    estimate[successor] = heuristic(successor)
                if (h := estimate[successor]) == _INF:
                    continue
                parent[successor] = (state, action)
                tie += 1
                heapq.heappush(heap, (cost + weight * h, h, tie, cost, successor))
        return None, expanded


def _trace(parent: Mapping[int, tuple[int, Action]], state: int) -> list[Action]:
    actions = []
    while state in parent:
        state, action = parent[state]
        actions.append(action)
    return actions[::-1]
