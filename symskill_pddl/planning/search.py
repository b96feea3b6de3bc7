"""`builtin`: a small forward search that knows costs, negative conditions, and extra costs of single ground steps.

First best-first on ``g + h`` with the cost of FF's relaxed plan as h. It sees costs, so a step that was blamed for a failure is
avoided where there is another way; as h can overestimate, plans are good but not proved to be the cheapest. Where `PATIENCE`
does not see the end of it, a lazy greedy search with preferred operators follows (Helmert, 2006), whose plan is cleared of
detours (`shorten`): larger problems get longer plans instead of none. ``optimal=True`` takes h_max, which cannot overestimate,
and proves the cost at the price of time. Each proves unsolvability by exhausting the reachable states, or at once where
even the relaxed problem has no plan.
"""

from __future__ import annotations

import heapq
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from symskill_pddl import __version__
from symskill_pddl.errors import InputError
from symskill_pddl.planning.grounding import Action, Grounding, OutOfTimeError, Task, TooLargeError, ground_task
from symskill_pddl.planning.protocol import NO_EXTRA_COSTS, Limits, PlanResult, Status, Step
from symskill_pddl.planning.relaxation import INFINITE, Relaxation
from symskill_pddl.planning.shorten import Move, without_detours
from symskill_pddl.symbols import Domain, Plan, Problem, State, check_problem, validate

