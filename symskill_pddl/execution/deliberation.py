"""`Deliberation`: plans from the present state, and what to do when there is none.

A planner that runs out of time, breaks, hangs or answers nonsense ends the run: the robot stands still, and the reason says what
the planner did. Where there is no plan the recoveries are, in this order, each followed by another look:

1. `recover-open`: fingers closed on nothing are opened, and the hand backs off along its own axis;
2. `recover-observe`: stand still and watch; perhaps somebody is still pushing the door;
3. `recover-face`: a box-like thing that fell over is taken for standing on another of its faces;
4. `recover-assume`: an object at rest in no known relation is taken for the nearest one, as an assumption that the monitor
does not share;
5. `recover-return` / `recover-retreat`: what is held goes back to where it was taken from; an empty hand goes back along its
path;
6. the assumptions once more, from there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import islice, product
from time import perf_counter

import numpy as np

from symskill_pddl.execution.asking import BrokenPlannerError, ask
from symskill_pddl.execution.belief import Belief
from symskill_pddl.execution.body import Body
from symskill_pddl.execution.config import ExecutionConfig
from symskill_pddl.execution.journal import Journal
from symskill_pddl.execution.lines import PlanLine, rows
from symskill_pddl.execution.ordering import one_by_one
from symskill_pddl.execution.recovery import StepKey, nearest_symbols, other_face
from symskill_pddl.geometry import Pose
from symskill_pddl.library import Library
from symskill_pddl.planning import Limits, Planner, PlanResult, Session, Status, explain, nearest_goal, session
from symskill_pddl.symbols import GRIPPER_OPEN, Atom, Domain, GroundOperator, Problem, State

_MOST_ASSUMPTIONS = 12


@dataclass(frozen=True)
class Planned:
    """Ground steps, and the atoms they rest on without having been observed."""

    steps: tuple[GroundOperator, ...]
    assumed: State


class Deliberation:
    """Plans for one goal."""

    def __init__(
        self,
        domain: Domain,
        goal: State,
        objects: Mapping[str, str],
        planner: Planner,
        library: Library,
        config: ExecutionConfig,
        body: Body,
        belief: Belief,
        journal: Journal,
    ) -> None:
        self._domain, self._goal, self._objects, self._planner = domain, goal, dict(objects), planner
        self._library, self._config, self._body, self._belief, self._journal = library, config, body, belief, journal
        self._known = frozenset(p.name for p in domain.predicates)
        self._last: tuple[Problem, PlanResult] | None = None
        self._session: Session | None = None
        """The planner with domain and objects loaded; opened by the first plan, whose time it takes."""
        self.stopped = ""
        """Why the planner is not to be asked again: it ran out of time, broke, hung, or answered nonsense."""

    def reached(self) -> bool:
        """Whether the goal holds now, out of the hand."""
        return self._belief.goal_reached(self._goal, self._body.state)

    def plan(self, reason: str, assumed: State = frozenset()) -> Planned | None:
        """A plan from the current state and the assumptions, or None. Owed deletes count as done: the next motion does them."""
        self._body.stop()
        now = self._body.state
        state = frozenset(a for a in (now - self._belief.pending(now)) | assumed if a.predicate in self._known)
        problem = Problem("now", self._domain.name, tuple(self._objects.items()), state, self._goal)
        costs = self._belief.failures.extra_costs(self._config.failure_cost)
        begin = perf_counter()
        result = self._ask(problem, costs)
        seconds = perf_counter() - begin
        self._journal.plan_seconds.append(seconds)
        plan, messages = result.plan, result.messages
        steps = plan.ground(self._domain, self._objects) if plan is not None else ()
        steps = one_by_one(steps, state, self._goal, frozenset(self._journal.used))
        if plan is not None and assumed and not self._honest(steps):
            plan, messages = None, ("an assumption would have to satisfy the goal",)
        self._journal.emit(
            PlanLine(
                time=self._body.now,
                reason=reason,
                status=result.status.value,
                steps=tuple((s.name, s.args) for s in steps) if plan is not None else (),
                state=rows(state),
                assumed=rows(assumed),
                messages=messages,
                seconds=seconds,
            )
        )
        if plan is None:
            if not assumed or self.stopped:
                self._last = problem, result
            return None
        return Planned(steps, assumed)

    def _ask(self, problem: Problem, costs: Mapping[StepKey, float]) -> PlanResult:
        """The planner's answer; one that comes too late, breaks or makes no sense says so in `stopped`."""
        limits, wait = Limits(time_s=self._config.plan_time_s), self._body.wait if self._body.live else None

        def solve() -> PlanResult:
            if self._session is None:
                self._session = session(self._planner, self._domain, problem.objects)
            return self._session.solve(problem.init, self._goal, limits, costs)

        try:
            result = ask(solve, self._domain, problem, limit_s=limits.time_s, wait=wait, period_s=self._body.period_s)
        except BrokenPlannerError as error:
            result = PlanResult(Status.FAILED, messages=(str(error),), planner=self._planner.name)
            self.stopped = str(error)
        if result.status is Status.TIMEOUT:
            self.stopped = "; ".join(result.messages) or "the planner ran out of time"
        return result

    @property
    def proved(self) -> bool:
        """Whether the planner, when it last found no plan, had proved that there is none."""
        return self._last is None or self._last[1].status is Status.UNSOLVABLE

    def explain(self) -> tuple[str, ...]:
        """Why there was no plan the last time, a line for each obstacle, and what part of the goal could be had."""
        if self._last is None:
            return ()
        problem, result = self._last
        if result.status is not Status.UNSOLVABLE:
            return result.messages or (result.status.value,)
        lines = explain(self._domain, problem)
        if len(self._goal) > 1:
            part = nearest_goal(self._domain, problem)
            lines += (f"a part that can be reached: {' '.join(map(str, sorted(part))) or 'none'}",)
        return lines or result.messages

    def _honest(self, steps: tuple[GroundOperator, ...]) -> bool:
        """Whether every goal atom is observed or brought about."""
        state = self._body.state
        for step in steps:
            state = step.apply(state)
        return self._goal <= state

    def recover(self, reason: str) -> Planned | None:
        """The general recoveries, until there is a plan. None: the goal holds by now, or nothing helped."""
        for attempt in (
            self._try_open,
            self._try_observe,
            self._try_other_face,
            self._try_assume,
            self._try_way_back,
            self._try_assume,
        ):
            if self.stopped or self.reached():
                return None
            if planned := attempt(reason):
                return planned
        return None

    def open_up(self, reason: str) -> None:
        """Open the fingers and back off along the hand's own axis."""
        begin = self._body.now
        self._body.fingers(False)
        arrived = self._body.back_off(self._config.back_off_m)
        self._body.hold(0.3)
        self._journal.recovered("recover-open", reason, _ended(arrived), begin)

    def clear(self, reason: str) -> None:
        """The open hand is too near to what it let go of, or behind what it slipped off: back off along its own axis."""
        begin = self._body.now
        arrived = self._body.back_off(self._config.back_off_m)
        self._journal.recovered("recover-clear", reason, _ended(arrived), begin)

    def leave(self, reason: str) -> None:
        """Somebody else has done it: let things come to rest, and back off from what the hand was about to do."""
        begin, body = self._body.now, self._body
        body.hold(
            self._config.observe_s, lambda: body.now - begin > self._config.grace_s and len(body.resting()) == len(self._objects)
        )
        arrived = body.back_off(1.5 * self._config.back_off_m)
        self._journal.recovered("recover-leave", reason, _ended(arrived), begin)

    def begin_at(self, T_world_ee: Pose, reason: str) -> None:
        """Straight to where the next step's motion passes, away from where it was blocked."""
        begin = self._body.now
        arrived = self._body.go(T_world_ee, self._config.approach_s)
        self._journal.recovered("recover-approach", reason, _ended(arrived), begin)

    def retreat(self, reason: str, since: int | None = None) -> None:
        """Back along the own path, and at least to its entry `since`: what was free on the way there is free on the way back."""
        begin = self._body.now
        length = 0.0 if since is None else self._body.travelled(since)
        arrived = self._body.go_back(max(self._config.retreat_m, length))
        self._journal.recovered("recover-retreat", reason, _ended(arrived), begin)

    def _try_open(self, reason: str) -> Planned | None:
        if not self._belief.empty_fist(self._body.state):
            return None
        self.open_up("the fingers are closed on nothing")
        return self.plan(reason)

    def _try_observe(self, reason: str) -> Planned | None:
        tried, found, moved = self._body.state, None, self._body.now

        def look() -> bool:
            nonlocal tried, found, moved
            if len(self._body.resting()) < len(self._objects):
                moved = self._body.now
            if self._body.state != tried:
                tried = self._body.state
                found = self.plan(reason)
            return found is not None or bool(self.stopped) or self.reached() or self._body.now - moved > self._config.quiet_s

        begin = self._body.now
        self._body.hold(self._config.observe_s, look)
        result = "a way on" if found is not None or self.reached() else "no change that helps"
        self._journal.recovered("recover-observe", "no plan from here, watching for a change", result, begin)
        return found

    def _try_other_face(self, reason: str) -> Planned | None:
        """A thing that fell over is taken for standing as it was shown, where its box looks no different so."""
        if not self._config.assume:
            return None
        body, classifiers = self._body, self._library.classifiers
        taken = []
        for name in nearest_symbols(body.scene, body.state, classifiers, body.resting()):
            half = self._library.extents.get(self._objects[name])
            found = other_face(body.scene, name, half, classifiers) if half is not None else None
            if found is not None:
                body.take(name, found[0])
                taken.append(f"{name} nearest to {found[1].atom} (margin {found[1].margin:.2f})")
        if not taken:
            return None
        begin = body.now
        body.hold(0.3)
        planned = self.plan(reason)
        result = "a way on" if planned is not None or self.reached() else "no plan"
        text = f"fell over: taken for standing on another face, {', '.join(taken)}"
        self._journal.recovered("recover-face", text, result, begin)
        return planned

    def _try_assume(self, reason: str) -> Planned | None:
        if not self._config.assume:
            return None
        body, uses = self._body, self._belief.assumptions
        nearest = nearest_symbols(body.scene, body.state, self._library.classifiers, body.resting())
        # what was assumed before, and did not lead to the goal, comes later
        ordered = [sorted(found, key=lambda a: (uses[a.atom], -a.margin, a.atom))[:4] for found in nearest.values()]
        if not ordered:
            return None
        for choice in islice(product(*ordered), _MOST_ASSUMPTIONS):
            if self.stopped:
                return None
            atoms = frozenset(a.atom for a in choice)
            if planned := self.plan(reason, atoms):
                uses.update(atoms)
                text = ", ".join(f"{a.atom} (margin {a.margin:.2f})" for a in choice)
                self._journal.recovered("recover-assume", f"at rest in no known relation, assuming {text}", "a plan", body.now)
                return planned
        text = f"at rest in no known relation: {' '.join(nearest)}"
        self._journal.recovered("recover-assume", text, "no assumption gives a plan", body.now)
        return None

    def _try_way_back(self, reason: str) -> Planned | None:
        body, journal, begin = self._body, self._journal, self._body.now
        if Atom(GRIPPER_OPEN) not in body.state:
            arrived = body.go_back(np.inf, body.grasp_entry)
            journal.recovered("recover-return", "no plan with what is held: putting it back", _ended(arrived), begin)
            self.open_up("put back")
        else:
            self.retreat("no plan from here")
        body.hold(0.5)
        return self.plan(reason)


def _ended(arrived: bool) -> str:
    return "done" if arrived else "blocked"
