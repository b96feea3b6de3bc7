"""What is seen of a RoboCasa kitchen: the frames of the fixture that a task is about, of its moving part, and of loose things.

Frames are made alike, so that what is learned in one kitchen holds in the next. They stand upright while the part is shut, x into
the fixture (as the robot looks at it), y to the left, z up; that of a knob on the front of a stove is tilted with its plate, so
that z points out of it. The origin of a moving part is the middle of what a hand takes it by, and the frame of the fixture that
it moves in is where the part is at home, so that what is shut looks alike in all kitchens. All of it is read from names and
shapes of the compiled model and from RoboCasa's fixture, once, when an episode begins.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from symskill_pddl.demonstrator.part import Jointed
from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, Pose, quat_multiply
from symskill_pddl.robocasa.view import FLIP, FLIP_TURN, View

Vec3 = tuple[float, float, float]
INTO = Pose(np.zeros(3), np.array([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]))
"""RoboCasa's fixtures have y inwards and x to the right; ours have x inwards and y to the left."""


@dataclass(frozen=True, eq=False)
class Tracked:
    """An object of the scene: its name and type, MuJoCo's body that it moves with, its frame in that, and half sizes [m], where
    the frame is in its middle."""

    name: str
    type: str
    body: int
    T_body_frame: Pose
    half: Vec3 | None = None


@dataclass(frozen=True, eq=False)
class Moving:
    """A part that turns or slides: what is seen of it, and its joint: kind, axis and pivot in its frame, and its travel."""

    tracked: Tracked
    joint: int
    kind: str
    axis: Array
    pivot: Array
    travel: float
    T_world_home: Pose

    def seen(self, view: View) -> Jointed:
        """As a hand takes it along, in a view."""
        flip = FLIP_TURN if self.kind == "hinge" else FLIP
        axis, pivot = (self.axis * flip, self.pivot * FLIP) if view.mirrored else (self.axis, self.pivot)
        return Jointed(self.tracked.name, view.pose(self.T_world_home), self.kind, _vec3(axis), _vec3(pivot))


@dataclass(frozen=True, eq=False)
class Fixture:
    """A fixture with one moving part; `mirrored` if it is the mirror image of what the demonstrations show."""

    unit: Tracked
    moving: Moving
    mirrored: bool


class Model:
    """Looks things up in MuJoCo's compiled model."""

    def __init__(self, mujoco: Any, model: Any, data: Any) -> None:
        self.mj, self.model, self.data = mujoco, model, data

    def subtree(self, body: int) -> list[int]:
        """A body and all that hangs on it."""
        found = [body]
        for child in range(body + 1, self.model.nbody):
            if self.model.body_parentid[child] in found:
                found.append(child)
        return found

    def touchable(self, bodies: Iterable[int], word: str = "") -> list[int]:
        """Geoms of bodies that can be touched, with a word in their names."""
        own = set(bodies)
        return [
            g
            for g in range(self.model.ngeom)
            if int(self.model.geom_bodyid[g]) in own
            and self.model.geom_group[g] == 0
            and (self.model.geom_contype[g] or self.model.geom_conaffinity[g])
            and word in self.model.geom(g).name
        ]

    def T_world(self, body: int) -> Pose:
        """Pose of a body."""
        return Pose(self.data.xpos[body].copy(), self.data.xquat[body].copy())

    def T_world_robot(self) -> Pose:
        """Where the robot stands: upright, as what the arm's own leaning adds is nothing that a view should have."""
        base = self.data.body("robot0_link0")
        yaw = 2.0 * np.arctan2(base.xquat[3], base.xquat[0])
        return Pose(base.xpos.copy(), np.array([np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)]))

    def box(self, geoms: Iterable[int], T_world_frame: Pose) -> tuple[Array, Array]:
        """Lower and upper corner (3,) of the box about geoms along the axes of a frame, in the frame [m].

        Raises
        ------
        InputError
            There is no geom.
        """
        corners = []
        for g in geoms:
            center, half = self.model.geom_aabb[g][:3], self.model.geom_aabb[g][3:]
            signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
            R = self.data.geom_xmat[g].reshape(3, 3)
            corners.append((center + signs * half) @ R.T + self.data.geom_xpos[g])
        if not corners:
            raise InputError("a part of this kitchen has no shape that a hand could touch")
        points = T_world_frame.inverse().apply(np.concatenate(corners))
        return points.min(axis=0), points.max(axis=0)


TO_FRONT = np.array([np.sqrt(0.5), 0.0, -np.sqrt(0.5), 0.0])
"""Turns what lies level on a top into the front: forward becomes up, up becomes out."""


def _vec3(values: Array) -> Vec3:
    x, y, z = (float(v) for v in values)
    return x, y, z


