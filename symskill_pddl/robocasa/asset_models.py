"""Models of primitive shapes for RoboCasa: what stands in a kitchen and what lies about in it, as MJCF.

RoboCasa finds the parts of a model by name: the body ``object``, regions ``reg_*`` (boxes neither seen nor touched), joints,
sites and geoms of a fixture that it reads the state of. Geoms of group 0 collide, geoms of group 1 are seen. A fixture's front
looks along -y, its frame is in the middle of its outer box. All lengths in metres.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from math import cos, pi, sin, tan

Vec3 = tuple[float, float, float]

STEEL, DARK, WHITE, RED = "0.75 0.77 0.8 1", "0.12 0.12 0.13 1", "0.92 0.92 0.9 1", "0.55 0.12 0.08 1"
BURNERS = {"rear_left": (-0.16, 0.14), "rear_right": (0.16, 0.14), "front_left": (-0.16, 0.0), "front_right": (0.16, 0.0)}
"""Places of the burners on a stove of 0.76 m, seen from above: all within reach from where RoboCasa puts the robot."""
KNOBS = {"rear_left": -0.24, "front_left": -0.08, "front_right": 0.08, "rear_right": 0.24}
"""Places of the knobs from left to right; a hand that holds one is 20 cm wide and clears a pan on a burner."""
KNOB_TRAVEL, LEVER_TRAVEL = 1.75, 0.8
"""How far a knob and the faucet's lever turn [rad]. RoboCasa counts them as on from 0.35 and 0.40."""


def _text(values: Iterable[float]) -> str:
    return " ".join(f"{v:.5g}" for v in values)


def _geom(
    shape: str, name: str, center: Vec3, size: tuple[float, ...], rgba: str, mass: float | None = None, turn: str = ""
) -> str:
    """One shape twice: once to be touched, once to be seen."""
    common = f'type="{shape}" pos="{_text(center)}" size="{_text(size)}" rgba="{rgba}"{turn}'
    weight = "" if mass is None else f' mass="{mass:.4g}"'
    return (
        f'<geom name="{name}" group="0" {common}{weight}/>'
        f'<geom name="{name}_seen" group="1" contype="0" conaffinity="0" mass="0" {common}/>'
    )


def _box(name: str, center: Vec3, half: Vec3, rgba: str, mass: float | None = None, yaw: float = 0.0) -> str:
    turn = f' quat="{cos(yaw / 2):.6g} 0 0 {sin(yaw / 2):.6g}"' if yaw else ""
    return _geom("box", name, center, half, rgba, mass, turn)


def _cylinder(name: str, center: Vec3, radius: float, half: float, rgba: str, mass: float | None = None) -> str:
    return _geom("cylinder", name, center, (radius, half), rgba, mass)


def _region(name: str, center: Vec3, half: Vec3) -> str:
    return (
        f'<geom name="reg_{name}" group="1" contype="0" conaffinity="0" mass="0" type="box" '
        f'pos="{_text(center)}" size="{_text(half)}" rgba="0 1 0 0"/>'
    )


def _model(name: str, inside: str, asset: str = "") -> str:
    return (
        f'<mujoco model="{name}"><compiler angle="radian"/><asset>{asset}</asset>'
        f'<worldbody><body><body name="object">{inside}</body></body></worldbody></mujoco>\n'
    )


def _hinge(name: str, axis: Vec3, low: float, high: float, damping: float, friction: float, armature: float) -> str:
    return (
        f'<joint name="{name}" type="hinge" axis="{_text(axis)}" limited="true" range="{low:.5g} {high:.5g}" '
        f'damping="{damping:g}" frictionloss="{friction:g}" armature="{armature:g}"/>'
    )


def solid(name: str, size: Vec3, rgba: str) -> str:
    """A plain box for what only stands there: width, depth, height [m]. It weighs 100 g, should it be loose."""
    half = (size[0] / 2, size[1] / 2, size[2] / 2)
    middle = (0.0, 0.0, 0.0)
    return _model(name, _box("body", middle, half, rgba, 0.1) + _region("main", middle, half) + _region("bbox", middle, half))


