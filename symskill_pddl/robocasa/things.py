"""What is seen of a kitchen where something is carried: food, dishes, and what they stand on and in.

A frame is about what a hand does with a thing. That of food is in its middle, y across a side that fits between the fingers, x
as nearly away from the robot as its shape allows when the episode begins; of what is in a cabinet, as nearly straight into that,
whose sides and open door leave no room to come from elsewhere. Dishes are round: their frames look straight away from the robot.
A counter is long: its frame is on its top, straight below the front of the cabinet above it, as nearly ahead of the robot as
there is room, and looks as the cabinet does. A cabinet is what is behind one of its doors, as in the tasks about doors; of one
with two, the half that the food is nearest to.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.robocasa.tracking import FIXTURES, Fixture, Model, Moving, Tracked, Vec3, behind

FITS_M = 0.054
"""What the open fingers go round with room to spare."""
INSET_M, EDGE_M, BEFORE_M, EASY_M = 0.15, 0.12, 0.03, 0.41
"""How far from the ends of a free stretch of counter, and from its edges, there is room to put something down; how far before the
front of the cabinet one does; and how far ahead of its axis the arm does so easily: nearer, its elbow is folded."""
ASIDE_M = tuple(0.04 * k for k in range(-9, 10))
CLEAR_M, HIGH_M, BESIDE_M = 0.13, 0.4, 0.3
"""How far to the side such a place is looked for, how far from it other things stand, how high above it they count, and how far
it may be from straight ahead of the robot, before the cabinet: ours does not drive."""
SHELF_DEPTH_M = 0.08
"""How far behind a cabinet's front there is."""


class NoRoomError(InputError):
    """A kitchen has no room for a thing where the arm could put it down."""


@dataclass(frozen=True, eq=False)
class Seen:
    """What is seen in an episode.

    Attributes
    ----------
    tracked : tuple of Tracked
        The objects, the most important first.
    moving : tuple of Moving
        Those of them that turn or slide.
    mirrored : bool
        Whether it is the mirror image of what the demonstrations show.
    room : dict of str to (float, float, float)
        Where something can be put down in or on an object: the middle of that place in its frame, not mirrored.
    """

    tracked: tuple[Tracked, ...]
    moving: tuple[Moving, ...]
    mirrored: bool
    room: dict[str, Vec3] = field(default_factory=dict)


def look(about: str, m: Model, env: Any, fixture: Any) -> Seen:
    """What is seen in an episode about this kind of thing, with RoboCasa's fixture."""
    if about in THINGS:
        return THINGS[about](m, env, fixture)
    found = FIXTURES[about](m, env, fixture)
    return Seen((found.moving.tracked, found.unit), (found.moving,), found.mirrored)


def stored(m: Model, env: Any, fixture: Any, name: str = "food") -> Seen:
    """A food, the cabinet it is in or belongs in, its door, and the counter below."""
    body = int(env.obj_body_id["obj"])
    p = m.T_world(body).p
    halves = [behind(m, fixture, joint) for joint in fixture.door_joint_names]
    if not halves:
        raise InputError(f"cabinet '{fixture.name}' has no door")
    half = min(halves, key=lambda found: abs(_middle(found) - float(_world(m, found.unit).inverse().apply(p)[1])))
    T_unit = _world(m, half.unit)
    front, floor = _shelf(fixture, T_unit)
    inside = T_unit.inverse().apply(p)[0] > front
    food = _food(m, body, name, T_unit.rotate([1.0, 0.0, 0.0]) if inside else p - m.T_world_robot().p)
    room = {"cabinet": (front + SHELF_DEPTH_M, _middle(half), floor), "counter": (0.0, 0.0, 0.0)}
    tracked = (food, half.unit, half.moving.tracked, _counter(m, env, fixture, T_unit, front - BEFORE_M))
    return Seen(tracked, (half.moving,), half.mirrored, room)


