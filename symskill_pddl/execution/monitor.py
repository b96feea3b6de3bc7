"""The monitor: what to do next, as a pure function of (step, atoms, times, twist). Standard library only.

`check_start` decides whether a step may begin, `judge` decides at every control tick while it runs. Both return a verdict
that carries its reason; neither reads a clock, a pose or a random number, so that every decision can be replayed from a
trace.

The rules are those of the paper's online algorithm, corrected: effects are tested first; only ``maintain - delete`` is
protected; a deleted atom may fall if the effects follow within a grace time; a stop counts only on the *nominal* twist,
before obstacle modulation.

When is a step finished? Its effects have to hold **and** its exit has to be over, because the next skill's approach was
demonstrated from where this one's exit ended. The exit is over when the skill's last phase was reached, or, within the last
phase, when the nominal twist is small or the phase has lasted as long as in the demonstrations. If the effects fall again
during the exit, the other rules apply.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cached_property

from symskill_pddl.symbols import GRIPPER_OPEN, Atom, GroundOperator, State


class Blame(StrEnum):
    """Who is to be tried differently next time."""

    OWN = "own step"
    ACQUIRING = "acquiring step"
    EXTERNAL = "external"


class Kind(StrEnum):
    """What was violated."""

    PRECONDITION = "precondition"
    PROTECTED = "protected"
    LOST_GRASP = "lost grasp"
    EFFECTS = "effects did not follow"


@dataclass(frozen=True)
class Continue:
    """Go on with this step."""

    reason: str


@dataclass(frozen=True)
class EffectsHold:
    """The step is finished."""

    reason: str


@dataclass(frozen=True)
class JumpAhead:
    """Go on with the plan's step `index`; the plan's length means that nothing is left to do."""

    index: int
    reason: str


@dataclass(frozen=True)
class Violation:
    """An atom is missing, or in the way: plan again."""

    kind: Kind
    atoms: tuple[Atom, ...]
    blame: Blame
    reason: str


@dataclass(frozen=True)
class Stalled:
    """The step gets nowhere and the effects do not hold: this step is to blame.

    `blocked` is False where the skill has come to rest by itself, and True where something holds the hand, so that the next try
    had better begin elsewhere.
    """

    reason: str
    blocked: bool = False


@dataclass(frozen=True)
class OverTime:
    """The step has used up its time: this step is to blame."""

    reason: str


Verdict = Continue | EffectsHold | JumpAhead | Violation | Stalled | OverTime


def pending_deletes(step: GroundOperator, gripper: frozenset[str]) -> State:
    """The delete effects that the step's own skill cannot bring about, left to the motion of the step that follows.

    A step that gains a gripper relation, and no relation between objects, is a premotion: nothing but the hand moves in it.
    Of what it deletes, only the fingers and gripper relations can change; that the object leaves its place shows when the
    next step lifts it. `gripper` names the predicates that relate the end effector to an object.
    """
    hand = gripper | {GRIPPER_OPEN}
    if not any(a.predicate in gripper for a in step.add) or any(a.predicate not in hand for a in step.add):
        return frozenset()
    return frozenset(a for a in step.delete - step.add if a.predicate not in hand)


@dataclass(frozen=True)
class Target:
    """A point of the plan that may be jumped to, and the atoms that say that it has been arrived at."""

    index: int
    needs: State
    forbids: State


@dataclass(frozen=True)
class Watch:
    """All that is fixed when a step starts.

    Attributes
    ----------
    step, index, later
        The ground step, its place in the plan, and the steps after it.
    gripper : frozenset of str
        Predicates that relate the end effector to an object.
    start_s, start_state
        When the step started [s], and the atoms then.
    inherited : State
        Deletes of earlier steps that were pending when this one started: to be brought about, and judged, here.
    assumed : State
        Atoms the planner was told without being observed; preconditions may rest on them until something else is seen, and
        nothing protects them.
    phases, exit_s
        Number of the skill's phases, and how long the last one lasted in the demonstrations [s].
    budget_s, grace_s, stall_s, blocked_s
        Time for the whole step; from the fall of a deleted atom to the effects; of a nominal twist near zero before a stall is
        called; of a hand at rest that is told to move [s].
    still_speed, still_turn
        Nominal twist below which the skill is at rest [m/s], [rad/s].
    """

    step: GroundOperator
    index: int
    later: tuple[GroundOperator, ...]
    gripper: frozenset[str]
    start_s: float
    start_state: State
    inherited: State
    assumed: State
    phases: int
    exit_s: float
    budget_s: float
    grace_s: float
    stall_s: float
    blocked_s: float
    still_speed: float
    still_turn: float

    @cached_property
    def pending(self) -> State:
        """Deletes that stay pending when this step has finished."""
        return pending_deletes(self.step, self.gripper) | (self.inherited - self.must_fall - self.step.add)

    @cached_property
    def must_fall(self) -> State:
        """Deletes that have to be seen before the step counts as finished.

        A premotion passes on what it inherited: it does not move the object either.
        """
        own = pending_deletes(self.step, self.gripper)
        inherited = frozenset() if own else self.inherited
        return (self.step.delete - own | inherited) - self.step.add

    @cached_property
    def protected(self) -> State:
        """What must not fall: the maintained atoms that the step does not delete, and that held when it started.

        The last restriction matters for atoms that happened to hold in every demonstration and were dropped from the
        preconditions.
        """
        return self.step.protected & self.start_state - self.assumed - self.inherited

    @cached_property
    def targets(self) -> tuple[Target, ...]:
        """Points of the plan beyond the next step's start, the furthest first; the last one is the plan's end.

        Each asks for the net effects of all steps before it, without the deletes that the one right before it leaves pending.
        """
        needs: State = frozenset()
        forbids = self.inherited
        found = []
        for done, step in enumerate((self.step, *self.later), start=1):
            needs = (needs - step.delete) | step.add
            forbids = (forbids | step.delete) - step.add
            if done >= 2:
                pre, absent = (
                    (self.later[done - 1].pre, self.later[done - 1].absent) if done <= len(self.later) else (needs, forbids)
                )
                owed = pending_deletes(step, self.gripper)
                found.append(Target(self.index + done, needs | pre, (forbids | absent) - owed))
        return tuple(reversed(found))


@dataclass(frozen=True)
class Tick:
    """One moment of a running step.

    Attributes
    ----------
    now_s : float
        Time [s].
    state : State
        The atoms, after hysteresis and debounce.
    stage, stage_s
        Which of the skill's phases runs, counted from 0, and for how long [s]; `stage` equal to the number of phases: it has
        ended.
    settling : bool
        The fingers are on their way; the skill waits for them.
    closing : bool
        What the fingers are told.
    speed, turn
        Norms of the nominal twist, before modulation [m/s], [rad/s].
    rest_s : float
        How long the hand has been at rest, as measured [s].
    """

    now_s: float
    state: State
    stage: int
    stage_s: float
    settling: bool
    closing: bool
    speed: float
    turn: float
    rest_s: float = 0.0


@dataclass(frozen=True)
class Memory:
    """What `judge` has to remember between ticks: since when atoms are gone, and since when the skill rests."""

    seen: State = frozenset()
    fallen: tuple[tuple[Atom, float], ...] = ()
    still_since: float | None = None
    stage: int = 0


@dataclass(frozen=True)
class Judgement:
    """A verdict, and the memory to hand to the next tick."""

    verdict: Verdict
    memory: Memory = field(default_factory=Memory)


def check_start(watch: Watch, state: State) -> Continue | EffectsHold | JumpAhead | Violation:
    """Whether the step may begin.

    A step whose effects hold already is passed over, a plan whose later point is reached is taken up there. Atoms whose
    deletion is pending from the step before count as gone.
    """
    if _effects(watch, state):
        return EffectsHold(f"{_text(watch.step.add)} held before the step began")
    if target := _arrived(watch, state):
        return JumpAhead(target.index, f"everything up to step {target.index + 1} has come about")
    if refuted := _refuted(watch, state):
        return refuted
    if missing := watch.step.pre - state - watch.assumed:
        return Violation(Kind.PRECONDITION, tuple(sorted(missing)), Blame.EXTERNAL, f"the step needs {_text(missing)}")
    if present := watch.step.absent & (state - watch.inherited):
        return Violation(Kind.PRECONDITION, tuple(sorted(present)), Blame.EXTERNAL, f"the step forbids {_text(present)}")
    note = f", assuming {_text(watch.step.pre - state)}" if watch.step.pre - state else ""
    return Continue(f"preconditions hold{note}")


def only_clearance_lacks(watch: Watch, state: State) -> bool:
    """Whether all that keeps the effects from holding is that the open hand is still too near to what it let go of."""
    left = watch.must_fall & state
    near = bool(left) and all(a.predicate in watch.gripper for a in left)
    return near and Atom(GRIPPER_OPEN) in state and watch.step.add <= state


def judge(watch: Watch, tick: Tick, memory: Memory) -> Judgement:
    """The verdict on one tick of a running step. The first rule that applies decides.

    1. effects hold: finished, once the fingers rest and the exit is over;
    2. a later point of the plan is reached: jump there;
    3. a protected atom fell: violation (a gripper relation blames the step that acquired it, anything else is external);
       likewise an assumption that the step rests on, once the thing is seen to be elsewhere;
    4. a deleted atom fell and the effects did not follow within the grace time: violation. A gripper relation lost while the
       fingers were told to hold is a lost grasp and blames the acquiring step; what follows from the step's own release or
       closing blames the step; anything else is external;
    5. the nominal twist has been small for a while: stalled; or it has not, and yet the hand does not move: blocked;
    6. the time budget is used up: over time.

    The paper takes any stop for the end of a skill; here one that an obstacle or a contact causes is never taken for success.
    """
    memory = _remember(watch, tick, memory)
    return Judgement(_decide(watch, tick, memory), memory)


def _remember(watch: Watch, tick: Tick, memory: Memory) -> Memory:
    since = dict(memory.fallen)
    seen = memory.seen | watch.start_state | tick.state
    gone = sorted((watch.step.delete - watch.step.add) & seen - tick.state)
    resting = not tick.settling and tick.speed < watch.still_speed and tick.turn < watch.still_turn
    still = memory.still_since if resting and tick.stage == memory.stage and memory.still_since is not None else tick.now_s
    return replace(
        memory,
        seen=seen,
        # while the fingers move, the atoms they change cannot have settled: the grace time starts when they rest
        fallen=tuple((a, tick.now_s if tick.settling else since.get(a, tick.now_s)) for a in gone),
        still_since=still if resting else None,
        stage=tick.stage,
    )


def _decide(watch: Watch, tick: Tick, memory: Memory) -> Verdict:
    elapsed = tick.now_s - watch.start_s
    over = elapsed > watch.budget_s
    if _effects(watch, tick.state):
        if tick.settling and not over:
            return Continue("effects hold, the fingers still move")
        if ending := _exit_over(watch, tick, memory, over):
            return EffectsHold(f"{_text(watch.step.add)} and {ending}")
        return Continue("effects hold, the exit goes on")
    if not tick.settling and (target := _arrived(watch, tick.state)):
        return JumpAhead(target.index, f"everything up to step {target.index + 1} has come about")
    if missing := watch.protected - tick.state:
        grasp = any(a.predicate in watch.gripper for a in missing)
        blame = Blame.ACQUIRING if grasp else Blame.EXTERNAL
        kind = Kind.LOST_GRASP if grasp else Kind.PROTECTED
        return Violation(kind, tuple(sorted(missing)), blame, f"{_text(missing)} fell and is protected")
    if not tick.settling and (refuted := _refuted(watch, tick.state)):
        return refuted
    late = tuple(a for a, since in memory.fallen if tick.now_s - since > watch.grace_s)
    if late and not tick.settling:
        return _late(watch, tick, late)
    if memory.still_since is not None and tick.now_s - memory.still_since >= watch.stall_s:
        return Stalled(f"at rest for {tick.now_s - memory.still_since:.2f} s without {_text(_unmet(watch, tick.state))}")
    if tick.rest_s >= watch.blocked_s and not tick.settling and memory.still_since is None:
        told = f"{tick.speed:.2f} m/s and {tick.turn:.2f} rad/s"
        return Stalled(
            f"blocked: told {told}, at rest for {tick.rest_s:.1f} s without {_text(_unmet(watch, tick.state))}", blocked=True
        )
    if over:
        return OverTime(f"{elapsed:.1f} s of {watch.budget_s:.1f} s used without {_text(_unmet(watch, tick.state))}")
    return Continue("under way")


def _refuted(watch: Watch, state: State) -> Violation | None:
    """An assumption that the step rests on, and does not itself undo: it was made of a thing in no relation, and one is seen."""
    for atom in sorted(watch.step.pre & watch.assumed - watch.must_fall - state):
        seen = frozenset(a for a in state - watch.step.add if a.args[:1] == atom.args[:1] and a.predicate not in watch.gripper)
        if seen:
            text = f"{_text(seen)} is seen, where {_text(atom)} was assumed"
            return Violation(Kind.PRECONDITION, (atom,), Blame.EXTERNAL, text)
    return None


def _late(watch: Watch, tick: Tick, atoms: tuple[Atom, ...]) -> Violation:
    """A deleted atom fell, the grace time is over, and the effects do not hold."""
    text = f"{_text(atoms)} fell, and {_text(_unmet(watch, tick.state))} did not follow within {watch.grace_s:.1f} s"
    hand = watch.gripper | {GRIPPER_OPEN}
    if any(a.predicate in watch.gripper for a in atoms) and tick.closing:
        return Violation(Kind.LOST_GRASP, atoms, Blame.ACQUIRING, text)
    blame = Blame.OWN if all(a.predicate in hand for a in atoms) else Blame.EXTERNAL
    return Violation(Kind.EFFECTS, atoms, blame, text)


def _effects(watch: Watch, state: State) -> bool:
    return watch.step.add <= state and not (watch.must_fall & state)


def _exit_over(watch: Watch, tick: Tick, memory: Memory, over: bool) -> str:
    if tick.stage >= watch.phases:
        return "the skill has ended"
    if tick.stage == watch.phases - 1:
        if memory.still_since is not None:
            return "the skill rests"
        if tick.stage_s >= watch.exit_s:
            return "the last phase has lasted as long as demonstrated"
    return "the time is over" if over else ""


def _arrived(watch: Watch, state: State) -> Target | None:
    return next((t for t in watch.targets if t.needs <= state and not (t.forbids & state)), None)


def _unmet(watch: Watch, state: State) -> list[str]:
    return [str(a) for a in sorted(watch.step.add - state)] + [f"not {a}" for a in sorted(watch.must_fall & state)]


def _text(atoms: object) -> str:
    items = sorted(str(a) for a in atoms) if isinstance(atoms, frozenset | tuple | list) else [str(atoms)]
    return " ".join(items) or "(nothing)"
