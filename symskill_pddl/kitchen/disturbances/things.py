"""What is done to the things of the kitchen: shut again, or moved, as by a person's hand and with bounded force."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.random import Generator

from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.disturbances.around import slides
from symskill_pddl.kitchen.disturbances.forces import acting, lead, turning
from symskill_pddl.kitchen.disturbances.kind import Arguments, Doing, Effect, periods
from symskill_pddl.kitchen.judges import covers
from symskill_pddl.kitchen.loose import Lid, Vessel

if TYPE_CHECKING:
    from symskill_pddl.kitchen.world import Kitchen

_SHUTS_IN = 1.5
"""How long a person takes to shut what is fully open [s]."""
_LEADS = 0.25
"""Speed at which a person moves a thing [m/s]."""
_LIFTS = 0.12
"""How high above the higher of its two places a lid is carried [m]."""
_AWAY = 0.2
"""How far the robot's hand has to be for a person to reach in [m]."""


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
    wanted = [name for name, _ in kitchen.spec.goal_at] or kitchen.focus
    return _slid(kitchen, arguments, wanted, rng)


def move_plate(kitchen: Kitchen, arguments: Arguments, rng: Generator) -> Doing | None:
    """A person slides the plate aside, with what lies on it, in a direction that is drawn."""
    return _slid(kitchen, arguments, kitchen.physics.scene.of_type("container"), rng)


def _slid(kitchen: Kitchen, arguments: Arguments, wanted: Sequence[str], rng: Generator) -> Doing | None:
    loose = kitchen.physics.loose
    name = arguments.about or next((name for name in wanted if name in loose), None)
    if name is None or name not in loose or kitchen.physics.robot_touches(name):
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


def put_lid_back(kitchen: Kitchen, _arguments: Arguments, _rng: Generator) -> Doing | None:
    """A person lifts the lid and sets it on the pan, once the robot's hand is away from both."""
    physics = kitchen.physics
    (lid, cover), (pan, dish) = (
        next((name, thing.shape) for name, thing in physics.scene.loose.items() if isinstance(thing.shape, shape))
        for shape in (Lid, Vessel)
    )
    assert isinstance(cover, Lid)
    assert isinstance(dish, Vessel)
    near = min(float(np.linalg.norm(physics.T_world_ee().p - physics.T_world(name).p)) for name in (lid, pan))
    if near < _AWAY or physics.robot_touches(lid) or covers(physics, lid, pan):
        return None
    start, seat = physics.T_world(lid).p, physics.T_world(pan).apply(np.array([0.0, 0.0, dish.rim_z - cover.seat_z]))
    above = np.array([0.0, 0.0, max(start[2], seat[2]) + _LIFTS])
    over = np.array([1.0, 1.0, 0.0])
    path = [start * over + above, seat * over + above, seat + np.array([0.0, 0.0, 0.03]), seat]
    return lead(kitchen, lid, path, [_LEADS, _LEADS, _LEADS, 0.05], strongest=10.0)