def microwave() -> str:
    """A box with a hinged front, its two buttons and a tray; only the names matter to the twelve tasks."""
    half = (0.38, 0.225, 0.21)
    door = (
        '<body name="door" pos="-0.38 -0.2 0">'
        + _hinge("microjoint", (0, 0, -1), 0.0, 1.6, 1.0, 0.5, 0.01)
        + _box("door_panel", (0.25, -0.012, 0), (0.25, 0.009, 0.2), DARK, 1.5)
        + _box("door_handle_main", (0.47, -0.02, 0), (0.008, 0.004, 0.12), STEEL, 0.1)
        + "</body>"
    )
    walls = (
        _box("back", (0.0, 0.215, 0.0), (0.38, 0.01, 0.21), WHITE)
        + _box("bottom", (0.0, 0.0, -0.2), (0.38, 0.2, 0.01), WHITE)
        + _box("top", (0.0, 0.0, 0.2), (0.38, 0.2, 0.01), WHITE)
        + _box("left", (-0.37, 0.0, 0.0), (0.01, 0.2, 0.19), WHITE)
        + _box("right", (0.26, 0.0, 0.0), (0.12, 0.2, 0.19), WHITE)
        + _box("start_button", (0.26, -0.206, -0.1), (0.03, 0.005, 0.02), "0.2 0.6 0.2 1")
        + _box("stop_button", (0.26, -0.206, -0.16), (0.03, 0.005, 0.02), RED)
    )
    regions = _region("main", (0, 0, 0), half) + _region("tray", (-0.11, 0.0, 0.0), (0.24, 0.18, 0.18))
    return _model("microwave", walls + door + regions)


def toaster_oven() -> str:
    """A box with a drop-down door, whose joint RoboCasa reads in every step."""
    half = (0.225, 0.19, 0.14)
    door = (
        '<body name="door" pos="0 -0.175 -0.13">'
        + _hinge("door_joint", (1, 0, 0), 0.0, 1.5, 1.0, 0.5, 0.01)
        + _box("door_panel", (0, -0.007, 0.13), (0.2, 0.006, 0.12), DARK, 0.5)
        + "</body>"
    )
    body = _box("body", (0, 0.01, 0), (0.225, 0.18, 0.14), STEEL)
    return _model("toaster_oven", body + door + _region("main", (0, 0, 0), half) + _region("rack0", (0, 0, 0), (0.18, 0.15, 0.1)))


def coffee_machine() -> str:
    """A box with the button that RoboCasa looks at in every step."""
    half = (0.1, 0.15, 0.175)
    body = _box("body", (0, 0.01, 0), (0.1, 0.14, 0.175), DARK) + _box(
        "start_button", (0, -0.14, 0.12), (0.02, 0.008, 0.02), STEEL
    )
    return _model("coffee_machine", body + _region("main", (0, 0, 0), half))


def _knob(burner: str, place: Vec3) -> str:
    """A disc with a ridge one takes it by from above; on is a turn to the left."""
    disc = _cylinder(f"knob_{burner}_main", (0, 0, 0.008), 0.021, 0.007, DARK, 0.03)
    ridge = _box(f"knob_{burner}_ridge", (0, 0, 0.0275), (0.006, 0.0215, 0.0125), WHITE, 0.03)
    hinge = _hinge(f"knob_{burner}_joint", (0, 0, 1), 0.0, KNOB_TRAVEL, 0.05, 0.04, 0.0005)
    return f'<body name="knob_{burner}" pos="{_text(place)}">{hinge}{disc}{ridge}</body>'


