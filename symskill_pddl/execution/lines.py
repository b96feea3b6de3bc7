"""The lines of a trace, and what the monitor is given and says as lines and back. Every decision can be read from them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, SerializerFunctionWrapHandler, model_serializer

from symskill_pddl.execution.monitor import (
    Continue,
    EffectsHold,
    JumpAhead,
    Stalled,
    Tick,
    Verdict,
    Violation,
    Watch,
)
from symskill_pddl.symbols import Atom, GroundOperator, State

SCHEMA = 2

Row = Annotated[tuple[str, ...], Field(min_length=1)]
"""An atom in JSON: predicate, then arguments."""


class _Line(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Header(_Line):
    """First line: what was run."""

    event: Literal["header"] = "header"
    schema_version: int = SCHEMA
    world: str = ""
    """Left out of the file where nothing is said."""
    task: str = ""
    seed: int = 0
    goal: tuple[Row, ...] = ()
    objects: dict[str, str] = {}
    library: str = ""
    """Checksum of the library."""
    planner: str = ""
    monitor: bool = True
    resampling: bool = True
    replanning: bool = True
    tracking: bool = True
    obstacles: bool = True
    period_s: float = 0.0

    @model_serializer(mode="wrap")
    def _plain(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        fields: dict[str, Any] = write(self)
        if not self.world:
            del fields["world"]
        return fields


class GroundStep(_Line):
    """A ground operator."""

    name: str
    args: tuple[str, ...]
    pre: tuple[Row, ...]
    add: tuple[Row, ...]
    delete: tuple[Row, ...]
    maintain: tuple[Row, ...]
    absent: tuple[Row, ...]
    cost: float


class PlanLine(_Line):
    """A call of the planner, and what came of it."""

    event: Literal["plan"] = "plan"
    time: float
    reason: str
    """Why it was called."""
    status: str
    steps: tuple[tuple[str, tuple[str, ...]], ...]
    state: tuple[Row, ...]
    assumed: tuple[Row, ...] = ()
    messages: tuple[str, ...] = ()
    seconds: float = 0.0


class VerdictLine(_Line):
    """A verdict; the fields a kind does not have are left out."""

    kind: str
    reason: str
    index: int | None = None
    violation: str | None = None
    atoms: tuple[Row, ...] = ()
    blame: str | None = None
    blocked: bool | None = None


class StepLine(_Line):
    """A step is about to start: all the monitor needs to judge it, and whether it may start."""

    event: Literal["step"] = "step"
    time: float
    index: int
    step: GroundStep
    later: tuple[GroundStep, ...]
    gripper: tuple[str, ...]
    state: tuple[Row, ...]
    inherited: tuple[Row, ...]
    assumed: tuple[Row, ...]
    phases: int
    exit_s: float
    budget_s: float
    grace_s: float
    stall_s: float
    blocked_s: float
    still_speed: float
    still_turn: float
    attempt: int
    shift: tuple[float, ...] | None = None
    """Goal shift as position and quaternion (w, x, y, z), where the step is resampled."""
    verdict: VerdictLine


class TickLine(_Line):
    """One control tick of a step. `added` and `removed` are relative to the previous line of the step."""

    event: Literal["tick"] = "tick"
    time: float
    stage: int
    stage_s: float
    settling: bool
    closing: bool
    speed: float
    turn: float
    rest_s: float
    added: tuple[Row, ...]
    removed: tuple[Row, ...]
    verdict: VerdictLine
    ms: dict[str, float] = {}


class RecoveryLine(_Line):
    """A general recovery: its name, why, and how it ended."""

    event: Literal["recovery"] = "recovery"
    time: float
    name: str
    reason: str
    result: str = ""


class NoteLine(_Line):
    """A remark of the caller, for example a scripted disturbance."""

    event: Literal["note"] = "note"
    time: float
    text: str


class TimesLine(_Line):
    """Wall-clock times of one kind [ms], as `timing.Spread`."""

    n: int
    p50: float
    p95: float
    max: float


class OutcomeLine(_Line):
    """Last line."""

    event: Literal["outcome"] = "outcome"
    time: float
    success: bool
    category: str
    cause: str = ""
    """Of a failure, as `causes.Cause`."""
    reason: str
    replans: int
    recoveries: int
    seconds: float = 0.0
    times: dict[str, TimesLine] = {}


Line = Annotated[
    Header | PlanLine | StepLine | TickLine | RecoveryLine | NoteLine | OutcomeLine,
    Field(discriminator="event"),
]


def rows(atoms: Iterable[Atom]) -> tuple[Row, ...]:
    """Atoms as JSON rows, sorted."""
    return tuple(sorted((a.predicate, *a.args) for a in atoms))


def unrows(lines: Iterable[Row]) -> State:
    """Atoms from JSON rows."""
    return frozenset(Atom(r[0], tuple(r[1:])) for r in lines)


def ground_step(step: GroundOperator) -> GroundStep:
    """A ground operator for JSON."""
    sets = {name: rows(getattr(step, name)) for name in ("pre", "add", "delete", "maintain", "absent")}
    return GroundStep(name=step.name, args=step.args, cost=step.cost, **sets)


def load_step(line: GroundStep) -> GroundOperator:
    """The ground operator of a JSON step."""
    sets = {name: unrows(getattr(line, name)) for name in ("pre", "add", "delete", "maintain", "absent")}
    return GroundOperator(line.name, line.args, cost=line.cost, **sets)


def step_line(watch: Watch, verdict: Verdict, *, attempt: int, shift: tuple[float, ...] | None) -> StepLine:
    """The line of a step's start."""
    return StepLine(
        time=watch.start_s,
        index=watch.index,
        step=ground_step(watch.step),
        later=tuple(map(ground_step, watch.later)),
        gripper=tuple(sorted(watch.gripper)),
        state=rows(watch.start_state),
        inherited=rows(watch.inherited),
        assumed=rows(watch.assumed),
        phases=watch.phases,
        exit_s=watch.exit_s,
        budget_s=watch.budget_s,
        grace_s=watch.grace_s,
        stall_s=watch.stall_s,
        blocked_s=watch.blocked_s,
        still_speed=watch.still_speed,
        still_turn=watch.still_turn,
        attempt=attempt,
        shift=shift,
        verdict=verdict_line(verdict),
    )


