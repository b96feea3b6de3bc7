"""What is done to the poses that the robot sees. The judge, and everything else of the simulator, sees the true ones."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np
from numpy.random import Generator

from symskill_pddl.geometry import Pose, quat_exp, quat_multiply
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.disturbances.kind import Arguments, Doing, periods

if TYPE_CHECKING:
    from symskill_pddl.kitchen.world import Kitchen

View = Callable[[Pose], Pose]
"""From the poses (n,) of the scene's objects to those that are seen."""


@contextmanager
def _seen_through(kitchen: Kitchen, view: View) -> Iterator[None]:
    kitchen.views.append(view)
    try:
        yield
    finally:
        kitchen.views.remove(view)


def freeze(kitchen: Kitchen, arguments: Arguments, _: Generator) -> Doing | None:
    """The estimate of an object's pose stays where it is: of the one named, or of the first of the task that moves."""
    moving = [name for name in kitchen.focus if name in layout.PARTS or name in kitchen.physics.loose]
    name = arguments.about or next(iter(moving), None)
    return None if name is None else _frozen(kitchen, name, arguments["s"])


def _frozen(kitchen: Kitchen, name: str, seconds: float) -> Doing:
    scene = kitchen.observe()
    row, kept = list(scene.objects).index(name), scene.pose(name)

    def view(T: Pose) -> Pose:
        p, q = np.array(T.p), np.array(T.q)
        p[row], q[row] = kept.p, kept.q
        return Pose(p, q)

    with _seen_through(kitchen, view):
        yield from periods(kitchen, seconds)


def noise(kitchen: Kitchen, arguments: Arguments, rng: Generator) -> Doing:
    """Every estimate is off by a normal error, new in every control period: standard deviations per axis."""
    n = len(kitchen.observe().objects)
    shift, turn = np.zeros((n, 3)), np.zeros((n, 3))

    def view(T: Pose) -> Pose:
        return Pose(T.p + shift, quat_multiply(quat_exp(turn), T.q))

    with _seen_through(kitchen, view):
        for _ in periods(kitchen, arguments["s"]):
            shift[:] = arguments["m"] * rng.standard_normal((n, 3))
            turn[:] = arguments["rad"] * rng.standard_normal((n, 3))
            yield
