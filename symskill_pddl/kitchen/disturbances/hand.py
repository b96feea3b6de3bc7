"""What is done to the robot's hand: pushed, forced open, or something put in its way."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.random import Generator

from symskill_pddl.geometry import Array
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.disturbances.around import carried, room
from symskill_pddl.kitchen.disturbances.forces import acting, pushing
from symskill_pddl.kitchen.disturbances.kind import Arguments, Doing, periods

if TYPE_CHECKING:
    from symskill_pddl.kitchen.world import Kitchen

_MOVES = 0.1
"""Speed from which on the hand is under way [m/s]."""
_FREE = 0.16
"""Distance kept from what the task is about [m]: an obstacle at the goal itself would leave nothing to go around for."""


def push(kitchen: Kitchen, arguments: Arguments, rng: Generator) -> Doing:
    """Someone bumps into the hand, from a side that is drawn."""
    angle = float(rng.uniform(0.0, 2.0 * np.pi))
    force = arguments["N"] * np.array([np.cos(angle), np.sin(angle), 0.0])
    with acting(kitchen.physics, pushing(kitchen.physics, force)):
        yield from periods(kitchen, arguments["s"])


def drop(kitchen: Kitchen, arguments: Arguments, _: Generator) -> Doing | None:
    """The fingers lose the thing that they carry: they are forced open for a moment, whatever the command."""
    return _forced_open(kitchen, arguments["s"]) if carried(kitchen.physics) else None


def _forced_open(kitchen: Kitchen, seconds: float) -> Doing:
    for _ in periods(kitchen, seconds):
        kitchen.forced_open = True
        yield


def obstacle(kitchen: Kitchen, arguments: Arguments, rng: Generator) -> Doing | None:
    """A ball is held in the way of the moving hand, and taken away after a while.

    It is ahead of the hand, beside its path by a part of its radius that is drawn, where there is room for it, and away from
    what the task is about.
    """
    physics = kitchen.physics
    v = physics.hand_velocity()
    speed = float(np.linalg.norm(v))
    if speed < _MOVES:
        return None
    across = rng.standard_normal(3)
    across -= (across @ v) / (v @ v) * v
    across *= 0.25 * layout.OBSTACLE_RADIUS / np.linalg.norm(across)
    p = np.asarray(physics.T_world_ee().p + arguments["m"] / speed * v + across)
    goals = [physics.T_world(name).apply(layout.PARTS[name].grip) for name in kitchen.focus if name in layout.PARTS]
    goals += [physics.T_world(name).p for name in kitchen.focus if name in physics.loose]
    near = any(np.linalg.norm(p - goal) < _FREE for goal in goals)
    if near or not room(physics, p, layout.OBSTACLE_RADIUS + 0.01):
        return None
    return _in_the_way(kitchen, p, arguments["s"])


def _in_the_way(kitchen: Kitchen, p: Array, seconds: float) -> Doing:
    kitchen.physics.put_obstacle(p)
    try:
        yield from periods(kitchen, seconds)
    finally:
        kitchen.physics.put_obstacle(layout.OBSTACLE_PARKED)
