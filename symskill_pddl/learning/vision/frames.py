"""A moment of a demonstration as a picture, from its poses alone: seen from above and from the side, every object a named box."""

from __future__ import annotations

import io
from collections.abc import Callable
from itertools import product

import numpy as np

from symskill_pddl.demos import Demo
from symskill_pddl.geometry import Array

Frames = Callable[[Demo, int, str], bytes]
"""Draws sample i of a demonstration, the named object marked, as PNG; a world that can render its recordings offers its own."""

SIZE, MARGIN_M = 420, 0.08
"""Pixels of one view's side; room around the objects [m]."""
DEFAULT_HALF = (0.03, 0.03, 0.03)
_GREY, _RED, _BLUE = (90, 90, 90), (200, 30, 30), (30, 70, 200)


def drawing(demo: Demo, i: int, marked: str) -> bytes:
    """Two orthographic views side by side, x to the right: y upwards from above, z upwards from the side.

    Boxes are drawn as their hulls' outlines, the marked object in red, the hand as a blue cross. The same scale and section for
    all samples of a demonstration, so that what moves is what changes.
    """
    from PIL import Image, ImageDraw
    from scipy.spatial import ConvexHull

    image = Image.new("RGB", (2 * SIZE, SIZE + 20), "white")
    pen = ImageDraw.Draw(image)
    p = np.concatenate([demo.T_world_objects.p.reshape(-1, 3), demo.T_world_ee.p])
    low, high = p.min(axis=0) - MARGIN_M, p.max(axis=0) + MARGIN_M
    scale = SIZE / float((high - low).max())

    def pixels(points: Array, up: int, left: int) -> list[tuple[float, float]]:
        across, rise = scale * (points[:, 0] - low[0]), scale * (points[:, up] - low[up])
        return [(left + float(a), 20 + SIZE - float(r)) for a, r in zip(across, rise, strict=True)]

    for view, (up, title) in enumerate(((1, "from above (x right, y up)"), (2, "from the side (x right, z up)"))):
        left = view * SIZE
        pen.text((left + 6, 4), f"{title}, t = {demo.times[i]:.1f} s", fill=_GREY)
        order = sorted(demo.objects, key=lambda name: name == marked)
        for name in order:
            corners = demo.pose(name)[i].apply(_corners(demo, name))
            outline = pixels(corners, up, left)
            hull = ConvexHull(np.array(outline), qhull_options="QJ").vertices
            colour = _RED if name == marked else _GREY
            pen.polygon([outline[k] for k in hull], outline=colour, width=3 if name == marked else 1)
            middle = pixels(demo.pose(name)[i].p[None], up, left)[0]
            pen.text((middle[0] + 3, middle[1] - 6), name, fill=colour)
        x, y = pixels(demo.T_world_ee[i].p[None], up, left)[0]
        pen.line([(x - 8, y), (x + 8, y)], fill=_BLUE, width=3)
        pen.line([(x, y - 8), (x, y + 8)], fill=_BLUE, width=3)
    buffer = io.BytesIO()
    image.save(buffer, format="PNG")
    return buffer.getvalue()


def _corners(demo: Demo, name: str) -> Array:
    """(8, 3) in the object's frame."""
    half = demo.extents.get(demo.objects[name], DEFAULT_HALF)
    return np.array(list(product((-1.0, 1.0), repeat=3))) * np.array(half)