def _burners(top: float) -> str:
    """What is seen of the burners, and the sites RoboCasa lights them at and places cookware on."""
    parts = []
    for name, (x, y) in BURNERS.items():
        parts.append(
            f'<geom name="burner_{name}" type="cylinder" group="1" contype="0" conaffinity="0" mass="0" rgba="{RED}" '
            f'size="0.08 0.001" pos="{_text((x, y, top))}"/>'
            f'<site name="burner_on_{name}" type="cylinder" size="0.07 0.002" pos="{_text((x, y, top))}" rgba="1 0.3 0.1 0"/>'
            f'<site name="burner_{name}_place_site" size="0.005" pos="{_text((x, y, top))}" rgba="0 0 0 0"/>'
        )
    return "".join(parts)


def _range(name: str, front: float, half: Vec3) -> str:
    """A box with a flat top, burners, and a row of knobs on top of it, `front` from its middle towards the robot.

    Knobs on the front of a range are out of reach of an arm that stands 20 cm before it and may not drive back.
    """
    knobs = "".join(_knob(burner, (x, front, half[2])) for burner, x in KNOBS.items())
    body = _box("body", (0, 0, 0), half, STEEL)
    return _model(name, body + _burners(half[2]) + knobs + _region("main", (0, 0, 0), half))


def stove() -> str:
    """A range that stands on the floor."""
    return _range("stove", -0.23, (0.38, 0.33, 0.4575))


def stovetop() -> str:
    """A hob that is let into a counter."""
    return _range("stovetop", -0.225, (0.38, 0.275, 0.025))


def sink() -> str:
    """A basin let into the counter, behind it a column with a spout below and the lever on top, which points at the robot.

    The lever turns to the right about the column, so nothing but a hand moves it; the collar below it is for the temperature.
    """
    wide, deep, rim = 0.33, 0.265, 0.11
    floor, wall = -0.09, 0.012
    middle = -0.045  # of the basin, from front to back; the ledge behind it is 9 cm deep
    half = 0.22
    column = (0.0, 0.22)
    basin = (
        _box("floor", (0, 0, floor - 0.01), (wide, deep, 0.01), STEEL)
        + _box("front", (0, middle - half + wall, 0.01), (wide, wall, 0.1), STEEL)
        + _box("back", (0, (middle + half + deep) / 2, 0.01), (wide, (deep - middle - half) / 2, 0.1), STEEL)
        + _box("left", (-wide + wall, middle, 0.01), (wall, half, 0.1), STEEL)
        + _box("right", (wide - wall, middle, 0.01), (wall, half, 0.1), STEEL)
        + _cylinder("column", (*column, rim + 0.065), 0.016, 0.065, STEEL)
    )
    spout = (
        f'<body name="spout" pos="{_text((*column, rim + 0.11))}">'
        + _hinge("spout_joint", (0, 0, 1), -1.5, 1.5, 0.5, 0.5, 0.01)
        + _box("spout_main", (0, -0.1, 0), (0.01, 0.08, 0.009), STEEL, 0.2)
        + '<site name="water" type="cylinder" size="0.008 0.09" pos="0 -0.17 -0.1" rgba="0.3 0.6 0.9 0"/></body>'
    )
    collar = (
        f'<body name="collar" pos="{_text((*column, rim + 0.137))}">'
        + _hinge("handle_temp_joint", (0, 0, 1), -0.6, 0.6, 0.5, 0.5, 0.01)
        + _cylinder("collar_main", (0, 0, 0), 0.013, 0.004, DARK, 0.05)
        + "</body>"
    )
    lever = (
        f'<body name="handle" pos="{_text((*column, rim + 0.16))}">'
        + _hinge("handle_joint", (0, 0, 1), 0.0, LEVER_TRAVEL, 0.1, 0.1, 0.001)
        + _box("handle_main", (0, -0.05, 0), (0.008, 0.065, 0.009), WHITE, 0.08)
        + "</body>"
    )
    regions = _region("main", (0, 0, 0), (wide, deep, rim)) + _region("basin", (0, middle, 0), (wide - 0.03, half - 0.03, -floor))
    return _model("sink", basin + spout + collar + lever + regions)


