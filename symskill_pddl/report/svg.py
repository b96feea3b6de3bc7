"""Line charts as SVG text: no library, no font, no script; the same numbers give the same bytes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""Okabe and Ito: told apart by everybody."""
WIDTH, HEIGHT, LEFT, TOP, RIGHT, BOTTOM = 330, 230, 46, 34, 12, 42
"""Of one chart and its margins [px]."""


@dataclass(frozen=True)
class Line:
    """One curve: its name, and a value with its interval at every tick of the chart."""

    name: str
    values: tuple[float, ...]
    intervals: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Chart:
    """Curves over the same ticks, which lie at equal distances; y runs from `low` to `high`."""

    title: str
    x: str
    ticks: tuple[str, ...]
    lines: tuple[Line, ...]
    low: float = 0.0
    high: float = 1.0


def charts_svg(charts: Sequence[Chart], columns: int = 2) -> str:
    """Charts in rows, with one legend of all their curves below."""
    rows = -(-len(charts) // columns)
    names = list(dict.fromkeys(line.name for chart in charts for line in chart.lines))
    colours = {name: COLOURS[k % len(COLOURS)] for k, name in enumerate(names)}
    width, height = WIDTH * columns, HEIGHT * rows + 18 * (-(-len(names) // columns)) + 10
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
        'font-family="sans-serif" font-size="11">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
    ]
    for k, chart in enumerate(charts):
        parts.append(f'<g transform="translate({WIDTH * (k % columns)} {HEIGHT * (k // columns)})">')
        parts += _chart(chart, colours)
        parts.append("</g>")
    for k, name in enumerate(names):
        x, y = 20 + WIDTH * (k % columns), HEIGHT * rows + 16 + 18 * (k // columns)
        parts.append(f'<line x1="{x}" y1="{y - 4}" x2="{x + 24}" y2="{y - 4}" stroke="{colours[name]}" stroke-width="2"/>')
        parts.append(f'<text x="{x + 30}" y="{y}">{escape(name)}</text>')
    return "\n".join([*parts, "</svg>"]) + "\n"


def _chart(chart: Chart, colours: dict[str, str]) -> Iterator[str]:
    wide, tall = WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM

    def x(k: float) -> float:
        return LEFT + wide * (k + 0.5) / len(chart.ticks)

    def y(value: float) -> float:
        inside = min(max(value, chart.low), chart.high)
        return TOP + tall * (chart.high - inside) / (chart.high - chart.low)

    yield f'<text x="{LEFT}" y="{TOP - 14}" font-weight="bold">{escape(chart.title)}</text>'
    for i in range(5):
        value = chart.low + (chart.high - chart.low) * i / 4
        yield f'<line x1="{LEFT}" y1="{y(value):.1f}" x2="{WIDTH - RIGHT}" y2="{y(value):.1f}" stroke="#ddd"/>'
        yield f'<text x="{LEFT - 6}" y="{y(value) + 4:.1f}" text-anchor="end">{value:.2g}</text>'
    for k, tick in enumerate(chart.ticks):
        yield f'<text x="{x(k):.1f}" y="{TOP + tall + 16}" text-anchor="middle">{escape(tick)}</text>'
    yield f'<text x="{LEFT + wide / 2:.1f}" y="{HEIGHT - 10}" text-anchor="middle">{escape(chart.x)}</text>'
    for j, line in enumerate(chart.lines):
        shift, colour = 0.06 * (j - (len(chart.lines) - 1) / 2), colours[line.name]
        points = " ".join(f"{x(k + shift):.1f},{y(v):.1f}" for k, v in enumerate(line.values))
        yield f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>'
        for k, (value, (low, high)) in enumerate(zip(line.values, line.intervals, strict=True)):
            at = f"{x(k + shift):.1f}"
            yield f'<line x1="{at}" y1="{y(low):.1f}" x2="{at}" y2="{y(high):.1f}" stroke="{colour}"/>'
            yield f'<circle cx="{at}" cy="{y(value):.1f}" r="2.5" fill="{colour}"/>'
