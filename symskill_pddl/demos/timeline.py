"""A picture of recordings: when which object is seen and moves, the fingers and their command, and where learning cuts.

SVG as text: no library, no font, no script; the same recordings give the same bytes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from symskill_pddl.demos.demo import Demo
from symskill_pddl.demos.inspection import Inspection, Span

WIDTH, LEFT, RIGHT, ROW, FINGERS, TITLE, GAP = 1000, 130, 20, 18, 54, 44, 16
"""Of the picture, its margins, one object's row, the fingers' row, a recording's title and what is below it [px]."""
MOST_TICKS = 12
RESTS, MOVES, UNSEEN, FROZEN, LINE, COMMAND, CUT, NO_TIME = (
    "#dfe5ea",
    "#0072b2",
    "#ffffff",
    "#e69f00",
    "#333333",
    "#f5cfb8",
    "#a03070",
    "#eeeeee",
)
LEGEND = (
    (RESTS, "rests"),
    (MOVES, "moves"),
    (UNSEEN, "not seen"),
    (FROZEN, "tracker frozen"),
    (COMMAND, "told to close"),
    (CUT, "cut"),
)


@dataclass(frozen=True)
class Cut:
    """One episode as learning sees it: seconds since the beginning, and what it is about."""

    start_s: float
    stop_s: float
    label: str


def timeline_svg(demos: Sequence[Demo], inspections: Sequence[Inspection], cuts: Mapping[str, Sequence[Cut]]) -> str:
    """Recordings one below the other, each on its own clock; `cuts` by `Demo.where`."""
    heights = [TITLE + FINGERS + ROW * len(found.tracks) + 22 + GAP for found in inspections]
    height = 34 + sum(heights)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" height="{height}" '
        'font-family="sans-serif" font-size="11">',
        f'<rect width="{WIDTH}" height="{height}" fill="white"/>',
        *_legend(),
    ]
    top = 34
    for demo, found, tall in zip(demos, inspections, heights, strict=True):
        parts.append(f'<g transform="translate(0 {top})">')
        parts += _panel(demo, found, cuts.get(found.where, ()))
        parts.append("</g>")
        top += tall
    return "\n".join([*parts, "</svg>"]) + "\n"


def _legend() -> Iterator[str]:
    for k, (colour, text) in enumerate(LEGEND):
        x = 20 + 130 * k
        yield f'<rect x="{x}" y="10" width="14" height="10" fill="{colour}" stroke="#999999"/>'
        yield f'<text x="{x + 20}" y="19">{text}</text>'


def _panel(demo: Demo, found: Inspection, cuts: Sequence[Cut]) -> Iterator[str]:
    scale = (WIDTH - LEFT - RIGHT) / max(found.clock.duration_s, 1e-9)

    def at(seconds: float) -> float:
        return round(LEFT + scale * seconds, 1)

    def bars(spans: Sequence[Span], y: float, tall: float, colour: str) -> Iterator[str]:
        for start, stop in spans:
            wide = max(round(scale * (stop - start), 1), 1.0)
            yield f'<rect x="{at(start)}" y="{y}" width="{wide}" height="{tall}" fill="{colour}"/>'

    clock = found.clock
    title = f"{found.where} - {found.task}: {clock.duration_s:.1f} s, {clock.rate_hz:.3g} samples per second"
    yield f'<text x="20" y="16" font-size="13" font-weight="bold">{escape(title)}</text>'
    y = TITLE
    for track in found.tracks:
        yield f'<text x="{LEFT - 8}" y="{y + 12}" text-anchor="end">{escape(_short(track.name))}</text>'
        yield from bars([(0.0, clock.duration_s)], y + 2, ROW - 5, RESTS)
        yield from bars(track.moves, y + 2, ROW - 5, MOVES)
        yield from bars(track.unseen, y + 2, ROW - 5, UNSEEN)
        yield from bars(track.frozen, y + 2, ROW - 5, FROZEN)
        yield f'<rect x="{LEFT}" y="{y + 2}" width="{WIDTH - LEFT - RIGHT}" height="{ROW - 5}" fill="none" stroke="#bbbbbb"/>'
        y += ROW
    yield from _fingers(demo, found, y, at)
    yield from bars(clock.gaps, TITLE, y + FINGERS - TITLE, NO_TIME)
    y += FINGERS
    yield from _axis(clock.duration_s, y, at)
    for k, cut in enumerate(cuts):
        for seconds in (cut.start_s, cut.stop_s):
            yield f'<line x1="{at(seconds)}" y1="{TITLE - 4}" x2="{at(seconds)}" y2="{y}" stroke="{CUT}" stroke-dasharray="4 3"/>'
        text = escape(_short(cut.label, 40))
        yield f'<text x="{at(cut.start_s) + 3}" y="{TITLE - (6 if k % 2 else 17)}" fill="{CUT}">{text}</text>'


def _fingers(demo: Demo, found: Inspection, y: float, place: Callable[[float], float]) -> Iterator[str]:
    closed = np.flatnonzero(np.diff(np.concatenate([[0], demo.gripper_closed.astype(int), [0]]))).reshape(-1, 2)
    times = np.append(demo.times, demo.times[-1]) - demo.times[0]
    for a, b in closed:
        left, right = place(float(times[a])), place(float(times[b]))
        yield f'<rect x="{left}" y="{y + 4}" width="{round(right - left, 1)}" height="{FINGERS - 8}" fill="{COMMAND}"/>'
    widest = max(found.grip.widest_m, 1e-6)
    # a picture needs no more points than it has columns
    rows = np.unique(np.linspace(0, len(demo) - 1, min(len(demo), WIDTH)).astype(int))
    points = " ".join(
        f"{place(float(times[i]))},{y + FINGERS - 6 - (FINGERS - 14) * demo.aperture[i] / widest:.1f}" for i in rows
    )
    yield f'<polyline points="{points}" fill="none" stroke="{LINE}"/>'
    yield f'<text x="{LEFT - 8}" y="{y + 14}" text-anchor="end">{100 * widest:.1f} cm</text>'
    yield f'<text x="{LEFT - 8}" y="{y + 32}" text-anchor="end">fingers</text>'


def _axis(duration_s: float, y: float, place: Callable[[float], float]) -> Iterator[str]:
    step = next(
        (s for s in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 3600) if duration_s / s <= MOST_TICKS), duration_s
    )
    yield f'<line x1="{LEFT}" y1="{y}" x2="{WIDTH - RIGHT}" y2="{y}" stroke="{LINE}"/>'
    for k in range(int(duration_s / step + 1e-9) + 1):
        x = place(k * step)
        yield f'<line x1="{x}" y1="{y}" x2="{x}" y2="{y + 4}" stroke="{LINE}"/>'
        yield f'<text x="{x}" y="{y + 15}" text-anchor="middle">{k * step:g} s</text>'


def _short(name: str, most: int = 18) -> str:
    return name if len(name) <= most else f"{name[: most - 1]}…"