_Entry = tuple[float, int, int, Action | None]
PATIENCE = 40_000
"""States estimated, times ground operators, before the search turns greedy: about a tenth of a second of work."""
BOOST = 1000
"""How many expansions preferred operators get ahead for each state that looks better than all before."""


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
        return self.session(domain, problem.objects)._solve(problem, limits, extra_costs, ground_task)

    def session(self, domain: Domain, objects: tuple[tuple[str, str], ...]) -> BuiltinSession:
        """The planner for many states and goals over the same objects; it keeps what it has grounded."""
        return BuiltinSession(self, domain, objects)

    def _search(self, task: Task, deadline: float) -> tuple[list[Action] | None, int]:
        relaxation = Relaxation(task)
        if self.optimal:
            return _best_first(task, relaxation.h_max, deadline, estimates=None)
        patience = max(10, PATIENCE // max(1, len(task.actions)))
        try:
            return _best_first(task, relaxation.h_ff, deadline, estimates=patience)
        except _OutOfPatienceError:
            found, expanded = _lazy_greedy(task, relaxation, deadline)
            return found and _shortened(task, found), expanded


class BuiltinSession:
    """See `protocol.Session`. Grounds again only where a state holds what no state before could reach."""

    def __init__(self, planner: Builtin, domain: Domain, objects: tuple[tuple[str, str], ...]) -> None:
        self._planner, self._domain, self._objects = planner, domain, objects
        self._grounding: Grounding | None = None
        self._seen: State = frozenset()

    def solve(
        self, init: State, goal: State, limits: Limits = Limits(), extra_costs: Mapping[Step, float] = NO_EXTRA_COSTS
    ) -> PlanResult:
        """Plan from `init` to `goal`; raises as `Builtin.solve` does."""
        problem = Problem("replanning", self._domain.name, self._objects, init, goal)
        return self._solve(problem, limits, extra_costs, self._kept)

    def _kept(self, domain: Domain, problem: Problem, *, extra_costs: Mapping[Step, float], deadline: float, limit: int) -> Task:
        check_problem(domain, problem)
        if self._grounding is None or not problem.init <= self._grounding.reached:
            whole = replace(problem, init=problem.init | self._seen)
            self._grounding = Grounding.of(domain, whole, deadline=deadline, limit=limit)
            self._seen = whole.init
        return self._grounding.task(problem.init, problem.goal, extra_costs)

    def _solve(
        self, problem: Problem, limits: Limits, extra_costs: Mapping[Step, float], ground: Callable[..., Task]
    ) -> PlanResult:
        start = time.monotonic()
        domain, planner = self._domain, self._planner
        if any(not op.cost >= 0.0 for op in domain.operators) or any(not extra >= 0.0 for extra in extra_costs.values()):
            raise InputError("the builtin planner needs costs of zero or above")

        def result(status: Status, plan: Plan | None = None, *messages: str) -> PlanResult:
            return PlanResult(status, plan, time.monotonic() - start, messages, planner.name)

        deadline = start + limits.time_s
        try:
            task = ground(domain, problem, extra_costs=extra_costs, deadline=deadline, limit=limits.ground_operators)
            if task.goal is None:
                return result(Status.UNSOLVABLE, None, "some goal atom cannot be reached even without deletes")
            actions, expanded = planner._search(task, deadline)
        except OutOfTimeError:
            return result(Status.TIMEOUT, None, f"the time limit of {limits.time_s:g} s passed")
        except TooLargeError as error:
            return result(Status.FAILED, None, str(error))
        if actions is None:
            return result(Status.UNSOLVABLE, None, f"all {expanded} reachable states were searched")
        plan = Plan(tuple(a.step for a in actions), sum(a.cost for a in actions))
        validate(domain, problem, plan)
        return result(Status.SOLVED, plan, f"{expanded} states expanded, {len(task.actions)} ground operators")


class _OutOfPatienceError(Exception):
    """The allowed number of states was estimated."""


def _best_first(
    task: Task, heuristic: Callable[[int], float], deadline: float, *, estimates: int | None
) -> tuple[list[Action] | None, int]:
    """Best-first on g + h; states that are reached more cheaply are opened again."""
    goal = task.goal_mask
    best, estimate = {task.init: 0.0}, {task.init: heuristic(task.init)}
    parent: dict[int, tuple[int, Action]] = {}
    tie = expanded = 0
    heap = [(estimate[task.init], estimate[task.init], tie, 0.0, task.init)] if estimate[task.init] < INFINITE else []
    while heap:
        _, _, _, g, state = heapq.heappop(heap)
        if g > best[state]:
            continue
        if state & goal == goal:
            return _trace(parent, state), expanded
        if estimates is not None and len(estimate) >= estimates:
            raise _OutOfPatienceError
        expanded += 1
        if time.monotonic() > deadline:
            raise OutOfTimeError
        for action in task.actions:
            if state & action.pre_mask != action.pre_mask:
                continue
            successor = (state & ~action.delete_mask) | action.add_mask
            cost = g + action.cost
            if cost >= best.get(successor, INFINITE):
                continue
            best[successor] = cost
            if successor not in estimate:
                estimate[successor] = heuristic(successor)
            if (h := estimate[successor]) == INFINITE:
                continue
            parent[successor] = (state, action)
            tie += 1
            heapq.heappush(heap, (cost + h, h, tie, cost, successor))
    return None, expanded


def can_reach(task: Task, expansions: int) -> tuple[bool | None, int]:
    """Whether the greedy search finds a plan, None where it gave up, and how many states it expanded."""
    if task.goal is None:
        return False, 0
    try:
        found, expanded = _lazy_greedy(task, Relaxation(task), INFINITE, expansions=expansions)
    except _OutOfPatienceError:
        return None, expansions
    return found is not None, expanded


def _lazy_greedy(
    task: Task, relaxation: Relaxation, deadline: float, *, expansions: int | None = None
) -> tuple[list[Action] | None, int]:
    """Greedy on the parent's h, evaluating a state only when it is taken out; helpful actions have a queue of their own."""
    goal = task.goal_mask
    queues: tuple[list[_Entry], list[_Entry]] = ([(0.0, 0, task.init, None)], [])  # all actions; preferred ones
    turns = [0, 0]
    parent: dict[int, tuple[int, Action]] = {}
    closed: set[int] = set()
    tie = expanded = 0
    lowest = INFINITE
    while any(queues):
        which = min((i for i in (1, 0) if queues[i]), key=lambda i: turns[i])
        turns[which] += 1
        _, _, before, action = heapq.heappop(queues[which])
        state = before if action is None else (before & ~action.delete_mask) | action.add_mask
        if state in closed:
            continue
        closed.add(state)
        if action is not None:
            parent[state] = (before, action)
        if state & goal == goal:
            return _trace(parent, state), expanded
        if expanded == expansions:
            raise _OutOfPatienceError
        if time.monotonic() > deadline:
            raise OutOfTimeError
        h, helpful = relaxation.h_ff_with_plan(state)
        if h == INFINITE:
            continue
        expanded += 1
        if h < lowest:
            lowest = h
            turns[1] -= BOOST
        for i, following in enumerate(task.actions):
            if state & following.pre_mask == following.pre_mask:
                tie += 1
                entry = (h, tie, state, following)
                heapq.heappush(queues[0], entry)
                if i in helpful:
                    heapq.heappush(queues[1], entry)
    return None, expanded


def _shortened(task: Task, actions: list[Action]) -> list[Action]:
    """The plan without detours."""
    adders: dict[int, list[Move[Action]]] = {}
    move_of = {a.step: Move(a.pre_mask, 0, a.delete_mask, a.add_mask, a.cost, a) for a in task.actions}
    for action in task.actions:
        for fact in action.add:
            adders.setdefault(fact, []).append(move_of[action.step])

    def other(wanted: int, state: int) -> Move[Action] | None:
        able = adders.get((wanted & -wanted).bit_length() - 1, ())
        return next((m for m in able if wanted & m.add == wanted and m.applicable(state)), None)

    plan = [move_of[a.step] for a in actions]
    return [m.of for m in without_detours(plan, task.init, task.goal_mask, other)]


def _trace(parent: Mapping[int, tuple[int, Action]], state: int) -> list[Action]:
    actions = []
    while state in parent:
        state, action = parent[state]
        actions.append(action)
    return actions[::-1]
