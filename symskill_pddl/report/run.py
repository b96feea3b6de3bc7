"""A trace as a story: plans, attempts with their verdicts, disturbances, recoveries, timing. Plain data, no markup."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from symskill_pddl.execution.lines import NoteLine, PlanLine, RecoveryLine, Row, StepLine, TickLine, VerdictLine
from symskill_pddl.execution.timing import AGAIN, FIRST, STAGES, TICK, spreads
from symskill_pddl.execution.trace import Trace

TONES = {
    "EffectsHold": "good",
    "JumpAhead": "skip",
    "Violation": "bad",
    "Stalled": "warn",
    "OverTime": "warn",
}
"""How an attempt's last verdict is coloured; anything else is neutral."""

_WORDS = {
    "EffectsHold": "done",
    "JumpAhead": "jumped ahead",
    "Violation": "violation",
    "Stalled": "stalled",
    "OverTime": "over time",
}


@dataclass(frozen=True)
class PlanView:
    """A call of the planner."""

    number: int
    time: float
    reason: str
    status: str
    steps: tuple[str, ...]
    ms: float
    messages: tuple[str, ...]


@dataclass(frozen=True)
class AttemptView:
    """One execution of one step."""

    number: int
    plan: int
    """Number of the plan it belongs to, 0 if there was none."""
    step: str
    start: float
    end: float
    attempt: int
    """How often this ground step had failed before."""
    resampled: bool
    verdict: str
    tone: str
    reason: str
    blame: str
    atoms: str


@dataclass(frozen=True)
class EventView:
    """Something that happened at a time: a disturbance or a recovery."""

    time: float
    kind: str
    text: str


@dataclass(frozen=True)
class TimingView:
    """Wall-clock times of one kind [ms]."""

    name: str
    count: int
    median: float
    p95: float
    longest: float


@dataclass(frozen=True)
class GoalView:
    """One goal atom, and whether it held when the trace ended."""

    atom: str
    holds: bool


@dataclass(frozen=True)
class RunView:
    """All that the page of a run tells."""

    task: str
    seed: int
    planner: str
    monitor: bool
    success: bool | None
    """None where the trace ends without an outcome."""
    category: str
    reason: str
    duration_s: float
    replans: int
    recoveries: int
    goal: tuple[GoalView, ...]
    objects: tuple[tuple[str, str], ...]
    plans: tuple[PlanView, ...]
    attempts: tuple[AttemptView, ...]
    events: tuple[EventView, ...]
    timing: tuple[TimingView, ...]
    note: str


def view_run(trace: Trace) -> RunView:
    """Tell a trace. A trace that was cut off is told as far as it goes."""
    header, outcome = trace.header, trace.outcome
    plans: list[PlanView] = []
    attempts: list[AttemptView] = []
    events: list[EventView] = []
    open_step: StepLine | None = None
    last_tick: TickLine | None = None
    state: frozenset[Row] = frozenset()
    end = 0.0

    def close(now: float) -> None:
        nonlocal open_step, last_tick
        if open_step is not None:
            stop = last_tick.time if last_tick else now
            attempts.append(_attempt(len(attempts) + 1, len(plans), open_step, last_tick, stop))
        open_step = last_tick = None

    for line in trace.lines:
        end = max(end, line.time)
        if isinstance(line, TickLine):
            last_tick = line
            state = (state - frozenset(line.removed)) | frozenset(line.added)
        elif isinstance(line, StepLine):
            close(line.time)
            open_step, state = line, frozenset(line.state)
        elif isinstance(line, PlanLine):
            close(line.time)
            state = frozenset(line.state)
            steps = tuple(_atom((name, *args)) for name, args in line.steps)
            plans.append(PlanView(len(plans) + 1, line.time, line.reason, line.status, steps, 1e3 * line.seconds, line.messages))
        elif isinstance(line, RecoveryLine):
            close(line.time)
            text = f"{line.name}: {line.reason}" + (f" ({line.result})" if line.result else "")
            events.append(EventView(line.time, "recovery", text))
        elif isinstance(line, NoteLine):
            events.append(EventView(line.time, "note", line.text))
        else:
            close(line.time)
    close(end)
    return RunView(
        task=f"{header.task} in {header.world}" if header.world else header.task,
        seed=header.seed,
        planner=header.planner,
        monitor=header.monitor,
        success=outcome.success if outcome else None,
        category=outcome.category if outcome else "",
        reason=outcome.reason if outcome else "the trace ends without an outcome",
        duration_s=end,
        replans=outcome.replans if outcome else max(0, len(plans) - 1),
        recoveries=outcome.recoveries if outcome else sum(e.kind == "recovery" for e in events),
        goal=tuple(GoalView(_atom(row), row in state) for row in header.goal),
        objects=tuple(sorted(header.objects.items())),
        plans=tuple(plans),
        attempts=tuple(attempts),
        events=tuple(events),
        timing=_timing(trace),
        note=trace.note,
    )


def _attempt(number: int, plan: int, line: StepLine, tick: TickLine | None, stop: float) -> AttemptView:
    # a step that may not start has its verdict on the line of the step itself; without a monitor no step has another
    verdict: VerdictLine = tick.verdict if tick is not None else line.verdict
    ran = tick is not None or verdict.kind == "Continue"
    return AttemptView(
        number=number,
        plan=plan,
        step=_atom((line.step.name, *line.step.args)),
        start=line.time,
        end=max(line.time, stop) if ran else line.time,
        attempt=line.attempt,
        resampled=line.shift is not None,
        verdict=_WORDS.get(verdict.kind, "interrupted" if tick is not None else "not judged"),
        tone=TONES.get(verdict.kind, "idle"),
        reason=verdict.reason,
        blame=verdict.blame or "",
        atoms=" ".join(map(_atom, verdict.atoms)),
    )


def _timing(trace: Trace) -> tuple[TimingView, ...]:
    found = spreads((line.ms for line in trace.of("tick") if line.ms), [line.seconds for line in trace.of("plan")])
    return tuple(TimingView(_named(name), s.n, s.p50, s.p95, s.max) for name, s in found.items())


def _named(name: str) -> str:
    if name in (FIRST, AGAIN):
        return name
    if name == TICK:
        return f"tick: {' + '.join(STAGES)}"
    return name if name in STAGES else f"{name} (beside the tick)"


def _atom(row: Iterable[str]) -> str:
    return "(" + " ".join(row) + ")"