def cooked(m: Model, env: Any, _fixture: Any) -> Seen:
    """A food, the pan and the other dish; that is on the robot's right, or else in the mirror."""
    dishes = {cfg["info"]["cat"]: cfg["name"] for cfg in env.object_cfgs if cfg["name"] in ("container", "obj_container")}
    if "pan" not in dishes or len(dishes) != 2:
        raise InputError(f"task '{type(env).__name__}' needs a pan and another dish, this episode has: {sorted(dishes)}")
    pan = dishes.pop("pan")
    (other,) = dishes.values()
    body = int(env.obj_body_id["obj"])
    food = _food(m, body, "food", m.T_world(body).p - m.T_world_robot().p)
    tracked = (food, _dish(m, env, pan, "pan", "cookware"), _dish(m, env, other, "plate", "container"))
    plate = m.T_world_robot().inverse().apply(_world(m, tracked[2]).p)
    return Seen(tracked, (), bool(plate[1] > 0.0), {t.name: _floor(m, t) for t in tracked[1:]})


THINGS: dict[str, Callable[[Model, Any, Any], Seen]] = {
    "stored food": stored,
    "stored cheese": partial(stored, name="cheese"),
    "cooked food": cooked,
}


def _world(m: Model, tracked: Tracked) -> Pose:
    return m.T_world(tracked.body) @ tracked.T_body_frame


def _heading(vector: Array) -> Pose:
    """A turn about the vertical, x along the level part of a vector."""
    yaw = np.arctan2(vector[1], vector[0])
    return Pose(np.zeros(3), np.array([np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)]))


def _half(low: Array, high: Array) -> Vec3:
    x, y, z = ((high - low) / 2).tolist()
    return x, y, z


def _food(m: Model, body: int, name: str, away: Array) -> Tracked:
    """Anything one holds, its frame looking as nearly along `away` (3,) as its shape allows."""
    T_world_body = m.T_world(body)
    geoms = m.touchable(m.subtree(body))
    round_ = len(geoms) == 1 and m.model.geom_type[geoms[0]] in (m.mj.mjtGeom.mjGEOM_CYLINDER, m.mj.mjtGeom.mjGEOM_SPHERE)
    upright = Pose(T_world_body.p, _heading(away if round_ else T_world_body.rotate([1.0, 0.0, 0.0])).q)
    sides = [upright @ Pose.from_rotvec(np.zeros(3), [0.0, 0.0, turn]) for turn in np.arange(4) * np.pi / 2]
    across = [float(np.diff(np.stack(m.box(geoms, T)), axis=0)[0, 1]) for T in sides]
    limit = max(FITS_M, min(across) + 1e-3)
    fitting = [T for T, width in zip(sides, across, strict=True) if width <= limit]
    T = max(fitting, key=lambda T: float(np.dot(T.rotate([1.0, 0.0, 0.0]), away)))
    low, high = m.box(geoms, T)
    T = T @ Pose((low + high) / 2, np.array([1.0, 0.0, 0.0, 0.0]))
    return Tracked(name, "food", body, T_world_body.inverse() @ T, _half(low, high))


def _dish(m: Model, env: Any, thing: str, name: str, type_: str) -> Tracked:
    """A round dish; its frame is where RoboCasa's is, in the middle of its bottom."""
    body = int(env.obj_body_id[thing])
    T_world_body = m.T_world(body)
    T = Pose(T_world_body.p, _heading(T_world_body.p - m.T_world_robot().p).q)
    return Tracked(name, type_, body, T_world_body.inverse() @ T)


def _floor(m: Model, dish: Tracked) -> Vec3:
    """Upper side of a dish's floor, in its frame: of what is touched in its middle, the lowest."""
    T = Pose(_world(m, dish).p, np.array([1.0, 0.0, 0.0, 0.0]))
    boxes = [m.box([g], T) for g in m.touchable(m.subtree(dish.body))]
    tops = [float(high[2]) for low, high in boxes if np.all(low[:2] < 0.0) and np.all(high[:2] > 0.0)]
    if not tops:
        raise InputError(f"dish '{dish.name}' has no floor")
    return (0.0, 0.0, min(tops))


