"""The kitchen's parts as a hand takes them along."""

from __future__ import annotations

from symskill_pddl.demonstrator.part import Jointed
from symskill_pddl.demonstrator.poses import offset
from symskill_pddl.kitchen import layout
from symskill_pddl.scene import Scene


def seen(scene: Scene, name: str) -> Jointed:
    """The part in its unit as the scene shows it."""
    part = layout.PARTS[name]
    return Jointed(name, scene.pose(part.unit) @ offset(part.home), part.joint, part.axis, part.pivot)
