"""Things that nothing holds: foods, pan, plates, lid. What each is made of, and its MJCF; all are free bodies with contact.

The frame of a thing is the middle of its outer box.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, sin, tan

from symskill_pddl.kitchen.mjcf import STIFF, Vec3, box, seen

SIDES = 8
"""Walls of a round dish: eight seat a lid as well as twenty-four do, at half the cost."""
LIFT = 0.0025
"""Walls begin this much above a dish's underside, so that it stands on its floor alone, also when it is tilted a little [m]."""


@dataclass(frozen=True)
class Block:
    """A box of one colour."""

    half: Vec3
    rgba: str


@dataclass(frozen=True)
class Mesh:
    """One of robosuite's objects, scaled; `half` is what its half sizes then are [m]."""

    file: str
    half: Vec3
    scale: Vec3 | None = None


@dataclass(frozen=True)
class Vessel:
    """A round dish: a floor and a ring of walls, inner `radius`, `height` over all, perhaps two ears along x [m]."""

    radius: float
    height: float
    rgba: str
    ears: float = 0.0
    wall: float = 0.006
    floor: float = 0.004

    @property
    def half(self) -> Vec3:
        """Half sizes of the outer box, the ears left out: what stands in the way, and what the walls enclose."""
        r = self.radius + self.wall
        return (r, r, self.height / 2)

    @property
    def floor_z(self) -> float:
        """Height of the floor's upper side in the dish's frame."""
        return self.floor - self.height / 2

    @property
    def rim_z(self) -> float:
        return self.height / 2


@dataclass(frozen=True)
class Lid:
    """A dome with a flange that lies on a pan's rim, a skirt below it that keeps it there, and a square knob on top [m].

    Under the dome there is room for what is higher than the pan.
    """

    radius: float
    skirt_radius: float
    rgba: str
    skirt: float = 0.012
    dome: float = 0.022
    disc: float = 0.004
    knob: Vec3 = (0.013, 0.013, 0.020)

    @property
    def half(self) -> Vec3:
        return (self.radius, self.radius, (self.skirt + self.dome + self.disc) / 2 + self.knob[2])

    @property
    def seat_z(self) -> float:
        """Height of the flange's underside, which lies on the rim, in the lid's frame."""
        return self.skirt - self.half[2]

    @property
    def knob_z(self) -> float:
        """Height of the knob's middle in the lid's frame."""
        return self.half[2] - self.knob[2]


@dataclass(frozen=True)
class Loose:
    """A loose thing: its type, what it is made of, and its mass [kg]."""

    type: str
    shape: Block | Mesh | Vessel | Lid
    mass: float

    @property
    def half(self) -> Vec3:
        return self.shape.half


BREAD, CAN = Mesh("bread", (0.02, 0.024, 0.024)), Mesh("can", (0.025, 0.025, 0.024), (1.0, 1.0, 0.6))
CHEESE = Block((0.03, 0.02, 0.02), "0.98 0.80 0.20 1")
FOODS = {"cheese": Loose("food", CHEESE, 0.12), "bread": Loose("food", BREAD, 0.10), "can": Loose("food", CAN, 0.15)}
"""Each fits between the fingers across y."""
BUTTER = Loose("food", Block((0.03, 0.02, 0.02), "0.99 0.95 0.72 1"), 0.12)
PAN = Loose("cookware", Vessel(0.090, 0.036, "0.42 0.43 0.46 1", ears=0.024), 0.7)
"""Shallow, as the hand that takes food from its floor is a box of 20 cm with its underside 3 cm above the grip."""
PLATE = Loose("container", Vessel(0.070, 0.015, "0.95 0.95 0.97 1"), 0.3)
DISHES = {"pan": PAN, "plate": PLATE}
LID = Loose("lid", Lid(0.100, 0.082, "0.62 0.64 0.68 1"), 0.25)
"""The skirt has 8 mm to the pan's wall: with 7 it seats always, with 4 nearly so."""
PLAYTHINGS = {
    "pan": PAN,
    "lid": LID,
    "red-plate": Loose("drawer", Vessel(0.070, 0.015, "0.80 0.12 0.10 1"), 0.3),
    "white-plate": PLATE,
    "block": Loose("thing", Block((0.03, 0.02, 0.02), "0.15 0.35 0.75 1"), 0.12),
    "bread": Loose("thing", BREAD, 0.10),
}
"""Under the types that the paper gives them: a red plate is a drawer there, a dish rack a cabinet."""


FOOD_FRICTION = "0.9 0.02 0.001"
"""Rolling friction included: a tin or a loaf does not spin on a point."""


