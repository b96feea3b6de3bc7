"""What is done to the things of the kitchen: shut again, or moved, as by a person's hand and with bounded force."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.random import Generator

from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.disturbances.around import slides
from symskill_pddl.kitchen.disturbances.forces import acting, lead, turning
from symskill_pddl.kitchen.disturbances.kind import Arguments, Doing, Effect, periods

if TYPE_CHECKING:
    from symskill_pddl.kitchen.world import Kitchen

_SHUTS_IN = 1.5
"""How long a person takes to shut what is fully open [s]."""
_LEADS = 0.25
"""Speed at which a person moves a thing [m/s]."""


def close(part: str) -> Effect:
    """A person shuts a part, or turns it off: from when it counts as open until it counts as shut, at an even speed."""
    joint = layout.PARTS[part]
    unit = "Nm" if joint.joint == "hinge" else "N"

    def effect(kitchen: Kitchen, arguments: Arguments, _: Generator) -> Doing | None:
        if kitchen.physics.position(part) < joint.opened:
            return None
        return shutting(kitchen, arguments[unit], arguments["s"])

    def shutting(kitchen: Kitchen, strongest: float, seconds: float) -> Doing:
        physics = kitchen.physics
        with acting(physics, turning(physics, part, -joint.travel / _SHUTS_IN, strongest)):
            for _ in periods(kitchen, seconds):
                if physics.position(part) <= 0.1 * joint.shut:
                    return
                yield

    return effect


def shift(kitchen: Kitchen, arguments: Arguments, rng: Generator) -> Doing | None:
    """A person slides the thing that the task is about aside, while the robot does not hold it, in a direction that is drawn."""
    movable = kitchen.physics.loose
    name = arguments.about or next((name for name in kitchen.focus if name in movable), None)
    if name is None or name not in movable or kitchen.physics.robot_touches(name):
        return None
    return slide(kitchen, name, arguments["m"], rng)


def slide(kitchen: Kitchen, name: str, distance: float, rng: Generator) -> Doing | None:
    """Slide a loose thing along what it stands on; None where it has no room in any direction that was drawn."""
    start = kitchen.physics.T_world(name).p
    for angle in float(rng.uniform(0.0, 2.0 * np.pi)) + np.pi / 4.0 * np.arange(8):
        target = start + distance * np.array([np.cos(angle), np.sin(angle), 0.0])
        if slides(kitchen.physics, name, target):
            return lead(kitchen, name, [target], [_LEADS], strongest=10.0)
    return None
