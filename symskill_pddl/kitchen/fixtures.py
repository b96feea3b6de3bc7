"""MJCF of the fixtures: counter, units, and the parts that turn or slide in them, from the tables of `layout`."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterable

from symskill_pddl.kitchen import layout, mjcf
from symskill_pddl.kitchen.layout import Box, SceneLayout
from symskill_pddl.kitchen.mjcf import CONTACT, Vec3, contact_text, cylinder, text

WOOD, LIGHT_WOOD, STEEL, WHITE = "0.72 0.55 0.38 1", "0.82 0.68 0.50 1", "0.75 0.76 0.78 1", "0.92 0.92 0.90 1"


def joint_of(part: str) -> str:
    """Name of the joint that a part turns or slides on."""
    return f"{part}_joint"


def fixtures(scene: SceneLayout) -> list[ET.Element]:
    """Elements of the world's body: counter, units with their parts, and what only completes the picture."""
    cx, cy, _ = layout.COUNTER.center
    hx, hy, _ = layout.COUNTER.half
    below = Box((cx + 0.02, cy, (layout.FLOOR_Z - 0.04) / 2), (hx - 0.02, hy, -(layout.FLOOR_Z + 0.04) / 2))
    pedestal = Box((0.0, 0.0, layout.FLOOR_Z / 2), (0.09, 0.09, -layout.FLOOR_Z / 2 - 0.002))
    wall = Box((layout.WALL_X + 0.02, 0.0, 0.4), (0.02, 1.5, 1.32))
    slab = Box((0.0, 0.0, 0.0), layout.COUNTER.half)
    units = (
        f'<body name="{name}" pos="{text(unit.box.center)}">{UNIT_SHAPES[unit.look](name, unit.box)}'
        + "".join(_part(own, part) for own, part in scene.parts.items() if part.unit == name)
        + "</body>"
        for name, unit in scene.units.items()
    )
    bodies = (
        f'<body name="counter" pos="{text(layout.COUNTER.center)}">{_box("counter_top", slab, "0.33 0.34 0.36 1")}</body>',
        *units,
        f'<body name="room">{_box("base_cabinet", below, "0.9 0.9 0.88 1")}'
        f"{_box('pedestal', pedestal, '0.25 0.25 0.27 1')}{_box('wall', wall, '0.85 0.88 0.84 1')}</body>",
        f'<body name="{layout.OBSTACLE}" mocap="true" pos="{text(layout.OBSTACLE_PARKED)}">'
        f'<geom type="sphere" size="{layout.OBSTACLE_RADIUS}" rgba="0.85 0.1 0.1 1" group="2" {contact_text(CONTACT)}/></body>',
        '<camera name="overview" pos="-0.75 1.25 1.15" xyaxes="-0.70 -0.71 0 0.30 -0.30 0.90" fovy="48"/>',
        '<camera name="close" pos="-0.35 0.95 0.95" xyaxes="-0.754 -0.656 0.000 0.330 -0.379 0.865" fovy="45"/>',
        '<camera name="right" pos="0.10 -1.05 0.62" xyaxes="0.881 -0.473 0.000 0.284 0.530 0.799" fovy="36"/>',
        '<camera name="inside" pos="-0.25 0.30 0.95" xyaxes="-0.36 -0.93 0 0.25 -0.10 0.96" fovy="55"/>',
    )
    return [ET.fromstring(body) for body in bodies]


def _part(name: str, part: layout.Part) -> str:
    return (
        f'<body name="{name}" pos="{text(part.home)}">'
        f'<joint name="{joint_of(name)}" type="{part.joint}" axis="{text(part.axis)}" pos="{text(part.pivot)}" limited="true" '
        f'range="0 {part.travel}" damping="{part.damping}" frictionloss="{part.friction}" armature="{part.armature}"/>'
        f"{PART_SHAPES[part.type](name)}</body>"
    )


def _box(name: str, box: Box, rgba: str, mass: float | None = None) -> str:
    return mjcf.box(name, box.center, box.half, rgba, mass)


def _panels(name: str, panels: Iterable[tuple[str, Box]], rgba: str) -> str:
    return "".join(_box(f"{name}_{which}", box, rgba) for which, box in panels)


def _bar(name: str, center: Vec3, along: Vec3, foot_x: float) -> str:
    """A steel bar with its middle at `center`, reaching `along` to either side, on two feet from the plane x = `foot_x`."""
    steel = f'rgba="{STEEL}" group="0" friction="1 0.02 0.001" mass="0.05" {contact_text(CONTACT)}'
    x, y, z = center
    ends = [tuple(c + sign * a for c, a in zip(center, along, strict=True)) for sign in (-1, 1)]
    inset = 1.0 - 0.006 / max(along)
    feet = "".join(
        f'<geom name="{name}_standoff{i}" type="capsule" size="0.005" {steel} '
        f'fromto="{text((foot_x, y + s * along[1], z + s * along[2], x, y + s * along[1], z + s * along[2]))}"/>'
        for i, s in enumerate((-inset, inset))
    )
    bar = f'fromto="{text((*ends[0], *ends[1]))}" size="{layout.HANDLE_RADIUS}"'
    return f'<geom name="{name}_handle" type="cylinder" {bar} {steel}/>{feet}'


