"""What a person sees who is about to disturb: what is carried, where there is room. Simulator state."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from symskill_pddl.geometry import Array
from symskill_pddl.kitchen.backend import load_mujoco
from symskill_pddl.kitchen.layout import hand_pose

if TYPE_CHECKING:
    from symskill_pddl.kitchen.physics import Physics


def carried(physics: Physics) -> list[str]:
    """The loose things that the robot touches and nothing else does."""
    from symskill_pddl.kitchen.physics import ROBOT

    touch: dict[str, set[str]] = {}
    for a, b in physics.contacts():
        touch.setdefault(a, set()).add(b)
        touch.setdefault(b, set()).add(a)
    return [name for name in physics.loose if touch.get(name) == {ROBOT}]


def ray(physics: Physics, start: Array, direction: Array, without: int) -> tuple[int, float]:
    """Body and distance [m] of what a ray meets first; (-1, infinity) where it meets nothing. A body may be left out."""
    geom = np.full(1, -1, dtype=np.int32)
    # robosuite's group 1 is for the eye only
    groups = np.array([1, 0, 1, 1, 1, 1], dtype=np.uint8)
    d = load_mujoco().mj_ray(physics.model, physics.data, start, direction / np.linalg.norm(direction), groups, 1, without, geom)
    return (-1, np.inf) if geom[0] < 0 else (int(physics.model.geom_bodyid[geom[0]]), float(d))


def room(physics: Physics, center: Array, radius: float) -> bool:
    """Whether a ball fits in there, as far as 26 rays can tell."""
    steps = (-1.0, 0.0, 1.0)
    directions = [np.array([x, y, z]) for x in steps for y in steps for z in steps if x or y or z]
    return all(ray(physics, center, direction, -1)[1] > radius for direction in directions)


def slides(physics: Physics, name: str, target: Array) -> bool:
    """Whether a loose thing can be slid there: nothing in the way, the same support below, and the arm reaches it there."""
    body, start = physics.bodies[name], physics.T_world(name).p
    down, way = np.array([0.0, 0.0, -1.0]), target - start
    here, there = ray(physics, start, down, body), ray(physics, target, down, body)
    if here[0] < 0 or here[0] != there[0] or abs(here[1] - there[1]) > 0.005:
        return False
    size = float(physics.model.geom_rbound[physics.model.geom_bodyid == body].max())
    across = np.array([-way[1], way[0], 0.0]) / np.linalg.norm(way)
    far = float(np.linalg.norm(way)) + size
    free = all(ray(physics, start + side * size * across, way, body)[1] > far for side in (-0.8, 0.0, 0.8))
    return free and _within_reach(physics, target)


def _within_reach(physics: Physics, p: Array) -> bool:
    """Whether a steep hand gets there. The search moves the arm: its state is put back."""
    from symskill_pddl.kitchen import arm

    data = physics.data
    before = data.qpos.copy(), data.qvel.copy(), data.qacc_warmstart.copy()
    found = arm.solve(physics, hand_pose(p, 0.0, np.radians(78.0)), physics.arm.copy()) is not None
    data.qpos[:], data.qvel[:], data.qacc_warmstart[:] = before
    physics.forward()
    data.qacc_warmstart[:] = before[2]
    return found
