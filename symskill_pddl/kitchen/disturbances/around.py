"""What a person sees who is about to disturb: what is carried, where there is room. Simulator state."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from symskill_pddl.demonstrator.poses import hand_pose
from symskill_pddl.geometry import Array
from symskill_pddl.kitchen.backend import load_mujoco

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
    """Whether a loose thing can be slid there: nothing in the way, support below as high, and the arm reaches it there."""
    body, start, half = physics.bodies[name], physics.T_world(name).p, physics.scene.loose[name].half
    way = target - start
    below, height = ray(physics, target, np.array([0.0, 0.0, -1.0]), body)
    if below < 0 or abs(height - half[2]) > 0.01:
        return False
    # looked at from the thing's edge on: what stands in it comes along
    size, far = max(half[:2]) + 0.005, float(np.linalg.norm(way))
    ahead, across = way / far, np.array([-way[1], way[0], 0.0]) / far
    edges = (start + size * (np.sqrt(1.0 - side**2) * ahead + side * across) for side in (-0.9, -0.5, 0.0, 0.5, 0.9))
    return all(ray(physics, edge, way, body)[1] > far + 0.005 for edge in edges) and _within_reach(physics, target)


def _within_reach(physics: Physics, p: Array) -> bool:
    """Whether a steep hand gets there. The search moves the arm: its state is put back."""
    from symskill_pddl.panda import reach

    data = physics.data
    before = data.qpos.copy(), data.qvel.copy(), data.qacc_warmstart.copy()
    found = reach.solve(physics, hand_pose(p, 0.0, np.radians(78.0)), physics.arm.copy()) is not None
    data.qpos[:], data.qvel[:], data.qacc_warmstart[:] = before
    physics.forward()
    data.qacc_warmstart[:] = before[2]
    return found
