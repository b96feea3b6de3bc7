"""`symskill replay`: a recorded run step by step, and whether the monitor decides it the same way again."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from symskill_pddl.cli.console import emit_json, remark, say, table
from symskill_pddl.cli.options import JsonFlag
from symskill_pddl.errors import FormatError, InputError

if TYPE_CHECKING:
    from symskill_pddl.execution.lines import GroundStep, PlanLine, StepLine, VerdictLine
    from symskill_pddl.execution.replay import Replayed
    from symskill_pddl.execution.trace import Trace


@dataclass(frozen=True)
class Moment:
    """One row of a replay."""

    time: float
    event: str
    """plan, step, tick, recovery, note or outcome."""
    step: int | None
    """Which of the steps that were carried out, counted from 0 over the whole run."""
    what: str
    verdict: str = ""
    reason: str = ""
    added: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()
    again: str = ""
    """What the monitor decides now, where that is something else."""
    plan: tuple[str, ...] = field(default=())

    def row(self) -> tuple[str, ...]:
        """For people."""
        changes = [f"+ {atom}" for atom in self.added] + [f"- {atom}" for atom in self.removed]
        numbered = [f"{i}: {step}" for i, step in enumerate(self.plan)]
        reason = f"{self.reason}\nDIFFERS, now: {self.again}" if self.again else self.reason
        step = "" if self.step is None else str(self.step)
        return f"{self.time:.2f}", step, "\n".join([self.what, *numbered, *changes]).strip("\n"), self.verdict, reason

    def document(self) -> dict[str, Any]:
        """For programs; what a kind of moment does not have is left out."""
        found: dict[str, Any] = {"time": self.time, "event": self.event}
        for name in ("step", "what", "verdict", "reason", "added", "removed", "again", "plan"):
            value = getattr(self, name)
            if value not in ("", (), None):
                found[name] = list(value) if isinstance(value, tuple) else value
        return found


def replay(
    source: Annotated[Path, typer.Argument(metavar="TRACE", help="trace.jsonl of a run.")],
    step: Annotated[int | None, typer.Option("--step", help="Only this step of the run, counted from 0.")] = None,
    ticks: Annotated[
        bool, typer.Option("--ticks", help="Every control tick, not only those at which something changes.")
    ] = False,
    json: JsonFlag = False,
) -> None:
    """Step through a run, and decide it again with the monitor alone. Exit status 1 if a verdict differs."""
    from symskill_pddl.execution import replay as replaying
    from symskill_pddl.execution.trace import read_trace

    trace = read_trace(source)
    try:
        decisions = replaying.replay(trace)
    except FormatError as error:
        raise FormatError(f"{source}: {error}") from None
    count = len(trace.of("step"))
    if step is not None and not 0 <= step < count:
        has = f"its steps are 0 to {count - 1}" if count else "it has no steps"
        raise InputError(f"--step {step}: the run has no such step; {has}")
    shown = [m for m in moments(trace, decisions, every=ticks) if step is None or m.step == step]
    different = sum(not decision.same for decision in decisions)
    if json:
        emit_json(_document(trace, shown, len(decisions), different))
    else:
        _tell(trace, shown, len(decisions), different)
    for warning in _warnings(trace):
        remark(f"{source}: {warning}")
    if different:
        raise typer.Exit(1)


def moments(trace: Trace, decisions: tuple[Replayed, ...], *, every: bool = False) -> Iterator[Moment]:
    """The run in order: plans, step starts, ticks (all, or those at which atoms or the verdict change), recoveries, notes."""
    again = {d.line: d.again for d in decisions if not d.same}
    number, last = -1, None
    for index, line in enumerate(trace.lines):
        now = _verdict(again[index]) if index in again else ""
        match line.event:
            case "plan":
                yield _plan(line)
            case "step":
                number, last = number + 1, line.verdict
                yield _start(line, number, now)
            case "tick":
                if every or line.added or line.removed or line.verdict != last or now:
                    added, removed = (tuple(map(_atom, atoms)) for atoms in (line.added, line.removed))
                    yield Moment(line.time, "tick", number, "", line.verdict.kind, line.verdict.reason, added, removed, again=now)
                last = line.verdict
            case "recovery":
                yield Moment(line.time, "recovery", None, line.name, line.result, line.reason)
            case "note":
                yield Moment(line.time, "note", None, line.text)
            case "outcome":
                yield Moment(line.time, "outcome", None, "end", line.category, line.reason)


def _plan(line: PlanLine) -> Moment:
    steps = tuple(_atom((name, *args)) for name, args in line.steps)
    reason = "; ".join((line.reason, *line.messages))
    if line.assumed:
        reason += f"; assuming {' '.join(map(_atom, line.assumed))}"
    return Moment(line.time, "plan", None, "plan" if steps else "no steps", line.status, reason, plan=steps)


def _start(line: StepLine, number: int, again: str) -> Moment:
    tried = f", try {line.attempt + 1}" if line.attempt else ""
    moved = ", resampled" if line.shift is not None else ""
    what = f"{_step(line.step)}{tried}{moved}"
    return Moment(line.time, "step", number, what, line.verdict.kind, line.verdict.reason, again=again)


def _step(step: GroundStep) -> str:
    return _atom((step.name, *step.args))


def _atom(row: tuple[str, ...]) -> str:
    return f"({' '.join(row)})"


def _verdict(verdict: VerdictLine) -> str:
    return f"{verdict.kind}, {verdict.reason}"


def _head(trace: Trace) -> str:
    header = trace.header
    off = [name for name in ("monitor", "resampling", "replanning", "tracking", "obstacles") if not getattr(header, name)]
    goal = " ".join(map(_atom, header.goal))
    without = f", without {', '.join(off)}" if off else ""
    where = f" in {header.world}" if header.world else ""
    return f"{header.task or 'a run'}{where}, seed {header.seed}, goal {goal}{without}"


def _warnings(trace: Trace) -> Iterator[str]:
    if trace.note:
        yield trace.note
    elif trace.outcome is None:
        yield "the trace was cut off: the run has no end"


def _finding(trace: Trace, decisions: int, different: int) -> str:
    if not trace.header.monitor:
        return "a run without monitor: nothing to decide again"
    if different:
        return f"{different} of {decisions} decisions differ: the monitor now decides something else"
    return f"the monitor decides all {decisions} the same"


def _tell(trace: Trace, shown: list[Moment], decisions: int, different: int) -> None:
    say(_head(trace))
    if shown:
        table("", ("time [s]", "step", "what", "verdict", "because"), (m.row() for m in shown))
    say(_finding(trace, decisions, different))


def _document(trace: Trace, shown: list[Moment], decisions: int, different: int) -> dict[str, Any]:
    header, outcome = trace.header, trace.outcome
    return {
        **({"world": header.world} if header.world else {}),
        "task": header.task,
        "seed": header.seed,
        "goal": [_atom(row) for row in header.goal],
        "monitor": header.monitor,
        "success": None if outcome is None else outcome.success,
        "complete": outcome is not None and not trace.note,
        "decisions": decisions,
        "different": different,
        "moments": [m.document() for m in shown],
    }
