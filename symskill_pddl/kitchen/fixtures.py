"""MJCF of the fixtures: counter, units, and the parts that turn or slide in them, from the tables of `layout`."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.layout import Box, Vec3

CONTACT = {"condim": "4", "solref": "0.01 1", "solimp": "0.95 0.99 0.001"}
WOOD, LIGHT_WOOD, STEEL, WHITE = "0.72 0.55 0.38 1", "0.82 0.68 0.50 1", "0.75 0.76 0.78 1", "0.92 0.92 0.90 1"


def joint_of(part: str) -> str:
    """Name of the joint that a part turns or slides on."""
    return f"{part}_joint"


def fixtures() -> list[ET.Element]:
    """Elements of the world's body: counter, units with their parts, and what only completes the picture."""
    cx, cy, _ = layout.COUNTER.center
    hx, hy, _ = layout.COUNTER.half
    below = Box((cx + 0.02, cy, (layout.FLOOR_Z - 0.04) / 2), (hx - 0.02, hy, -(layout.FLOOR_Z + 0.04) / 2))
    pedestal = Box((0.0, 0.0, layout.FLOOR_Z / 2), (0.09, 0.09, -layout.FLOOR_Z / 2 - 0.002))
    wall = Box((layout.WALL_X + 0.02, 0.0, 0.4), (0.02, 1.5, 1.32))
    slab = Box((0.0, 0.0, 0.0), layout.COUNTER.half)
    shapes = {
        "cabinet": _cabinet(),
        "door": _door(),
        "drawer-unit": _drawer_unit(),
        "drawer": _drawer(),
        "stove": _stove(),
        "knob": _box("knob_ridge", Box((0.0, 0.0, 0.0), layout.KNOB.half), WHITE, mass_kg=0.04),
        "sink": _sink(),
        "lever": _box("lever_bar", Box((0.0, 0.0, 0.0), layout.LEVER.half), STEEL, mass_kg=0.08),
    }
    units = (
        f'<body name="{name}" pos="{_text(box.center)}">{shapes[name]}'
        + "".join(_part(own, part, shapes[own]) for own, part in layout.PARTS.items() if part.unit == name)
        + "</body>"
        for name, box in layout.UNITS.items()
    )
    texts = (
        f'<body name="counter" pos="{_text(layout.COUNTER.center)}">{_box("counter_top", slab, "0.33 0.34 0.36 1")}</body>',
        *units,
        f'<body name="room">{_box("base_cabinet", below, "0.9 0.9 0.88 1")}'
        f"{_box('pedestal', pedestal, '0.25 0.25 0.27 1')}{_box('wall', wall, '0.85 0.88 0.84 1')}</body>",
        f'<body name="{layout.OBSTACLE}" mocap="true" pos="{_text(layout.OBSTACLE_PARKED)}">'
        f'<geom type="sphere" size="{layout.OBSTACLE_RADIUS}" rgba="0.85 0.1 0.1 1" group="2" {_CONTACT_TEXT}/></body>',
        '<camera name="overview" pos="-0.75 1.25 1.15" xyaxes="-0.70 -0.71 0 0.30 -0.30 0.90" fovy="48"/>',
        '<camera name="inside" pos="-0.25 0.30 0.95" xyaxes="-0.36 -0.93 0 0.25 -0.10 0.96" fovy="55"/>',
    )
    return [ET.fromstring(text) for text in texts]


def _part(name: str, part: layout.Part, geoms: str) -> str:
    return (
        f'<body name="{name}" pos="{_text(part.home)}">'
        f'<joint name="{joint_of(name)}" type="{part.joint}" axis="{_text(part.axis)}" pos="{_text(part.pivot)}" limited="true" '
        f'range="0 {part.travel}" damping="{part.damping}" frictionloss="{part.friction}" armature="{part.armature}"/>'
        f"{geoms}</body>"
    )


def _text(values: Vec3 | tuple[float, ...]) -> str:
    return " ".join(f"{v:.6g}" for v in values)


def _box(name: str, box: Box, rgba: str, friction: str = "0.8 0.02 0.001", mass_kg: float | None = None) -> str:
    mass = "" if mass_kg is None else f'mass="{mass_kg}"'
    return (
        f'<geom name="{name}" type="box" pos="{_text(box.center)}" size="{_text(box.half)}" rgba="{rgba}" '
        f'group="0" friction="{friction}" {mass} {_CONTACT_TEXT}/>'
    )


_CONTACT_TEXT = " ".join(f'{key}="{value}"' for key, value in CONTACT.items())


def _bar(name: str, center: Vec3, along: Vec3, foot_x: float) -> str:
    """A steel bar with its middle at `center`, reaching `along` to either side, on two feet from the plane x = `foot_x`."""
    steel = f'rgba="{STEEL}" group="0" friction="1 0.02 0.001" mass="0.05" {_CONTACT_TEXT}'
    x, y, z = center
    ends = [tuple(c + sign * a for c, a in zip(center, along, strict=True)) for sign in (-1, 1)]
    inset = 1.0 - 0.006 / max(along)
    feet = "".join(
        f'<geom name="{name}_standoff{i}" type="capsule" size="0.005" {steel} '
        f'fromto="{_text((foot_x, y + s * along[1], z + s * along[2], x, y + s * along[1], z + s * along[2]))}"/>'
        for i, s in enumerate((-inset, inset))
    )
    bar = f'fromto="{_text((*ends[0], *ends[1]))}" size="{layout.HANDLE_RADIUS}"'
    return f'<geom name="{name}_handle" type="cylinder" {bar} {steel}/>{feet}'


