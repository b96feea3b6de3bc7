"""`execute`: plan, run skills, watch, plan again, until the goal holds or nothing is left to try.

The loop follows the paper's online algorithm with its faults removed: plans start from the current state, failures are
remembered per ground step, a run ends with success, and every decision is the pure monitor's and stands in the trace.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from time import perf_counter
from typing import Any

import numpy as np

from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.execution.belief import Belief
from symskill_pddl.execution.body import Body
from symskill_pddl.execution.causes import cause_of, cause_of_run
from symskill_pddl.execution.config import ExecutionConfig
from symskill_pddl.execution.deliberation import Deliberation, Planned
from symskill_pddl.execution.guards import WorldFailedError, ended_by_signals
from symskill_pddl.execution.journal import Journal
from symskill_pddl.execution.lines import Header, OutcomeLine, TimesLine, rows, step_line, tick_line
from symskill_pddl.execution.monitor import (
    Blame,
    Continue,
    EffectsHold,
    JumpAhead,
    Memory,
    OverTime,
    Stalled,
    Tick,
    Verdict,
    Violation,
    Watch,
    check_start,
    judge,
    only_clearance_lacks,
)
from symskill_pddl.execution.outcome import Category, Outcome
from symskill_pddl.execution.preparation import Preparation
from symskill_pddl.execution.recovery import key_of
from symskill_pddl.execution.runner import Motion, SkillRun
from symskill_pddl.execution.timing import spreads
from symskill_pddl.execution.trace import TraceWriter
from symskill_pddl.library import Library
from symskill_pddl.planning import Planner
from symskill_pddl.scene import GRIPPER, Scene, World
from symskill_pddl.skills import warm
from symskill_pddl.symbols import GRIPPER_OPEN, Atom, Domain, GroundOperator, State


def execute(
    world: World,
    library: Library,
    domain: Domain,
    goal: frozenset[Atom],
    planner: Planner,
    config: ExecutionConfig | None = None,
    *,
    objects: Mapping[str, str],
    extents: Mapping[str, tuple[float, float, float]] | None = None,
    rng: np.random.Generator,
    trace: TraceWriter | None = None,
    header: Header | None = None,
    on_event: Callable[[Any], None] | None = None,
    on_step: Callable[[int, GroundOperator], None] | None = None,
    monitor: bool = True,
) -> Outcome:
    """Reach the goal atoms in the world.

    Parameters
    ----------
    domain : Domain
        Its operators are matched with the library's by name; conditions and effects are the domain's, skills and times the
        library's.
    goal : frozenset of Atom
        Ground atoms that have to hold together at the end.
    objects : mapping of str to str
        The objects the problem is about, with their types; each has to be in the scene.
    extents : mapping of str to (float, float, float), optional
        Half sizes [m] of types that the library does not know, for the hand to flow around objects of them too.
    trace, header
        Where to record the run, and what the caller knows for its first line (task, seed, library, planner).
    on_event : callable
        Gets every line of the trace as it comes about.
    on_step : callable
        Told the index and the ground step whenever a step starts.
    monitor : bool
        False runs the first plan open loop: no checks, no planning again.

    Raises
    ------
    InputError
        An operator without a skill, a goal or object that the domain or the scene does not have, an atom nothing can observe.
    """
    warm()
    begin = perf_counter()
    _check(library, domain, goal, objects, world.observe())
    _check_period(library, world.period_s)
    journal = Journal(trace, on_event)
    config = config or ExecutionConfig()
    told = {"goal": rows(goal), "objects": dict(objects), "monitor": monitor, "period_s": world.period_s}
    told |= {"resampling": config.resample, "replanning": config.replan, "obstacles": config.motion.avoid}
    told |= {"tracking": config.motion.track}
    journal.emit((header or Header()).model_copy(update=told))
    # the library's own extents are those its classifiers and skills were learned with
    sizes = {**(extents or {}), **library.extents}
    run = _Run(world, library, domain, goal, planner, config, objects, sizes, rng, journal, on_step)
    with ended_by_signals():
        try:
            category, reason = run.closed_loop() if monitor else run.open_loop()
        except WorldFailedError as error:
            category, reason = Category.WORLD, str(error)
        finally:
            run.body.stop()
    cause = cause_of_run(category, journal.troubles, journal.recoveries)
    outcome = Outcome(
        success=category is Category.SUCCESS,
        category=category,
        cause=cause,
        troubles=tuple(journal.troubles),
        reason=reason,
        replans=run.replans,
        steps=tuple(journal.steps),
        recoveries=tuple(journal.recoveries),
        time_s=run.body.elapsed,
        plan_seconds=tuple(journal.plan_seconds),
        times=spreads(journal.ticks, journal.plan_seconds),
        state=run.body.state,
    )
    journal.emit(
        OutcomeLine(
            time=run.body.now,
            success=outcome.success,
            category=category.value,
            cause=cause or "",
            reason=reason,
            replans=outcome.replans,
            recoveries=len(outcome.recoveries),
            seconds=perf_counter() - begin,
            times={name: TimesLine(**asdict(spread)) for name, spread in outcome.times.items()},
        )
    )
    return outcome


class _Run:
    """One call of `execute`."""

    def __init__(
        self,
        world: World,
        library: Library,
        domain: Domain,
        goal: State,
        planner: Planner,
        config: ExecutionConfig,
        objects: Mapping[str, str],
        extents: Mapping[str, tuple[float, float, float]],
        rng: np.random.Generator,
        journal: Journal,
        on_step: Callable[[int, GroundOperator], None] | None,
    ) -> None:
        self.goal, self.config, self.journal, self.on_step = goal, config, journal, on_step
        self.body = Body(world, library, objects, config.motion, config.debounce_s)
        self.belief = Belief(frozenset(c.predicate.name for c in library.classifiers if c.child == GRIPPER))
        self.mind = Deliberation(domain, goal, objects, planner, library, config, self.body, self.belief, journal)
        self.preparation = Preparation(library, config, extents, rng, self.body, self.belief, self.mind)
        self.replans = 0
        self.by_itself = False
        """Whether the last step was left in the middle: if the goal holds then, it came about by itself."""

    def closed_loop(self) -> tuple[Category, str]:
        """Until the goal holds."""
        reason, rounds = "start", 0
        while True:
            if self.mind.reached():
                if not self.by_itself:
                    return Category.SUCCESS, "the goal holds"
                self.by_itself = False
                self.mind.leave("the goal came about before its steps had ended")
                continue
            if rounds > self.config.max_replans:
                return Category.REPLANS, f"gave up after {self.config.max_replans} new plans; the last reason: {reason}"
            if self.body.elapsed > self.config.max_time_s:
                return Category.TIME, f"{self.config.max_time_s:g} s are over; the last reason: {reason}"
            if rounds and not self.config.replan:
                return Category.MISSED, f"the only plan was left: {reason}"
            self.replans, rounds = rounds, rounds + 1
            planned = self.mind.plan(reason) or self.mind.recover(reason)
            if self.mind.stopped:
                return self.hopeless()
            if planned is not None and planned.steps:
                reason = self.follow(planned)
            elif self.goal <= self.body.state:
                reason = "the goal holds, but its object is still held"
                self.mind.open_up(reason)
            elif planned is None and not self.mind.reached():
                return self.hopeless()

    def open_loop(self) -> tuple[Category, str]:
        """The first plan, whatever happens: each skill until its phases end or its time is up."""
        planned = self.mind.plan("start")
        if planned is None:
            return self.hopeless()
        for index, step in enumerate(planned.steps):
            watch, run, _ = self.preparation.ready(planned, index, blind=True)
            self.announce(watch, Continue("without monitor"), run, 0)
            why, memory = "the skill has ended", Memory()
            while True:
                motion = run.tick(self.body.scene)
                if motion.stage == run.phases and not motion.settling:
                    break
                if self.body.now - watch.start_s > watch.budget_s:
                    why = "the time is over"
                    break
                self.body.step(motion.command)
                judgement = judge(watch, self.seen(motion), memory)
                memory, trouble = judgement.memory, cause_of(judgement.verdict)
                # nobody acts on it; what follows from the first trouble says nothing more
                if trouble is not None and not self.journal.troubles:
                    self.journal.troubles.append(trouble)
            self.journal.ran(step, watch.start_s, self.body.now, Continue(why), 0)
        if self.goal <= self.body.state:
            return Category.SUCCESS, "the goal holds"
        return Category.MISSED, f"the plan was carried out and {self.missing()} does not hold"

    def follow(self, planned: Planned) -> str:
        """Run the plan's steps; why it was left."""
        index = 0
        while index < len(planned.steps):
            watch, run, attempt = self.preparation.ready(planned, index)
            entry = len(self.body.path) - 1
            verdict: Verdict = (check := check_start(watch, self.body.state))
            self.announce(watch, verdict, run, attempt)
            if isinstance(verdict, Continue):
                verdict = self.run_step(watch, run)
                self.journal.ran(watch.step, watch.start_s, self.body.now, verdict, attempt)
            match verdict:
                case EffectsHold():
                    self.belief.succeeded(watch)
                    self.by_itself = False
                    index += 1
                case JumpAhead(index=ahead):
                    self.belief.jumped()
                    self.by_itself = True
                    index = ahead
                case Stalled() | OverTime() if only_clearance_lacks(watch, self.body.state):
                    self.mind.clear(verdict.reason)
                    return f"{watch.step}: {verdict.reason}"
                case _:
                    if (trouble := cause_of(verdict)) is not None:
                        self.journal.troubles.append(trouble)
                    self.belief.blame(watch, verdict)
                    self.by_itself = isinstance(check, Continue)
                    if isinstance(verdict, Stalled) and verdict.blocked:
                        self.belief.held_up(watch.step, run.stage)
                        if self.preparation.bound(watch.step):
                            self.mind.open_up(verdict.reason)
                        else:
                            self.mind.retreat(verdict.reason, entry)
                    if self.belief.slipped_off(watch, verdict):
                        # no demonstration sets out from behind what the hand has slipped off
                        self.mind.clear(verdict.reason)
                    if self.try_again(watch, verdict):
                        continue
                    return f"{watch.step}: {verdict.reason}"
        return "the plan ended without the goal"

    def try_again(self, watch: Watch, verdict: Verdict) -> bool:
        """Whether to try the same step once more, where nothing may be planned again."""
        tries = self.belief.failures.count(key_of(watch.step))
        own = isinstance(verdict, Stalled | OverTime) or (isinstance(verdict, Violation) and verdict.blame is Blame.OWN)
        if self.config.replan or not own or tries > self.config.max_replans or self.body.elapsed > self.config.max_time_s:
            return False
        if self.belief.empty_fist(self.body.state):
            self.mind.open_up("the fingers are closed on nothing")
        return watch.step.pre <= self.body.state | watch.assumed

    def run_step(self, watch: Watch, run: SkillRun) -> Verdict:
        """Tick until the monitor says anything but `Continue`."""
        memory, before, body = Memory(), watch.start_state, self.body
        while True:
            begin = perf_counter()
            motion = run.tick(body.scene)
            skill_ms = 1e3 * (perf_counter() - begin)
            body.step(motion.command)
            begin = perf_counter()
            tick = self.seen(motion)
            judgement = judge(watch, tick, memory)
            verdict, memory = judgement.verdict, judgement.memory
            decided = perf_counter()
            ms = {**body.ms, "skill": skill_ms - run.obstacles_ms, "monitor": 1e3 * (decided - begin)}
            if run.avoids:
                ms["obstacles"] = run.obstacles_ms
            if self.journal.listens:
                self.journal.emit(tick_line(tick, before, verdict, {name: round(value, 4) for name, value in ms.items()}))
                ms["trace"] = 1e3 * (perf_counter() - decided)
            self.journal.ticks.append(ms)
            before = tick.state
            if not isinstance(verdict, Continue):
                return verdict

    def seen(self, motion: Motion) -> Tick:
        """What the monitor is told of the tick that has just passed."""
        return Tick(
            now_s=self.body.now,
            state=self.body.state,
            stage=motion.stage,
            stage_s=motion.stage_s,
            settling=motion.settling,
            closing=self.body.closing,
            speed=motion.speed,
            turn=motion.turn,
            rest_s=motion.rest_s,
        )

    def announce(self, watch: Watch, verdict: Verdict, run: SkillRun, attempt: int) -> None:
        """Tell of a step's start."""
        self.journal.emit(step_line(watch, verdict, attempt=attempt, shift=run.shift_vector))
        if self.on_step and isinstance(verdict, Continue):
            self.on_step(watch.index, watch.step)

    def hopeless(self) -> tuple[Category, str]:
        """No plan, and why."""
        category = Category.UNREACHABLE if self.mind.proved and not self.mind.stopped else Category.PLANNER
        return category, "; ".join((f"no plan reaches {self.missing()}", *self.mind.explain()))

    def missing(self) -> str:
        """The goal atoms that do not hold, as text."""
        return " ".join(map(str, sorted(self.goal - self.body.state)))


