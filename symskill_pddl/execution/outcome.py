"""What a run came to, and how long its parts took."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from symskill_pddl.symbols import State


class Category(StrEnum):
    """How a run ended."""

    SUCCESS = "success"
    UNREACHABLE = "goal unreachable"
    PLANNER = "planner failed"
    REPLANS = "replan limit"
    TIME = "time limit"
    MISSED = "goal missed"
    """Without monitor, or without planning again: the plan is over or was left, and the goal does not hold."""


@dataclass(frozen=True)
class StepRecord:
    """One execution of a step: when [s], and the verdict that ended it."""

    step: str
    start_s: float
    stop_s: float
    verdict: str
    reason: str
    attempt: int
    """0 at the first try; otherwise how often it had been blamed."""


@dataclass(frozen=True)
class Outcome:
    """The result of `execute`.

    Attributes
    ----------
    success, category, reason
        Whether the goal atoms hold, how the run ended, and why in words.
    replans : int
        Calls of the planner after the first plan was given up.
    steps : tuple of StepRecord
    recoveries : tuple of str
        Names of the general recoveries, in order.
    time_s : float
        Duration in the world's time [s].
    plan_seconds : tuple of float
        Wall-clock time of every planner call [s].
    tick_ms : dict of str to float
        Percentiles of the loop's own wall-clock time per tick, without the world's [ms]: p50, p95, p99, max, and the mean of
        each part.
    state : State
        The atoms at the end.
    """

    success: bool
    category: Category
    reason: str
    replans: int
    steps: tuple[StepRecord, ...]
    recoveries: tuple[str, ...]
    time_s: float
    plan_seconds: tuple[float, ...]
    tick_ms: dict[str, float]
    state: State


class Stopwatch:
    """Collects the wall-clock times of the loop's parts [ms]."""

    OWN = ("abstract", "monitor", "skill")
    """The parts that are the loop's own; the world's step is not."""

    def __init__(self) -> None:
        self._ticks: list[dict[str, float]] = []

    def add(self, parts: dict[str, float]) -> None:
        """One tick's parts."""
        self._ticks.append(parts)

    def summary(self) -> dict[str, float]:
        """Percentiles of the sum of the own parts, and the mean of every part."""
        if not self._ticks:
            return {}
        own = [sum(t.get(name, 0.0) for name in self.OWN) for t in self._ticks]
        found = {f"p{q}": _round(float(np.percentile(own, q))) for q in (50, 95, 99)}
        found["max"] = _round(max(own))
        for name in sorted({name for t in self._ticks for name in t}):
            found[name] = _round(_mean([t[name] for t in self._ticks if name in t]))
        return found


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)


def _round(value: float) -> float:
    return round(float(value), 4)
