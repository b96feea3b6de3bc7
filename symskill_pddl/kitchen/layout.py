"""Where things stand in the kitchen and how large they are. Metres; the robot's base is the origin, x forward, y left.

The top of the counter is z = 0. Numbers are those of a real kitchen, within what one Panda reaches from a fixed base.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import radians

from symskill_pddl.geometry import Array
from symskill_pddl.kitchen import loose
from symskill_pddl.kitchen.loose import Loose
from symskill_pddl.kitchen.mjcf import Vec3


@dataclass(frozen=True)
class Box:
    """A box: centre and half sizes, in the frame of what it belongs to."""

    center: Vec3
    half: Vec3

    def contains(self, p: Array, margin: float = 0.0) -> bool:
        """Whether the point p (3,) lies inside, at least `margin` from every face."""
        return bool(all(abs(p[i] - self.center[i]) <= self.half[i] - margin for i in range(3)))


FLOOR_Z = -0.92
COUNTER = Box((0.56, 0.0, -0.02), (0.36, 0.90, 0.02))
WALL_X = 0.92

CABINET = Box((0.77, -0.11, 0.705), (0.15, 0.19, 0.25))
"""Outer box of the wall cabinet: front at x = 0.62, floor 0.47 above the counter, high enough for a wrist above a steep hand."""
PANEL = 0.015
"""Thickness of the cabinet's walls."""
CABINET_INSIDE = Box((-PANEL / 2, 0.0, 0.0), (0.15 - PANEL / 2, 0.19 - PANEL, 0.25 - PANEL))
"""The inside, open to the front, in the cabinet's frame (its centre)."""
SHELF = Box((0.075, 0.0, 0.15), (0.06, 0.175, 0.006))
"""Half-depth shelf at the back, in the cabinet's frame: high enough for a hand to work below it."""

DOOR = Box((-0.159, 0.0, 0.0), (0.009, 0.19, 0.25))
"""The door's panel when shut, in the cabinet's frame. The frame of the door is the centre of its panel."""
DOOR_HINGE: Vec3 = (0.009, -0.19, 0.0)
"""A point of the hinge axis (vertical, opens to the right) in the door's frame."""
HANDLE: Vec3 = (-0.054, 0.145, -0.12)
"""Centre of the vertical handle bar in the door's frame: 4.5 cm in front of the panel, 4.5 cm from the free edge."""
HANDLE_RADIUS = 0.007
HANDLE_LENGTH = 0.12

DRAWER_UNIT = Box((0.739, 0.43, 0.10), (0.161, 0.135, 0.10))
"""Outer box of the chest on the left of the counter."""
DRAWER_FRONT = Box((-0.170, 0.0, 0.0), (0.009, 0.13, 0.085))
"""The drawer's front when shut, in the chest's frame. The frame of the drawer is the centre of its front."""
DRAWER_BAR: Vec3 = (-0.071, 0.0, 0.03)
"""Centre of the level bar in the drawer's frame: far enough from the front for a hand that looks down on it."""

STOVE = Box((0.54, -0.12, 0.003), (0.20, 0.09, 0.003))
"""A flat hob between where food is taken from the counter and where other foods stand; its knob is on the side of the robot."""
BURNER: Vec3 = (0.08, 0.0, 0.004)
"""Centre of the burner in the stove's frame; it is flat."""
KNOB = Box((-0.13, 0.0, 0.027), (0.0225, 0.006, 0.014))
"""The ridge one takes the knob by, off, in the stove's frame; it is turned about the vertical through its middle.
It is 21 cm from the middle of the burner: a hand on it is a box of 20 cm, and has to clear a pan."""

SINK = Box((0.51, -0.69, 0.04), (0.15, 0.13, 0.04))
"""A basin that stands on the counter, at its right."""
FAUCET: Vec3 = (0.05, 0.165, 0.0)
"""Axis of the faucet's column, beside the basin, in the sink's frame."""
LEVER = Box((0.005, 0.165, 0.078), (0.045, 0.007, 0.007))
"""The lever on top of the column, off, pointing at the robot, in the sink's frame."""

RACK = Box((0.0, 0.0, 0.0), (0.11, 0.11, 0.012))
"""A dish rack: a frame with two rails along x on which a lid's skirt lies, in its own frame."""
RAIL_Y, RAIL_HALF = 0.05, 0.005
"""Middle of a rail, to either side, and half its thickness [m]; their upper sides are the rack's."""


@dataclass(frozen=True)
class Part:
    """What turns or slides in a unit. Its joint's position is 0 where it is shut or off and grows from there [rad] or [m].

    Attributes
    ----------
    type : str
    unit : str
        What it moves in.
    home : (float, float, float)
        Origin of its frame in the unit's frame when shut; the axes then agree.
    joint : str
        'hinge' or 'slide', as MuJoCo calls them.
    axis, pivot : (float, float, float)
        Of the joint, in the part's frame.
    travel : float
        Largest position.
    damping, friction, armature : float
        Of the joint: [N s/m], [N] and [kg], or [Nm s/rad], [Nm] and [kg m2]. Friction keeps the part where it is left.
    half : (float, float, float)
        Half sizes [m].
    grip : (float, float, float)
        Where a hand takes it, in its frame.
    shut, opened : float
        At most, and at least, at this position it counts as shut or off, and as open or on.
    """

    type: str
    unit: str
    home: Vec3
    joint: str
    axis: Vec3
    pivot: Vec3
    travel: float
    damping: float
    friction: float
    armature: float
    half: Vec3
    grip: Vec3
    shut: float
    opened: float