def moving(m: Model, joint_name: str, name: str, type_: str, grip: str, q_home: Array) -> Moving:
    """A part by its joint; its frame is oriented by `q_home` (4,) when shut, its origin amid the geoms named `grip`."""
    j = int(m.model.joint(joint_name).id)
    body = int(m.model.jnt_bodyid[j])
    parent = int(m.model.body_parentid[body])
    # where the body is when the joint is at zero
    T_body_home = m.T_world(parent) @ Pose(m.model.body_pos[body].copy(), m.model.body_quat[body].copy())
    moved = m.T_world(body) @ T_body_home.inverse()
    inside = m.subtree(body)
    T_now = moved @ Pose(T_body_home.p, q_home)
    low, high = m.box(m.touchable(inside, grip) or m.touchable(inside, grip.split("_")[0]), T_now)
    T_world_home = moved.inverse() @ T_now @ Pose((low + high) / 2, np.array([1.0, 0.0, 0.0, 0.0]))
    T_body_frame = T_body_home.inverse() @ T_world_home
    low_q, high_q = m.model.jnt_range[j]
    sign = -1.0 if abs(low_q) > abs(high_q) else 1.0
    to_frame = T_body_frame.inverse()
    kind = "slide" if m.model.jnt_type[j] == m.mj.mjtJoint.mjJNT_SLIDE else "hinge"
    tracked = Tracked(name, type_, body, T_body_frame)
    return Moving(
        tracked,
        j,
        kind,
        sign * to_frame.rotate(m.model.jnt_axis[j].copy()),
        to_frame.apply(m.model.jnt_pos[j].copy()),
        float(max(abs(low_q), abs(high_q))),
        T_world_home,
    )


def _unit(m: Model, fixture: Any, name: str, type_: str, origin: Array) -> tuple[Tracked, Pose]:
    """A fixture that stands still: its frame, upright, from its place and heading, at `origin` of that."""
    body = int(m.model.body(f"{fixture.name}_main").id)
    T_body_unit = INTO @ Pose(origin, np.array([1.0, 0.0, 0.0, 0.0]))
    return Tracked(name, type_, body, T_body_unit), m.T_world(body) @ T_body_unit


def cabinet(m: Model, _env: Any, fixture: Any) -> Fixture:
    """A cabinet with one door; hinged on the right, or else in the mirror."""
    (joint,) = fixture.door_joint_names
    return behind(m, fixture, joint)


def behind(m: Model, fixture: Any, joint: str) -> Fixture:
    """The cabinet behind the door with this joint: all of it, or half of one with two doors."""
    unit, T_unit = _unit(m, fixture, "cabinet", "cabinet", np.zeros(3))
    door = moving(m, joint, "door", "door", "handle_handle", T_unit.q)
    return Fixture(at_home(m, unit, door), door, mirrored=bool(door.pivot[1] > 0.0))


def drawer(m: Model, env: Any, fixture: Any) -> Fixture:
    """A drawer; on the robot's right, or else in the mirror."""
    unit, T_unit = _unit(m, fixture, "drawer-unit", "drawer-unit", np.zeros(3))
    part = moving(m, f"{fixture.name}_slidejoint", "drawer", "drawer", "handle_handle", T_unit.q)
    unit = at_home(m, unit, part)
    return Fixture(unit, part, mirrored=getattr(env, "drawer_side", "right") == "left")


def knob(m: Model, env: Any, fixture: Any) -> Fixture:
    """The knob of a stove that the task names."""
    unit, T_unit = _unit(m, fixture, "stove", "stove", np.zeros(3))
    j = m.model.joint(f"{fixture.name}_knob_{env.knob}_joint")
    on_top = abs(float(j.axis[2])) > 0.5
    q_home = T_unit.q if on_top else quat_multiply(T_unit.q, TO_FRONT)
    part = moving(m, f"{fixture.name}_knob_{env.knob}_joint", "knob", "knob", "knob", q_home)
    return Fixture(at_home(m, unit, part), part, mirrored=False)


def lever(m: Model, _env: Any, fixture: Any) -> Fixture:
    """The lever of a sink's faucet."""
    unit, T_unit = _unit(m, fixture, "sink", "sink", np.zeros(3))
    part = moving(m, f"{fixture.name}_handle_joint", "lever", "lever", "handle_main", T_unit.q)
    return Fixture(at_home(m, unit, part), part, mirrored=False)


def at_home(m: Model, unit: Tracked, part: Moving) -> Tracked:
    """The unit with its frame where the part's is when shut."""
    T_world_body = m.T_world(unit.body)
    return Tracked(unit.name, unit.type, unit.body, T_world_body.inverse() @ part.T_world_home)


FIXTURES: dict[str, Callable[[Model, Any, Any], Fixture]] = {"door": cabinet, "drawer": drawer, "knob": knob, "lever": lever}
