"""What the judges of the tasks are made of: questions about the simulator's own state. Learned controllers never see them."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

import numpy as np

from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.episode import INSIDE_FLOOR
from symskill_pddl.kitchen.layout import Box
from symskill_pddl.kitchen.loose import Lid, Vessel

if TYPE_CHECKING:
    from symskill_pddl.kitchen.physics import Physics

Shape = TypeVar("Shape", Vessel, Lid)

AT_REST = 0.01
"""Speed below which a thing is at rest [m/s]."""
HAND_AWAY = 0.08
"""Least distance from the grip point to a thing that was let go of [m]."""
COUNTER_REGION = Box((0.42, 0.0, 0.025), (0.20, 0.55, 0.025))
"""Where a food counts as being on the counter (world): what the arm reaches of it."""
SEATED_M, SEATED_RAD = 0.003, np.radians(2.0)
"""How high and how tilted a lid in its seat may be; one that missed it is 4 to 6 mm high and tilted by 3 to 4 deg."""


def hand_off(physics: Physics, part: str) -> bool:
    """The hand touches the part nowhere and does not enclose what it is taken by."""
    grip = physics.T_world(part).apply(layout.PARTS[part].grip)
    return not physics.robot_touches(part) and float(np.linalg.norm(physics.T_world_ee().p - grip)) > HAND_AWAY


def is_open(physics: Physics, part: str) -> bool:
    """The part is open far enough and let go of."""
    return physics.position(part) >= layout.PARTS[part].opened and hand_off(physics, part)


def is_shut(physics: Physics, part: str) -> bool:
    """The part is shut and let go of."""
    return physics.position(part) <= layout.PARTS[part].shut and hand_off(physics, part)


def let_go(physics: Physics, thing: str) -> bool:
    """The thing is at rest and the hand away from it."""
    distance = float(np.linalg.norm(physics.T_world_ee().p - physics.T_world(thing).p))
    return physics.speed(thing) < AT_REST and distance > HAND_AWAY and not physics.robot_touches(thing)


def on_counter(physics: Physics, food: str) -> bool:
    """The food lies on the counter itself, within the region, and in no dish."""
    inside_dish = any(inside(physics, food, dish) for dish in physics.scene.of_type("cookware", "container"))
    return COUNTER_REGION.contains(physics.T_world(food).p) and not inside_dish


def in_cabinet(physics: Physics, food: str) -> bool:
    """The food lies on the cabinet's floor."""
    p = (physics.T_world("cabinet").inverse() @ physics.T_world(food)).p
    return layout.CABINET_INSIDE.contains(p) and bool(p[2] - INSIDE_FLOOR < 0.06)


def inside(physics: Physics, thing: str, dish: str) -> bool:
    """The middle of a thing is over the dish's floor and within its height, or nearly: it lies in the dish, which stands upright.

    Raises
    ------
    InputError
        `dish` is nothing that a thing can be in.
    """
    shape = _shape(physics, dish, Vessel)
    T_dish_thing = physics.T_world(dish).inverse() @ physics.T_world(thing)
    x, y, z = T_dish_thing.p
    height = z - shape.floor_z
    upright = physics.T_world(dish).rotate([0.0, 0.0, 1.0])[2] > 0.95
    return bool(upright and np.hypot(x, y) < shape.radius and 0.0 < height < max(physics.scene.loose[thing].half) + 0.01)


def covers(physics: Physics, lid: str, pan: str) -> bool:
    """The lid lies in its seat on the pan's rim.

    Raises
    ------
    InputError
        `lid` is no lid, or `pan` nothing that it fits on.
    """
    cover, dish = _shape(physics, lid, Lid), _shape(physics, pan, Vessel)
    T_pan_lid = physics.T_world(pan).inverse() @ physics.T_world(lid)
    tilt = np.arccos(np.clip(T_pan_lid.rotate([0.0, 0.0, 1.0])[2], -1.0, 1.0))
    x, y, z = T_pan_lid.p
    aside = np.hypot(x, y) < dish.radius - cover.skirt_radius + 0.005
    return bool(aside and abs(z + cover.seat_z - dish.rim_z) < SEATED_M and tilt < SEATED_RAD)


def in_rack(physics: Physics, lid: str, rack: str) -> bool:
    """The lid's skirt lies on the rack's rails."""
    unit, cover = physics.scene.units[rack], physics.scene.loose[lid]
    T_rack_lid = physics.T_world(rack).inverse() @ physics.T_world(lid)
    x, y, z = T_rack_lid.p
    level = T_rack_lid.rotate([0.0, 0.0, 1.0])[2] > np.cos(np.radians(5.0))
    return bool(level and max(abs(x), abs(y)) < 0.06 and abs(z - unit.box.half[2] - cover.half[2]) < 0.006)


def _shape(physics: Physics, name: str, kind: type[Shape]) -> Shape:
    shape = physics.scene.loose[name].shape if name in physics.scene.loose else None
    if not isinstance(shape, kind):
        there = [n for n, thing in physics.scene.loose.items() if isinstance(thing.shape, kind)]
        raise InputError(f"'{name}' is no {kind.__name__.lower()}; the {physics.scene.name} scene has: {alternatives(there)}")
    return shape