@dataclass(frozen=True)
class Unit:
    """A fixture: its type, what it looks like, and its outer box in the world; its frame is the middle of the box."""

    type: str
    look: str
    box: Box


PARTS = {
    "door": Part(
        "door", "cabinet", DOOR.center, "hinge", (0.0, 0.0, 1.0), DOOR_HINGE, 1.955, 1.5, 0.6, 0.01,
        DOOR.half, HANDLE, shut=radians(3.0), opened=radians(75.0),
    ),
    "drawer": Part(
        "drawer", "drawer-unit", DRAWER_FRONT.center, "slide", (-1.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.20, 8.0, 2.0, 0.01,
        DRAWER_FRONT.half, DRAWER_BAR, shut=0.01, opened=0.12,
    ),
    "knob": Part(
        "knob", "stove", KNOB.center, "hinge", (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), 1.9, 0.05, 0.04, 0.0005,
        KNOB.half, (0.0, 0.0, 0.0), shut=0.2, opened=1.2,
    ),
    "lever": Part(
        "lever", "sink", LEVER.center, "hinge", (0.0, 0.0, -1.0), (0.045, 0.0, 0.0), 1.5, 0.1, 0.1, 0.001,
        LEVER.half, (-0.03, 0.0, 0.0), shut=0.2, opened=0.9,
    ),
}  # fmt: skip
PARTS["knob-2"] = replace(PARTS["knob"], unit="stove-2")
"""Every part there is, by its name."""

OBSTACLE = "obstacle"
"""Name and type of what a disturbance may put in the way; at other times it is far away, and no object of the scene."""
OBSTACLE_RADIUS = 0.04
OBSTACLE_PARKED: Vec3 = (0.4, 0.0, 4.0)
ADDED_EXTENTS: dict[str, Vec3] = {OBSTACLE: (OBSTACLE_RADIUS, OBSTACLE_RADIUS, OBSTACLE_RADIUS)}
"""Half sizes of types that are in the scene only because of a disturbance."""


@dataclass(frozen=True, eq=False)
class SceneLayout:
    """All that stands in one scene: fixtures, what turns or slides in them, and loose things. Its model is compiled once.

    Attributes
    ----------
    name : str
    units : dict of str to Unit
    parts : dict of str to Part
    loose : dict of str to Loose
    """

    name: str
    units: dict[str, Unit]
    parts: dict[str, Part]
    loose: dict[str, Loose]

    @cached_property
    def types(self) -> dict[str, str]:
        """Type of every object, in the order of the scene."""
        fixed = {name: unit.type for name, unit in self.units.items()} | {name: part.type for name, part in self.parts.items()}
        return fixed | {"counter": "counter"} | {name: thing.type for name, thing in self.loose.items()}

    @cached_property
    def extents(self) -> dict[str, Vec3]:
        """Half sizes per type [m]; those of the largest where a type has several."""
        sizes = [(u.type, u.box.half) for u in self.units.values()] + [(p.type, p.half) for p in self.parts.values()]
        sizes += [("counter", COUNTER.half)] + [(t.type, t.half) for t in self.loose.values()]
        found: dict[str, Vec3] = {}
        for kind, (x, y, z) in sizes:
            known = found.get(kind, (0.0, 0.0, 0.0))
            found[kind] = (max(x, known[0]), max(y, known[1]), max(z, known[2]))
        return found

    def of_type(self, *kinds: str) -> tuple[str, ...]:
        """Names of the loose things of these types."""
        return tuple(name for name, thing in self.loose.items() if thing.type in kinds)


KITCHEN = SceneLayout(
    "kitchen",
    {
        "cabinet": Unit("cabinet", "cabinet", CABINET),
        "drawer-unit": Unit("drawer-unit", "drawer-unit", DRAWER_UNIT),
        "stove": Unit("stove", "stove", STOVE),
        "sink": Unit("sink", "sink", SINK),
    },
    {name: PARTS[name] for name in ("door", "drawer", "knob", "lever")},
    loose.FOODS | loose.DISHES,
)
"""The kitchen of the atomic tasks."""
DINNER = SceneLayout(
    "dinner",
    KITCHEN.units
    | {f"stove{i}": Unit("stove", "stove", Box((0.54, y, 0.003), STOVE.half)) for i, y in (("", -0.18), ("-2", -0.365))},
    KITCHEN.parts | {"knob-2": PARTS["knob-2"]},
    KITCHEN.loose | {"butter": loose.BUTTER, "pan-2": loose.PAN, "plate-2": loose.PLATE},
)
"""The same with two hobs, further to the right, a pan on each, a second plate and one more food, for the longest goal."""
PLAY = SceneLayout(
    "play",
    {
        "stove": Unit("stove", "hob", Box((0.55, -0.02, 0.003), (0.12, 0.11, 0.003))),
        "dish-rack": Unit("cabinet", "rack", Box((0.50, -0.31, 0.012), RACK.half)),
    },
    {},
    loose.PLAYTHINGS,
)
"""The scene of play: pan on a hob, a rack for its lid, two plates, two things."""
SCENES = {scene.name: scene for scene in (KITCHEN, DINNER, PLAY)}
