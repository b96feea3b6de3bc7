"""A picture of a predicate: the ellipsoids within which it becomes true, and false again, over the poses it was learned from."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.abstraction import Classifier
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.scene import GRIPPER

SIDE, GAP, TOP = 220, 52, 64
"""Of one view, between views, and above them [px]."""
VIEWS = ((0, 1), (0, 2), (1, 2))
SHOWN = 2.0
"""Views reach this many times as far as the ellipsoid within which the predicate stays true."""
_INSIDE, _OUTSIDE, _ELLIPSE = "#0072b2", "#bbbbbb", "#d55e00"


def predicate_svg(classifier: Classifier, poses: Pose, holds: NDArray[np.bool_], lines: Sequence[str] = ()) -> str:
    """Three views of the position [cm] in the parent's frame, and three of the turn away from the mean [deg].

    Parameters
    ----------
    classifier : Classifier
    poses : Pose (n,)
        `T_parent_child` at the samples to show.
    holds : ndarray of bool (n,)
        Whether the predicate held at each.
    lines : sequence of str
        What stands below the picture: where it comes from, how clear it is.

    Returns
    -------
    str
        SVG. Full line: it becomes true within. Dashed line: it is false again beyond. Blue points: it held.
    """
    dp, dr = classifier.residual(poses)
    mean = 100.0 * classifier.T_mean.p
    child = "gripper" if classifier.child == GRIPPER else classifier.child
    rows = (
        ("position [cm]", 100.0 * dp + mean, mean, 1e4 * classifier.cov_p, classifier.enter_p),
        ("turn [deg]", np.degrees(dr), np.zeros(3), np.degrees(np.degrees(classifier.cov_r)), classifier.enter_r),
    )
    width = GAP + 3 * (SIDE + GAP)
    height = TOP + 2 * (SIDE + GAP) + 16 * len(lines) + 12
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
        'font-family="sans-serif" font-size="11"><!-- symskill -->',
        f'<rect width="{width}" height="{height}" fill="white"/>',
        f'<text x="12" y="22" font-size="15" font-weight="bold">{escape(classifier.predicate.name)}</text>',
        f'<text x="12" y="40">{escape(child)} in the frame of {escape(classifier.parent)}; true within the full line, '
        f"false again beyond the dashed one; {int(holds.sum())} of {len(holds)} samples hold (blue)</text>",
    ]
    for row, (label, points, middle, cov, radius) in enumerate(rows):
        for column, axes in enumerate(VIEWS):
            parts.append(f'<g transform="translate({GAP + column * (SIDE + GAP)} {TOP + row * (SIDE + GAP)})">')
            parts += _view(label, axes, points, middle, cov, radius, classifier.leave_factor, holds)
            parts.append("</g>")
    for k, line in enumerate(lines):
        parts.append(f'<text x="12" y="{TOP + 2 * (SIDE + GAP) + 16 * k}">{escape(line)}</text>')
    return "\n".join([*parts, "</svg>"]) + "\n"


def _view(
    label: str,
    axes: tuple[int, int],
    points: Array,
    middle: Array,
    cov: Array,
    radius: float,
    leave_factor: float,
    holds: NDArray[np.bool_],
) -> Iterator[str]:
    i, j = axes
    # the shadow of an ellipsoid is the ellipse of the covariance's own block
    block = cov[np.ix_(axes, axes)]
    half = SHOWN * leave_factor * radius * float(np.sqrt(np.linalg.eigvalsh(block)[-1]))
    scale = SIDE / (2.0 * half)

    def at(a: float, b: float) -> tuple[float, float]:
        return SIDE / 2 + scale * (a - middle[i]), SIDE / 2 - scale * (b - middle[j])

    yield f'<rect width="{SIDE}" height="{SIDE}" fill="none" stroke="#888"/>'
    for value in (-half / 2, 0.0, half / 2):
        x, y = at(middle[i] + value, middle[j] + value)
        yield f'<text x="{x:.1f}" y="{SIDE + 14}" text-anchor="middle">{middle[i] + value:.1f}</text>'
        yield f'<text x="-4" y="{y + 4:.1f}" text-anchor="end">{middle[j] + value:.1f}</text>'
    yield f'<text x="{SIDE / 2}" y="{SIDE + 30}" text-anchor="middle">{"xyz"[i]} and {"xyz"[j]}, {escape(label)}</text>'
    near = np.all(np.abs(points[:, axes] - middle[list(axes)]) <= half, axis=1)
    for colour, chosen in ((_OUTSIDE, near & ~holds), (_INSIDE, near & holds)):
        for a, b in points[chosen][:, axes].tolist():
            x, y = at(a, b)
            yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="1.6" fill="{colour}"/>'
    angles = np.linspace(0.0, 2 * np.pi, 60)
    rim = np.linalg.cholesky(block) @ np.stack([np.cos(angles), np.sin(angles)])
    for factor, dash in ((radius, ""), (radius * leave_factor, ' stroke-dasharray="5 4"')):
        outline = " ".join("{:.1f},{:.1f}".format(*at(middle[i] + factor * a, middle[j] + factor * b)) for a, b in rim.T.tolist())
        yield f'<polygon points="{outline}" fill="none" stroke="{_ELLIPSE}" stroke-width="1.5"{dash}/>'