def _middle(half: Fixture) -> float:
    """Middle of what is behind a door, y in the cabinet's frame: the handle is near the free edge."""
    return float(half.moving.pivot[1]) * 0.5


def _shelf(fixture: Any, T_unit: Pose) -> tuple[float, float]:
    """Plane of a cabinet's opening and top of its lowest shelf: x and z in the cabinet's frame."""
    regions = fixture.get_int_sites(relative=False)
    p0 = T_unit.inverse().apply(np.asarray(regions[min(regions)][0], float))
    return float(p0[0]), float(p0[2])


def _counter(m: Model, env: Any, ref: Any, T_world_cabinet: Pose, before: float) -> Tracked:
    """The counter where there is room, as RoboCasa looks for it next to a fixture, nearest to straight ahead of the robot.

    That is at `before` [m], in the frame of the cabinet above it, which one has to come straight out of, or a little behind.

    Raises
    ------
    NoRoomError
        The nearest is far aside or behind: the robot would have to drive there.
    """
    counter = env.counter
    body = int(m.model.body(f"{counter.name}_main").id)
    T_world_counter = m.T_world(body)
    to_counter = T_world_counter.inverse() @ T_world_cabinet
    x, y, _ = T_world_cabinet.inverse().apply(m.T_world_robot().p)
    ahead = to_counter.apply([max(before, x + EASY_M), y, 0.0])
    spots = []
    for region in counter.get_reset_regions(env, ref=ref).values():
        (middle, depth, top), (wide, deep) = region["offset"], region["size"]
        room, inside = max(wide / 2 - INSET_M, 0.0), max(deep / 2 - EDGE_M, 0.0)
        for aside in ASIDE_M:
            x, y, _ = ahead + to_counter.rotate([0.0, aside, 0.0])
            spots.append([np.clip(x, middle - room, middle + room), np.clip(y, depth - inside, depth + inside), top])
    off = np.linalg.norm(np.array(spots)[:, :2] - ahead[:2], axis=1)
    points = T_world_counter.apply(np.array(spots))
    best = int(np.argmin(100.0 * np.maximum(CLEAR_M - _clearance(m, points), 0.0) + off))
    if off[best] > BESIDE_M:
        raise NoRoomError(f"there is no room on the counter in front of '{ref.name}'")
    return Tracked("counter", "counter", body, T_world_counter.inverse() @ Pose(points[best], T_world_cabinet.q))


def _clearance(m: Model, points: Array) -> Array:
    """How far to the side of points (n, 3) on a counter the next thing stands on it (n,) [m]."""
    top = float(points[0, 2])
    centers = m.data.geom_xpos + np.einsum("gij,gj->gi", m.data.geom_xmat.reshape(-1, 3, 3), m.model.geom_aabb[:, :3])
    halves = np.einsum("gij,gj->gi", np.abs(m.data.geom_xmat.reshape(-1, 3, 3)), m.model.geom_aabb[:, 3:])
    there = m.touchable(range(m.model.nbody))
    own = [
        g for g in there if m.model.body(m.model.body_rootid[m.model.geom_bodyid[g]]).name.startswith(("robot0", "mobilebase0"))
    ]
    low, high = centers[:, 2] - halves[:, 2], centers[:, 2] + halves[:, 2]
    standing = [g for g in there if g not in own and high[g] > top + 0.01 and low[g] < top + HIGH_M]
    if not standing:
        return np.full(len(points), np.inf)
    gap = np.maximum(np.abs(points[:, None, :2] - centers[standing][:, :2]) - halves[standing][:, :2], 0.0)
    return np.asarray(np.linalg.norm(gap, axis=-1).min(axis=1))