def _check(library: Library, domain: Domain, goal: State, objects: Mapping[str, str], scene: Scene) -> None:
    """Refuse what could only fail later, and less clearly."""
    for name in objects:
        scene.pose(name)
    seen = {GRIPPER_OPEN, *(c.predicate.name for c in library.classifiers)}
    for op in domain.operators:
        learned = library.learned(op.name)
        if learned.skill not in library.skills:
            raise InputError(
                f"operator '{op.name}' needs the skill '{learned.skill}'; the library has: {alternatives(library.skills)}"
            )
        if len(op.parameters) != len(learned.operator.parameters):
            raise InputError(
                f"operator '{op.name}' has {len(op.parameters)} parameters, its skill {len(learned.operator.parameters)}"
            )
        used = {a.predicate for a in op.pre | op.add | op.delete} | {a.atom.predicate for a in op.absent}
        if unseen := sorted(used - seen):
            raise InputError(
                f"operator '{op.name}' uses '{unseen[0]}', which nothing can observe; what can be: {alternatives(seen)}"
            )
    for atom in sorted(goal):
        if len(domain.predicate(atom.predicate).types) != len(atom.args) or atom.predicate not in seen:
            raise InputError(f"the goal {atom} is no atom that can be observed; predicates: {alternatives(seen)}")
        if unknown := [a for a in atom.args if a not in objects]:
            raise InputError(f"the goal {atom} names the unknown object '{unknown[0]}'; the problem has: {alternatives(objects)}")


def _check_period(library: Library, period_s: float) -> None:
    """A field that is stable for short steps need not be for long ones."""
    if period_s >= library.max_period_s:
        raise InputError(
            f"the world is commanded every {period_s:g} s, the library's skills are certified for periods below "
            f"{library.max_period_s:.3g} s: command it more often, or learn with a longer period"
        )
