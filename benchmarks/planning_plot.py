"""The planning times as one picture: a panel for each task, a line for each planner, cold and warm. Plain SVG."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import log10

COLOURS = ("#1b6ca8", "#c8553d", "#3a7d44", "#8e5aa8", "#b8860b", "#5f6b73", "#d1495b")
WIDTH, HEIGHT, LEFT, TOP, GAP = 330, 250, 56, 34, 64

Line = Sequence[tuple[float, float]]
"""(things, milliseconds) pairs."""


def svg(panels: Mapping[str, Mapping[str, tuple[Line, Line]]]) -> str:
    """Panels by title; in each, cold and warm lines by planner. Both axes are logarithmic."""
    points = [p for lines in panels.values() for pair in lines.values() for line in pair for p in line]
    sizes = sorted({x for x, _ in points})
    low, high = (10.0 ** f(log10(max(y, 0.05)) for _, y in points) for f in (_floor, _ceil))
    names = list(dict.fromkeys(name for lines in panels.values() for name in lines))
    width, height = LEFT + len(panels) * (WIDTH + GAP), TOP + HEIGHT + 78
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
    ]
    for number, (title, lines) in enumerate(panels.items()):
        left = LEFT + number * (WIDTH + GAP)

        def x(value: float, left: float = left) -> float:
            return left + WIDTH * (log10(value) - log10(sizes[0])) / (log10(sizes[-1]) - log10(sizes[0]))

        def y(value: float) -> float:
            return TOP + HEIGHT * (1.0 - (log10(max(value, low)) - log10(low)) / (log10(high) - log10(low)))

        out.append(f'<text x="{left}" y="{TOP - 12}" font-weight="bold">{title}</text>')
        out += [f'<text x="{x(n):.1f}" y="{TOP + HEIGHT + 16}" text-anchor="middle">{n:g}</text>' for n in sizes]
        decade = low
        while decade <= high * 1.001:
            out.append(f'<path d="M{left} {y(decade):.1f}h{WIDTH}" stroke="#dddddd"/>')
            out.append(f'<text x="{left - 6}" y="{y(decade) + 4:.1f}" text-anchor="end">{decade:g}</text>')
            decade *= 10.0
        for name, pair in lines.items():
            colour = COLOURS[names.index(name) % len(COLOURS)]
            for line, dash in zip(pair, ("", ' stroke-dasharray="5 3"'), strict=True):
                path = " ".join(f"{x(a):.1f},{y(b):.1f}" for a, b in line)
                out.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.8"{dash}/>')
                out += [f'<circle cx="{x(a):.1f}" cy="{y(b):.1f}" r="2.3" fill="{colour}"/>' for a, b in line]
    for i, name in enumerate(names):
        at, colour = LEFT + i * 140, COLOURS[i % len(COLOURS)]
        out.append(f'<path d="M{at} {TOP + HEIGHT + 44}h24" stroke="{colour}" stroke-width="3"/>')
        out.append(f'<text x="{at + 30}" y="{TOP + HEIGHT + 48}">{name}</text>')
    note = "milliseconds over the number of things, both logarithmic; solid: cold, dashed: a warm session"
    out.append(f'<text x="{LEFT}" y="{TOP + HEIGHT + 70}">{note}</text>')
    return "\n".join([*out, "</svg>"]) + "\n"


def _floor(exponents: Iterable[float]) -> int:
    return int(min(exponents) // 1)


def _ceil(exponents: Iterable[float]) -> int:
    return int(-(-max(exponents) // 1))