def load_watch(line: StepLine) -> Watch:
    """What the monitor was given when the step started."""
    return Watch(
        step=load_step(line.step),
        index=line.index,
        later=tuple(map(load_step, line.later)),
        gripper=frozenset(line.gripper),
        start_s=line.time,
        start_state=unrows(line.state),
        inherited=unrows(line.inherited),
        assumed=unrows(line.assumed),
        phases=line.phases,
        exit_s=line.exit_s,
        budget_s=line.budget_s,
        grace_s=line.grace_s,
        stall_s=line.stall_s,
        blocked_s=line.blocked_s,
        still_speed=line.still_speed,
        still_turn=line.still_turn,
    )


def tick_line(tick: Tick, before: State, verdict: Verdict, ms: dict[str, float]) -> TickLine:
    """The line of one tick; `before` is the state of the step's previous line."""
    return TickLine(
        time=tick.now_s,
        stage=tick.stage,
        stage_s=tick.stage_s,
        settling=tick.settling,
        closing=tick.closing,
        speed=tick.speed,
        turn=tick.turn,
        rest_s=tick.rest_s,
        added=rows(tick.state - before),
        removed=rows(before - tick.state),
        verdict=verdict_line(verdict),
        ms=ms,
    )


def load_tick(line: TickLine, state: State) -> Tick:
    """What the monitor was given at that tick."""
    return Tick(line.time, state, line.stage, line.stage_s, line.settling, line.closing, line.speed, line.turn, line.rest_s)


def verdict_line(verdict: Verdict) -> VerdictLine:
    """A verdict for JSON."""
    kind = type(verdict).__name__
    match verdict:
        case JumpAhead(index, reason):
            return VerdictLine(kind=kind, reason=reason, index=index)
        case Violation(violation, atoms, blame, reason):
            return VerdictLine(kind=kind, reason=reason, violation=violation.value, atoms=rows(atoms), blame=blame.value)
        case Continue(reason) | EffectsHold(reason):
            return VerdictLine(kind=kind, reason=reason)
        case Stalled(reason, blocked):
            return VerdictLine(kind=kind, reason=reason, blocked=blocked)
        case _:
            return VerdictLine(kind=kind, reason=verdict.reason)