def _textured(name: str) -> str:
    """What RoboCasa puts the colour of the style on."""
    return f'<texture name="tex" type="{name}" file="../../../textures/flat/white.png"/><material name="mat" texture="tex"/>'


def handle() -> str:
    """A bar of 24 cm, 1.6 cm thick, 4 cm in front of its panel; RoboCasa sizes it by its outer box."""
    inside = "".join(
        f'<geom name="{name}{suffix}" type="box" pos="{_text(center)}" size="{_text(half)}" material="mat" {how}/>'
        for name, center, half in (
            ("handle", (0.0, -0.022, 0.0), (0.008, 0.008, 0.12)),
            ("post_top", (0.0, 0.008, 0.08), (0.006, 0.022, 0.006)),
            ("post_bottom", (0.0, 0.008, -0.08), (0.006, 0.022, 0.006)),
        )
        for suffix, how in (("", 'group="0"'), ("_seen", 'group="1" contype="0" conaffinity="0" mass="0"'))
    )
    return _model("handle", inside + _region("main", (0, 0, 0), (0.008, 0.03, 0.12)), _textured("cube"))


def panel() -> str:
    """A flat door or front of a drawer."""
    half = (0.2, 0.01, 0.3)
    inside = "".join(
        f'<geom name="door{suffix}" type="box" size="{_text(half)}" pos="0 0 0" material="mat" {how}/>'
        for suffix, how in (("", 'group="0"'), ("_seen", 'group="1" contype="0" conaffinity="0" mass="0"'))
    )
    return _model("panel", inside + _region("main", (0, 0, 0), half), _textured("2d"))


def box_food(name: str, half: Vec3, rgba: str, mass: float) -> str:
    """Food, or anything else to hold: a box."""
    middle = (0.0, 0.0, 0.0)
    return _model(name, _box("main", middle, half, rgba, mass) + _region("bbox", middle, half))


def round_food(name: str, radius: float, half: float, rgba: str, mass: float) -> str:
    """Food, or a tin: an upright cylinder, which does not roll away."""
    middle = (0.0, 0.0, 0.0)
    return _model(name, _cylinder("main", middle, radius, half, rgba, mass) + _region("bbox", middle, (radius, radius, half)))


def dish(name: str, scale: float, radius: float, height: float, rgba: str, mass: float, handle_length: float = 0.0) -> str:
    """A pan, pot, bowl or plate: a thick floor, eight thick walls, and a handle if it has one.

    Walls of 8 mm stay where they are under RoboCasa's stiff contacts; a thin-walled pan shook itself apart. `scale` is what
    RoboCasa makes the model larger by.
    """
    floor, wall = 0.005, 0.004
    inside = f"{_cylinder('floor', (0, 0, floor), radius - 0.002, floor, rgba, 0.5 * mass)}"
    reach = (radius - wall) * tan(pi / 8)
    side = (height - 2 * floor) / 2
    for i in range(8):
        yaw = i * pi / 4
        place = ((radius - wall) * cos(yaw), (radius - wall) * sin(yaw), 2 * floor + side)
        inside += _box(f"wall{i}", place, (wall, reach, side), rgba, 0.05 * mass, yaw)
    low, middle = -radius, height / 2
    if handle_length:
        inside += _box(
            "grip", (0, -radius - handle_length / 2, 0.75 * height), (0.01, handle_length / 2, 0.008), DARK, 0.1 * mass
        )
        low -= handle_length
    center, half = (0.0, (radius + low) / 2, middle), (radius, (radius - low) / 2, middle)
    return _scaled(_model(name, inside + _region("bbox", center, half)), scale)


def _scaled(model: str, scale: float) -> str:
    """The same model in the units it is stored in: every position and size divided by what RoboCasa multiplies it with."""

    def shrink(match: re.Match[str]) -> str:
        return f'{match[1]}="{_text(float(v) / scale for v in match[2].split())}"'

    return re.sub(r"\b(pos|size)=\"([^\"]*)\"", shrink, model)