def _open_front(outer: Box) -> tuple[tuple[str, Box], ...]:
    """The five panels of a wooden box that is open to the front."""
    hx, hy, hz = outer.half
    t = layout.PANEL / 2
    return (
        ("floor", Box((0.0, 0.0, -hz + t), (hx, hy, t))),
        ("top", Box((0.0, 0.0, hz - t), (hx, hy, t))),
        ("right", Box((0.0, -hy + t, 0.0), (hx, t, hz))),
        ("left", Box((0.0, hy - t, 0.0), (hx, t, hz))),
        ("back", Box((hx - t, 0.0, 0.0), (t, hy, hz))),
    )


def _cabinet(name: str, outer: Box) -> str:
    return _panels(name, (*_open_front(outer), ("shelf", layout.SHELF)), WOOD)


def _door(name: str) -> str:
    """A solid panel of 2 kg."""
    panel = Box((0.0, 0.0, 0.0), layout.DOOR.half)
    bar = _bar(name, layout.HANDLE, (0.0, 0.0, layout.HANDLE_LENGTH / 2), -layout.DOOR.half[0])
    return _box(f"{name}_panel", panel, LIGHT_WOOD, mass=2.0) + bar


def _drawer_unit(name: str, outer: Box) -> str:
    return _panels(name, _open_front(outer), WOOD)


def _drawer(name: str) -> str:
    """A tray of 1.35 kg in all, behind its front."""
    hx, hy, hz = layout.DRAWER_FRONT.half
    depth, width, height, t = 0.14, hy - 0.015, 0.05, 0.005
    middle, floor = hx + depth, -hz + 0.012
    panels = (
        ("front", Box((0.0, 0.0, 0.0), (hx, hy, hz)), 0.5),
        ("floor", Box((middle, 0.0, floor), (depth, width, t)), 0.3),
        ("right", Box((middle, -width + t, floor + height), (depth, t, height)), 0.15),
        ("left", Box((middle, width - t, floor + height), (depth, t, height)), 0.15),
        ("back", Box((middle + depth - t, 0.0, floor + height), (t, width, height)), 0.1),
    )
    tray = "".join(_box(f"{name}_{which}", box, LIGHT_WOOD, mass) for which, box, mass in panels)
    return tray + _bar(name, layout.DRAWER_BAR, (0.0, 0.06, 0.0), -hx)


def _hob(name: str, outer: Box) -> str:
    return _box(f"{name}_top", Box((0.0, 0.0, 0.0), outer.half), "0.08 0.08 0.09 1")


def _stove(name: str, outer: Box) -> str:
    """A hob with a burner and what its knob stands on."""
    x, y, z = layout.KNOB.center
    top = outer.half[2]
    under = (z - layout.KNOB.half[2] - top - 0.001) / 2
    return (
        _hob(name, outer)
        + cylinder(f"{name}_burner", layout.BURNER, 0.065, 0.001, "0.55 0.12 0.08 1")
        + cylinder(f"{name}_knob_base", (x, y, top + under), 0.018, under, STEEL)
    )


def _sink(name: str, outer: Box) -> str:
    """A basin of four walls and a floor, and a column with a spout below the lever."""
    hx, hy, hz = outer.half
    t = 0.006
    walls = (
        ("floor", Box((0.0, 0.0, -hz + t), (hx, hy, t))),
        ("front", Box((-hx + t, 0.0, 0.0), (t, hy, hz))),
        ("back", Box((hx - t, 0.0, 0.0), (t, hy, hz))),
        ("right", Box((0.0, -hy + t, 0.0), (hx, t, hz))),
        ("left", Box((0.0, hy - t, 0.0), (hx, t, hz))),
    )
    x, y, _ = layout.FAUCET
    foot, head = -hz, layout.LEVER.center[2] - layout.LEVER.half[2] - 0.002
    spout = head - 0.012
    return (
        _panels(name, walls, "0.80 0.82 0.84 1")
        + cylinder(f"{name}_column", (x, y, (foot + head) / 2), 0.014, (head - foot) / 2, STEEL)
        + _box(f"{name}_spout", Box((x, y - 0.07, spout), (0.009, 0.07, 0.008)), STEEL)
    )


def _rack(name: str, outer: Box) -> str:
    """Two rails along x on two bars across, with short uprights at the corners."""
    hx, hy, hz = outer.half
    t = layout.RAIL_HALF
    bars = [(f"rail{i}", Box((0.0, s * layout.RAIL_Y, hz - t), (hx, t, t))) for i, s in enumerate((-1.0, 1.0))]
    bars += [(f"bar{i}", Box((s * (hx - t), 0.0, -t), (t, hy, hz - t))) for i, s in enumerate((-1.0, 1.0))]
    return _panels(name, bars, STEEL)


UNIT_SHAPES: dict[str, Callable[[str, Box], str]] = {
    "cabinet": _cabinet,
    "drawer-unit": _drawer_unit,
    "stove": _stove,
    "hob": _hob,
    "sink": _sink,
    "rack": _rack,
}
"""What a unit of each look is made of, given its name and outer box."""
PART_SHAPES: dict[str, Callable[[str], str]] = {
    "door": _door,
    "drawer": _drawer,
    "knob": lambda name: _box(f"{name}_ridge", Box((0.0, 0.0, 0.0), layout.KNOB.half), WHITE, 0.04),
    "lever": lambda name: _box(f"{name}_bar", Box((0.0, 0.0, 0.0), layout.LEVER.half), STEEL, 0.08),
}
"""What a part of each type is made of, given its name."""