def body_of(name: str) -> str:
    """Name of a loose thing's body in the model, as robosuite names those of its objects."""
    return f"{name}_main"


def joint_of(name: str) -> str:
    """Name of a loose thing's free joint."""
    return f"{name}_joint0"


def mjcf(name: str, thing: Loose) -> str | None:
    """The thing as a body of its own, or None for one of robosuite's meshes."""
    shape = thing.shape
    if isinstance(shape, Mesh):
        return None
    if isinstance(shape, Block):
        geoms = box(f"{name}_g0", (0.0, 0.0, 0.0), shape.half, shape.rgba, thing.mass, FOOD_FRICTION)
    elif isinstance(shape, Vessel):
        geoms = _vessel(name, shape, thing.mass)
    else:
        geoms = _lid(name, shape, thing.mass)
    return f'<body name="{body_of(name)}"><joint name="{joint_of(name)}" type="free" damping="0.0005"/>{geoms}</body>'


def _vessel(name: str, v: Vessel, mass: float) -> str:
    half, under = v.radius / 2**0.5, v.floor_z - v.floor / 2
    at = (v.radius + v.wall + v.ears / 2, 0.0, v.height / 6)
    ears = "".join(
        box(f"{name}_ear{i}", (sign * at[0], at[1], at[2]), (v.ears / 2 + 0.002, 0.014, 0.003), v.rgba, 0.01, contact=STIFF)
        for i, sign in enumerate((-1.0, 1.0) if v.ears else ())
    )
    return (
        # a square floor carries what stands in the dish; the round one is only seen
        box(f"{name}_floor", (0.0, 0.0, under), (half, half, v.floor / 2), v.rgba, 0.5 * mass, contact=STIFF)
        + seen(f"{name}_round", (0.0, 0.0, under), v.radius + 0.003, v.floor / 2 - 0.0005, v.rgba)
        + _ring(f"{name}_wall", v.radius, v.wall, (-v.height / 2 + LIFT, v.rim_z), v.rgba, 0.5 * mass)
        + ears
    )


def _lid(name: str, lid: Lid, mass: float) -> str:
    top, inner = lid.seat_z + lid.dome, lid.skirt_radius - 0.006
    middle, wide, narrow = top + lid.disc / 2, lid.skirt_radius, lid.skirt_radius * tan(pi / SIDES)
    flange = (lid.radius - inner) / 2
    lugs = "".join(
        # four are enough to lie flat on a rim; the round flange is only seen
        box(
            f"{name}_lug{i}",
            ((inner + flange) * round(cos(i * pi / 2)), (inner + flange) * round(sin(i * pi / 2)), lid.seat_z + lid.disc / 2),
            (flange, 0.03, lid.disc / 2),
            lid.rgba,
            0.05 * mass,
            contact=STIFF,
            turn=i * pi / 2,
        )
        for i in range(4)
    )
    return (
        lugs
        + seen(f"{name}_flange", (0.0, 0.0, lid.seat_z + lid.disc / 2), lid.radius, lid.disc / 2 + 0.0003, lid.rgba)
        + box(f"{name}_x", (0.0, 0.0, middle), (wide, narrow, lid.disc / 2), lid.rgba, 0.15 * mass, contact=STIFF)
        + box(f"{name}_y", (0.0, 0.0, middle), (narrow, wide, lid.disc / 2), lid.rgba, 0.15 * mass, contact=STIFF)
        + seen(f"{name}_round", (0.0, 0.0, middle), lid.skirt_radius, lid.disc / 2 + 0.0003, lid.rgba)
        + _ring(f"{name}_skirt", inner, 0.006, (-lid.half[2], top), lid.rgba, 0.3 * mass)
        + box(f"{name}_knob", (0.0, 0.0, lid.knob_z), lid.knob, "0.15 0.15 0.16 1", 0.2 * mass, "1 0.02 0.001", STIFF)
    )


def _ring(name: str, radius: float, wall: float, z: tuple[float, float], rgba: str, mass: float) -> str:
    """`SIDES` boxes about a circle of inner `radius`."""
    r, along = radius + wall / 2, (radius + wall) * tan(pi / SIDES)
    half, middle = (z[1] - z[0]) / 2, (z[0] + z[1]) / 2
    angles = [2 * pi * i / SIDES for i in range(SIDES)]
    return "".join(
        box(f"{name}{i}", (r * cos(a), r * sin(a), middle), (wall / 2, along, half), rgba, mass / SIDES, contact=STIFF, turn=a)
        for i, a in enumerate(angles)
    )
