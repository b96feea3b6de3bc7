"""Wall-clock times of a run: every stage of every tick, and every call of the planner. Standard library only."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

STAGES = ("observe", "abstract", "monitor", "skill", "obstacles", "controller")
"""What a tick consists of. A simulator's own time (`world`) and the writing of the trace (`trace`) are measured and are no part
of it."""
TICK = "tick"
"""Name of the sum of the `STAGES`."""
FIRST, AGAIN = "first plan", "replanning"
"""Names of the calls of the planner; the first one may have to load the domain."""


@dataclass(frozen=True)
class Spread:
    """Of n measurements [ms]: median, 95th percentile, longest."""

    n: int
    p50: float
    p95: float
    max: float

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """Of at least one measurement."""
        return cls(len(values), *(round(percentile(values, p), 4) for p in (50, 95, 100)))


def percentile(values: Sequence[float], percent: float) -> float:
    """The smallest value with at least `percent` of all values at or below it (nearest rank)."""
    ordered = sorted(values)
    return ordered[max(0, math.ceil(percent / 100 * len(ordered)) - 1)]


def spreads(ticks: Iterable[Mapping[str, float]], plan_seconds: Sequence[float]) -> dict[str, Spread]:
    """Of the tick as a whole, of each of its stages, of what came beside it, and of planning; only what was measured.

    Parameters
    ----------
    ticks : iterable of mapping
        Stage to duration [ms], for every tick.
    plan_seconds : sequence of float
        Duration of every call of the planner [s], in order.
    """
    found: dict[str, list[float]] = {TICK: []}
    for tick in ticks:
        found[TICK].append(sum(tick.get(stage, 0.0) for stage in STAGES))
        for name, value in tick.items():
            found.setdefault(name, []).append(value)
    found[FIRST], found[AGAIN] = [1e3 * s for s in plan_seconds[:1]], [1e3 * s for s in plan_seconds[1:]]
    order = (TICK, *STAGES, *sorted(found.keys() - {TICK, *STAGES, FIRST, AGAIN}), FIRST, AGAIN)
    return {name: Spread.of(found[name]) for name in order if found.get(name)}
