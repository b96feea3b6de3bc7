"""`Journal`: everything that happens in a run, for the trace, for listeners and for the outcome."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from symskill_pddl.execution.lines import RecoveryLine
from symskill_pddl.execution.monitor import Verdict
from symskill_pddl.execution.outcome import Cause, StepRecord
from symskill_pddl.execution.trace import TraceWriter
from symskill_pddl.symbols import GroundOperator


class Journal:
    """Collects what happens; `trace` and `on_event` may be absent."""

    def __init__(self, trace: TraceWriter | None, on_event: Callable[[Any], None] | None) -> None:
        self._trace, self._on_event = trace, on_event
        self.steps: list[StepRecord] = []
        self.used: set[str] = set()
        """The objects of all steps so far."""
        self.recoveries: list[str] = []
        self.troubles: list[Cause] = []
        """What went wrong in the steps, in order."""
        self.plan_seconds: list[float] = []
        self.ticks: list[dict[str, float]] = []
        """Duration of the stages of every tick [ms]."""

    @property
    def listens(self) -> bool:
        """Whether anybody wants lines; building them costs time in every tick."""
        return self._trace is not None or self._on_event is not None

    def emit(self, line: Any) -> None:
        """One line of the trace."""
        if self._trace is not None:
            self._trace.write(line)
        if self._on_event is not None:
            self._on_event(line)

    def recovered(self, name: str, reason: str, result: str, begin_s: float) -> None:
        """A general recovery that began at `begin_s` is over."""
        self.recoveries.append(name)
        self.emit(RecoveryLine(time=begin_s, name=name, reason=reason, result=result))

    def ran(self, step: GroundOperator, start_s: float, stop_s: float, verdict: Verdict, attempt: int) -> None:
        """A step has ended."""
        self.used.update(step.args)
        self.steps.append(StepRecord(str(step), start_s, stop_s, type(verdict).__name__, verdict.reason, attempt))
