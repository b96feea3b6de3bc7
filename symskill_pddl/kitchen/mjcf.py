"""Pieces of MJCF: boxes and cylinders as text, with this kitchen's contact parameters."""

from __future__ import annotations

from math import cos, sin

Vec3 = tuple[float, float, float]

CONTACT = {"condim": "4", "solref": "0.01 1", "solimp": "0.95 0.99 0.001"}
STIFF = CONTACT | {"solref": "0.005 1"}
"""Of dishes: a pressed lid or food then sinks in by less than a few millimetres."""
FRICTION = "0.8 0.02 0.001"


def text(values: tuple[float, ...]) -> str:
    """Numbers as MJCF writes them."""
    return " ".join(f"{v:.6g}" for v in values)


def contact_text(contact: dict[str, str]) -> str:
    """Attributes of a geom."""
    return " ".join(f'{key}="{value}"' for key, value in contact.items())


def box(
    name: str,
    center: Vec3,
    half: Vec3,
    rgba: str,
    mass: float | None = None,
    friction: str = FRICTION,
    contact: dict[str, str] = CONTACT,
    turn: float = 0.0,
) -> str:
    """A box, turned by `turn` [rad] about the vertical; without a mass it weighs what its volume does."""
    weight = "" if mass is None else f'mass="{mass:.6g}"'
    quat = f'quat="{cos(turn / 2):.9g} 0 0 {sin(turn / 2):.9g}"' if turn else ""
    return (
        f'<geom name="{name}" type="box" pos="{text(center)}" {quat} size="{text(half)}" rgba="{rgba}" '
        f'group="0" friction="{friction}" {weight} {contact_text(contact)}/>'
    )


def cylinder(name: str, center: Vec3, radius: float, half_height: float, rgba: str) -> str:
    """An upright cylinder."""
    return (
        f'<geom name="{name}" type="cylinder" pos="{text(center)}" size="{radius:.6g} {half_height:.6g}" rgba="{rgba}" '
        f'group="0" friction="{FRICTION}" {contact_text(CONTACT)}/>'
    )


def seen(name: str, center: Vec3, radius: float, half_height: float, rgba: str) -> str:
    """An upright cylinder that is only seen."""
    return (
        f'<geom name="{name}" type="cylinder" pos="{text(center)}" size="{radius:.6g} {half_height:.6g}" rgba="{rgba}" '
        'group="1" contype="0" conaffinity="0" mass="0"/>'
    )
