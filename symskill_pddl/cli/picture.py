"""The picture of a predicate, drawn from a library and the demonstrations that lie in it."""

from __future__ import annotations

import numpy as np

from symskill_pddl.abstraction import abstract_recording, groundings
from symskill_pddl.describe import geometry_lines, support_lines
from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.files import Output
from symskill_pddl.geometry import Pose
from symskill_pddl.library import Library
from symskill_pddl.report import predicate_svg

POINTS = 600
"""No more samples than this are drawn, evenly thinned."""


def draw_predicate(library: Library, name: str, output: Output) -> None:
    """Write the picture of a learned predicate as SVG.

    Raises
    ------
    InputError
        If there is no such predicate, the library holds no demonstrations, or the file is to be something else than SVG.
    """
    path = output.path
    if path.suffix.lower() != ".svg":
        raise InputError(f"'{path}': pictures of predicates are SVG, a name that ends in .svg is needed")
    classifier = next((c for c in library.classifiers if c.predicate.name == name), None)
    if classifier is None:
        known = alternatives(c.predicate.name for c in library.classifiers)
        raise InputError(f"'{name}' is no learned predicate, so there is nothing to draw; the library has: {known}")
    poses, holds = _samples(library, name)
    if not len(holds):
        raise InputError(f"the library holds no demonstration that shows '{name}'")
    margins = classifier.margin(poses[np.flatnonzero(holds)]) if holds.any() else np.zeros(0)
    lines = [*geometry_lines(classifier), *support_lines(library, name)]
    if len(margins):
        low, middle = np.quantile(margins, [0.05, 0.5])
        lines.append(
            f"margin while it holds: {middle:.2f} in the middle, {low:.2f} at the lowest 5 % (1 at the mean, 0 on the full line)"
        )
    output.write(predicate_svg(classifier, poses, holds, lines).encode())


def _samples(library: Library, name: str) -> tuple[Pose, np.ndarray[tuple[int], np.dtype[np.bool_]]]:
    """Relative poses and truth of the predicate over all demonstrations, thinned."""
    from symskill_pddl.demos import decode_demos

    classifier = next(c for c in library.classifiers if c.predicate.name == name)
    poses, holds = [], []
    for source, content in sorted(library.recordings.items()):
        for demo in decode_demos(content, source):
            truth = abstract_recording(demo, [classifier], library.gripper)
            for atom, parent, child in groundings(classifier, demo.objects):
                known = demo.sees(parent) & demo.sees(child)
                poses.append((demo.pose(parent).inverse() @ demo.pose(child))[known])
                holds.append(truth.get(atom, np.zeros(len(demo), dtype=bool))[known])
    if not poses:
        return Pose(np.zeros((0, 3)), np.zeros((0, 4))), np.zeros(0, dtype=bool)
    T = Pose(np.concatenate([p.p for p in poses]), np.concatenate([p.q for p in poses]))
    truth_of = np.concatenate(holds)
    # the thinning keeps as many that hold as that do not
    index = [
        rows[np.linspace(0, len(rows) - 1, min(len(rows), POINTS // 2)).astype(int)]
        for v in (True, False)
        if len(rows := np.flatnonzero(truth_of == v))
    ]
    chosen = np.sort(np.concatenate(index))
    return T[chosen], truth_of[chosen]
