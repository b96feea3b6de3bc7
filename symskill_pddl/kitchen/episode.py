"""What is drawn for an episode: where things stand, how far parts are open, where the hand starts."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from symskill_pddl.demonstrator.poses import hand_pose
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.layout import Box, SceneLayout
from symskill_pddl.kitchen.loose import Lid, Loose, Vessel
from symskill_pddl.kitchen.mjcf import Vec3

STEEP = math.radians(78.0)
"""The pitch at which food is taken and put down everywhere [rad]."""


@dataclass(frozen=True)
class Place:
    """Where a loose thing stands: on the 'counter', a unit, or in a dish, at (x, y) [m] in its frame, turned by `yaw` [rad].

    For the counter, the frame is that of the world.
    """

    on: str
    x: float
    y: float
    yaw: float


@dataclass(frozen=True, eq=False)
class Episode:
    """What is drawn from the seed.

    Attributes
    ----------
    focus : tuple of str
        Objects the task is about.
    shifts : dict of str to (float, float, float)
        Where the units stand or hang, relative to the layout [m].
    positions : dict of str to float
        How far the parts are open [rad] or [m].
    loose : dict of str to Place
        Where every loose thing stands.
    T_start : Pose
        Start pose of the hand.
    """

    focus: tuple[str, ...]
    shifts: dict[str, Vec3]
    positions: dict[str, float]
    loose: dict[str, Place]
    T_start: Pose

    def T_world(self, scene: SceneLayout, name: str) -> Pose:
        """Pose of a unit, or of a loose thing that stands at its place."""
        if name in scene.units:
            return Pose(np.add(scene.units[name].box.center, self.shifts[name]), np.array([1.0, 0.0, 0.0, 0.0]))
        place, thing = self.loose[name], scene.loose[name]
        below = Pose.identity() if place.on == "counter" else self.T_world(scene, place.on)
        # a millimetre above it, to settle
        height = _support(scene, place.on, thing) + 0.001
        yaw = np.array([math.cos(place.yaw / 2), 0.0, 0.0, math.sin(place.yaw / 2)])
        return below @ Pose(np.array([place.x, place.y, height]), yaw)

    def must_reach(self, scene: SceneLayout, T_world_door: Pose | None) -> tuple[Pose, ...]:
        """Hand poses without which the task cannot be done: the things of the focus, and the handle where the door is."""
        things = [name for name in scene.loose if name in self.focus]
        poses = [grasp_pose(scene, name, self.T_world(scene, name)) for name in things]
        if T_world_door is not None and "door" in self.focus and self.positions["door"] < layout.PARTS["door"].opened / 2:
            poses.append(hand_pose(T_world_door.apply(layout.HANDLE), math.radians(15.0), math.radians(42.0)))
        return tuple(poses)


def grasp_pose(scene: SceneLayout, name: str, T_world_thing: Pose) -> Pose:
    """A steep hand on a loose thing: about the middle of food, about a lid's knob, or where food stands in a dish."""
    shape = scene.loose[name].shape
    if isinstance(shape, Lid):
        return hand_pose(T_world_thing.apply([0.0, 0.0, shape.knob_z]), 0.0, STEEP)
    if isinstance(shape, Vessel):
        return hand_pose(T_world_thing.apply([0.0, 0.0, shape.floor_z + 0.02]), 0.0, STEEP)
    forward = T_world_thing.rotate([1.0, 0.0, 0.0])
    return hand_pose(T_world_thing.p, math.atan2(forward[1], forward[0]), STEEP)


def _support(scene: SceneLayout, on: str, thing: Loose) -> float:
    """Height of the thing's middle in the frame of what it stands on or in."""
    if on == "counter":
        return thing.half[2]
    if on in scene.units:
        unit = scene.units[on]
        return (INSIDE_FLOOR if unit.look == "cabinet" else unit.box.half[2]) + thing.half[2]
    dish = scene.loose[on].shape
    assert isinstance(dish, Vessel), f"nothing stands in '{on}'"
    return dish.rim_z - thing.shape.seat_z if isinstance(thing.shape, Lid) else dish.floor_z + thing.half[2]


INSIDE_FLOOR = layout.CABINET_INSIDE.center[2] - layout.CABINET_INSIDE.half[2]
"""Height of the cabinet's floor in its frame [m]."""


def uniform(rng: Generator, box: Box) -> Vec3:
    """A point of a box."""
    x, y, z = (float(c + h * rng.uniform(-1.0, 1.0)) for c, h in zip(box.center, box.half, strict=True))
    return x, y, z


def place(rng: Generator, on: str, box: Box, yaw_deg: tuple[float, float]) -> Place:
    """A place within `box`, turned by an angle between two [deg]."""
    x, y, _ = uniform(rng, box)
    return Place(on, x, y, math.radians(float(rng.uniform(*yaw_deg))))
