"""What a robot sees and is told: `Scene`, `Command`, and the `World` protocol between them.

The same `Scene` serves recordings and the live robot. It holds poses and types only: no joint angle, contact or success flag.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.geometry import Array, Pose, frozen

GRIPPER = "gripper"
"""The name of the end-effector frame wherever a frame is named; no object may have it."""


@dataclass(frozen=True, eq=False)
class Scene:
    """One moment of the world.

    Attributes
    ----------
    time : float
        Seconds since the start of the episode.
    T_world_ee : Pose
        End-effector frame, between the finger tips, z along the approach direction, y along the finger opening.
    aperture : float
        Opening between the finger pads [m].
    gripper_closed : bool
        The commanded state.
    objects : dict of str to str
        Type of each object, in a fixed order.
    T_world_objects : Pose
        Poses (n,) of the objects, in that order.
    unseen : frozenset of str
        Objects that are out of sight: their pose is the last one that was seen.
    """

    time: float
    T_world_ee: Pose
    aperture: float
    gripper_closed: bool
    objects: dict[str, str]
    T_world_objects: Pose
    unseen: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        if GRIPPER in self.objects:
            raise InputError(f"'{GRIPPER}' is the end effector's name, an object must have another one")
        if self.T_world_objects.shape != (len(self.objects),):
            raise InputError(f"{len(self.objects)} objects need {len(self.objects)} poses, got {self.T_world_objects.shape}")
        if not self.unseen <= self.objects.keys():
            unknown = min(self.unseen - self.objects.keys())
            raise InputError(f"unseen names the unknown object '{unknown}'; the scene has: {alternatives(self.objects)}")

    def pose(self, frame: str) -> Pose:
        """`T_world_frame` of an object, or of the end effector under the name 'gripper'."""
        if frame == GRIPPER:
            return self.T_world_ee
        try:
            return self.T_world_objects[list(self.objects).index(frame)]
        except ValueError:
            raise InputError(f"unknown object '{frame}'; the scene has: {alternatives(self.objects)}") from None


@dataclass(frozen=True, eq=False)
class Command:
    """What a world is told for one control period.

    `twist` (6,): linear [m/s] and angular [rad/s] velocity of the end-effector frame, both in world axes, the linear part at
    the frame's origin. `close_gripper`: the fingers' target state.
    """

    twist: Array
    close_gripper: bool

    def __post_init__(self) -> None:
        twist = frozen(self.twist)
        if twist.shape != (6,) or not np.all(np.isfinite(twist)):
            raise InputError(f"a command needs a finite twist (6,), got {np.asarray(self.twist)!r}")
        object.__setattr__(self, "twist", twist)

    @classmethod
    def hold(cls, close_gripper: bool) -> Command:
        """Stay where you are."""
        return cls(np.zeros(6), close_gripper)

    @classmethod
    def of(cls, linear: ArrayLike, angular: ArrayLike, close_gripper: bool) -> Command:
        return cls(np.concatenate([np.asarray(linear, float), np.asarray(angular, float)]), close_gripper)


class World(Protocol):
    """A simulator or a robot: poses out, twists in."""

    @property
    def period_s(self) -> float:
        """Control period [s]: how long one `step` lasts."""

    def observe(self) -> Scene:
        """The present scene."""

    def step(self, command: Command) -> Scene:
        """Carry out the command for one period and return the scene after it."""


@runtime_checkable
class Timed(Protocol):
    """A world that says what its last `step` spent on the robot's own business, apart from waiting or simulating."""

    @property
    def ms(self) -> Mapping[str, float]:
        """Duration of `observe` and of `controller` [ms], as far as they are known."""


@runtime_checkable
class Live(Protocol):
    """A world that does not wait: its clock goes on between two steps, as a robot's does."""

    @property
    def live(self) -> bool:
        """True: while a planner thinks, the world is told to stay where it is, once in every period."""
