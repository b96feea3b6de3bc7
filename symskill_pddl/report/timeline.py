"""The geometry of a run's timeline: a row for each ground step, a bar for each attempt, lines for plans and events."""

from __future__ import annotations

from dataclasses import dataclass

from symskill_pddl.report.run import RunView

ROW, LABEL, RIGHT, TOP, WIDTH = 26.0, 350.0, 20.0, 34.0, 1080.0
"""Pixels: height of a row, width of the labels, margins, width of the whole."""
_STEPS_S = (0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600)


@dataclass(frozen=True)
class Bar:
    """One attempt."""

    x: float
    y: float
    width: float
    tone: str
    title: str


@dataclass(frozen=True)
class Line:
    """A vertical line over all rows: a plan, a note or a recovery."""

    x: float
    kind: str
    label: str
    title: str


@dataclass(frozen=True)
class Timeline:
    """Everything the drawing needs, in pixels."""

    width: float
    height: float
    left: float
    top: float
    bottom: float
    rows: tuple[tuple[str, float], ...]
    """(step, top of its row)."""
    bars: tuple[Bar, ...]
    lines: tuple[Line, ...]
    ticks: tuple[tuple[float, str], ...]


def timeline(run: RunView) -> Timeline:
    """Lay out a run. Rows are in the order in which the steps were first tried."""
    span = max([run.duration_s, *(a.end for a in run.attempts), 1e-3])
    scale = (WIDTH - LABEL - RIGHT) / span

    def x(time: float) -> float:
        return round(LABEL + time * scale, 2)

    rows = {step: TOP + ROW * i for i, step in enumerate(dict.fromkeys(a.step for a in run.attempts))}
    bars = tuple(
        Bar(
            x(a.start),
            rows[a.step],
            max(2.5, round((a.end - a.start) * scale, 2)),
            a.tone,
            f"{a.step}, {a.start:.1f} to {a.end:.1f} s, {a.verdict}: {a.reason}",
        )
        for a in run.attempts
    )
    lines = [Line(x(p.time), "plan", str(p.number), f"plan {p.number} at {p.time:.1f} s: {p.reason}") for p in run.plans]
    lines += [Line(x(e.time), e.kind, "", f"{e.kind} at {e.time:.1f} s: {e.text}") for e in run.events]
    step = next((s for s in _STEPS_S if span / s <= 12), 1200)
    ticks = tuple((x(step * i), f"{step * i:g} s") for i in range(int(span / step) + 1))
    bottom = TOP + ROW * max(1, len(rows))
    return Timeline(WIDTH, bottom + 26, LABEL, TOP, bottom, tuple(rows.items()), bars, tuple(lines), ticks)
