"""Deciding a recorded run again: the same trace has to give the same verdicts through the pure monitor alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from symskill_pddl.errors import FormatError
from symskill_pddl.execution.lines import StepLine, TickLine, VerdictLine, load_tick, load_watch, unrows, verdict_line
from symskill_pddl.execution.monitor import Memory, check_start, judge
from symskill_pddl.execution.trace import Trace
from symskill_pddl.symbols import Atom


@dataclass(frozen=True)
class Replayed:
    """One decision, as recorded and as the monitor decides it again."""

    line: int
    """Index into `Trace.lines`."""
    recorded: VerdictLine
    again: VerdictLine
    same: bool = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "same", self.recorded == self.again)


def replay(trace: Trace) -> tuple[Replayed, ...]:
    """Decide every recorded step start and tick again, with the pure monitor. Empty for a run without monitor.

    Raises
    ------
    FormatError
        A tick comes before any step: lines are missing.
    """
    if not trace.header.monitor:
        return ()
    return tuple(_replay(trace))


def _replay(trace: Trace) -> Iterator[Replayed]:
    watch, state, memory = None, frozenset[Atom](), Memory()
    for number, line in enumerate(trace.lines):
        if isinstance(line, StepLine):
            watch, state, memory = load_watch(line), unrows(line.state), Memory()
            yield Replayed(number, line.verdict, verdict_line(check_start(watch, state)))
        elif isinstance(line, TickLine):
            if watch is None:
                raise FormatError(f"a damaged trace: the tick at {line.time:g} s belongs to no step, lines are missing")
            state = (state - unrows(line.removed)) | unrows(line.added)
            judgement = judge(watch, load_tick(line, state), memory)
            memory = judgement.memory
            yield Replayed(number, line.verdict, verdict_line(judgement.verdict))