def _cabinet() -> str:
    hx, hy, hz = layout.CABINET.half
    t = layout.PANEL / 2
    panels = (
        ("cabinet_floor", Box((0.0, 0.0, -hz + t), (hx, hy, t))),
        ("cabinet_top", Box((0.0, 0.0, hz - t), (hx, hy, t))),
        ("cabinet_right", Box((0.0, -hy + t, 0.0), (hx, t, hz))),
        ("cabinet_left", Box((0.0, hy - t, 0.0), (hx, t, hz))),
        ("cabinet_back", Box((hx - t, 0.0, 0.0), (t, hy, hz))),
        ("cabinet_shelf", layout.SHELF),
    )
    return "".join(_box(name, box, WOOD) for name, box in panels)


def _door() -> str:
    """A solid panel of 2 kg."""
    panel = Box((0.0, 0.0, 0.0), layout.DOOR.half)
    bar = _bar("door", layout.HANDLE, (0.0, 0.0, layout.HANDLE_LENGTH / 2), -layout.DOOR.half[0])
    return _box("door_panel", panel, LIGHT_WOOD, mass_kg=2.0) + bar


def _drawer_unit() -> str:
    hx, hy, hz = layout.DRAWER_UNIT.half
    t = layout.PANEL / 2
    panels = (
        ("drawer_unit_floor", Box((0.0, 0.0, -hz + t), (hx, hy, t))),
        ("drawer_unit_top", Box((0.0, 0.0, hz - t), (hx, hy, t))),
        ("drawer_unit_right", Box((0.0, -hy + t, 0.0), (hx, t, hz))),
        ("drawer_unit_left", Box((0.0, hy - t, 0.0), (hx, t, hz))),
        ("drawer_unit_back", Box((hx - t, 0.0, 0.0), (t, hy, hz))),
    )
    return "".join(_box(name, box, WOOD) for name, box in panels)


def _drawer() -> str:
    """A tray of 1.35 kg in all, behind its front."""
    hx, hy, hz = layout.DRAWER_FRONT.half
    depth, width, height, t = 0.14, hy - 0.015, 0.05, 0.005
    middle, floor = hx + depth, -hz + 0.012
    panels = (
        ("drawer_front", Box((0.0, 0.0, 0.0), (hx, hy, hz)), 0.5),
        ("drawer_floor", Box((middle, 0.0, floor), (depth, width, t)), 0.3),
        ("drawer_right", Box((middle, -width + t, floor + height), (depth, t, height)), 0.15),
        ("drawer_left", Box((middle, width - t, floor + height), (depth, t, height)), 0.15),
        ("drawer_back", Box((middle + depth - t, 0.0, floor + height), (t, width, height)), 0.1),
    )
    tray = "".join(_box(name, box, LIGHT_WOOD, mass_kg=mass) for name, box, mass in panels)
    return tray + _bar("drawer", layout.DRAWER_BAR, (0.0, 0.06, 0.0), -hx)


def _cylinder(name: str, center: Vec3, radius: float, half_height: float, rgba: str) -> str:
    return (
        f'<geom name="{name}" type="cylinder" pos="{_text(center)}" size="{radius} {half_height}" rgba="{rgba}" '
        f'group="0" friction="0.8 0.02 0.001" {_CONTACT_TEXT}/>'
    )


def _stove() -> str:
    x, y, z = layout.KNOB.center
    top = layout.STOVE.half[2]
    under = (z - layout.KNOB.half[2] - top - 0.001) / 2
    return (
        _box("stove_top", Box((0.0, 0.0, 0.0), layout.STOVE.half), "0.08 0.08 0.09 1")
        + _cylinder("stove_burner", layout.BURNER, 0.065, 0.001, "0.55 0.12 0.08 1")
        + _cylinder("stove_knob_base", (x, y, top + under), 0.018, under, STEEL)
    )


def _sink() -> str:
    """A basin of four walls and a floor, and a column with a spout below the lever."""
    hx, hy, hz = layout.SINK.half
    t = 0.006
    walls = (
        ("sink_floor", Box((0.0, 0.0, -hz + t), (hx, hy, t))),
        ("sink_front", Box((-hx + t, 0.0, 0.0), (t, hy, hz))),
        ("sink_back", Box((hx - t, 0.0, 0.0), (t, hy, hz))),
        ("sink_right", Box((0.0, -hy + t, 0.0), (hx, t, hz))),
        ("sink_left", Box((0.0, hy - t, 0.0), (hx, t, hz))),
    )
    x, y, _ = layout.FAUCET
    foot, head = -hz, layout.LEVER.center[2] - layout.LEVER.half[2] - 0.002
    spout = head - 0.012
    return (
        "".join(_box(name, box, "0.80 0.82 0.84 1") for name, box in walls)
        + _cylinder("sink_column", (x, y, (foot + head) / 2), 0.014, (head - foot) / 2, STEEL)
        + _box("sink_spout", Box((x, y - 0.07, spout), (0.009, 0.07, 0.008)), STEEL)
    )
