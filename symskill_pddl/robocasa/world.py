"""`RoboCasaWorld`: an episode in a RoboCasa kitchen as a `World`, judged by RoboCasa."""

from __future__ import annotations

from time import perf_counter
from typing import Any

import numpy as np
from numpy.random import default_rng

from symskill_pddl.control import ELBOW_UP, ControlConfig, PassiveController
from symskill_pddl.demonstrator.part import Jointed
from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.panda.arm import OPEN_APERTURE, Arm, limited
from symskill_pddl.robocasa.backend import load_mujoco
from symskill_pddl.robocasa.beside import free_beside, hand_fits
from symskill_pddl.robocasa.environment import ATTEMPTS, draw, tune
from symskill_pddl.robocasa.tasks import Split, TaskSpec
from symskill_pddl.robocasa.things import NoRoomError, look
from symskill_pddl.robocasa.tracking import Model
from symskill_pddl.robocasa.view import FLIP, View
from symskill_pddl.scene import Command, Scene

PERIOD_S = 0.05
MIRRORED_POSTURE = tuple(np.array(ELBOW_UP) * (-1, 1, -1, 1, -1, 1, -1) + np.array([0, 0, 0, 0, 0, 0, np.pi / 2]))
"""The arm's mirror image of `ELBOW_UP`: the hand is mounted at 45 degrees to its last joint."""


class RoboCasaWorld:
    """One episode: the robot where RoboCasa puts it, its base held, in front of what the task is about.

    Attributes
    ----------
    spec : TaskSpec
    env : robocasa Kitchen
        RoboCasa's environment. For its judge and the demonstrator; learned controllers see `observe()` only.
    view : View
        How the robot sees it.
    arm : Arm
        The arm in the simulator's world.
    extents : dict of str to (float, float, float)
        Half sizes per type [m].
    """

    period_s = PERIOD_S
    placements: tuple[tuple[str, str], ...] = ()

    def __init__(self, spec: TaskSpec, env: Any) -> None:
        self.spec, self.env = spec, env
        mujoco, model, data = load_mujoco(), env.sim.model._model, env.sim.data._data
        tune(model)
        found = Model(mujoco, model, data)
        seen = look(spec.about, found, env, getattr(env, spec.part))
        self.view = View(found.T_world_robot(), seen.mirrored)
        posture = MIRRORED_POSTURE if seen.mirrored else ELBOW_UP
        self.arm = Arm(mujoco, model, data, PassiveController(ControlConfig(posture=posture)))
        self.moving = {part.tracked.name: part for part in seen.moving}
        self.tracked, self._room = seen.tracked, seen.room
        self._types = {t.name: t.type for t in self.tracked}
        self._bodies = np.array([t.body for t in self.tracked])
        self._T_body_frame = Pose.stack([t.T_body_frame for t in self.tracked])
        self.extents = {t.type: t.half for t in self.tracked if t.half is not None}
        self._steps = round(PERIOD_S / model.opt.timestep)
        self._closed, self._start = False, float(data.time)
        self.ms: dict[str, float] = {}
        data.qvel[:] = 0.0
        # the base is held by its own drives and brakes; the hand begins with open fingers, RoboCasa's are half open
        data.ctrl[:] = 0.0
        self.arm.set_arm(self.arm.arm, OPEN_APERTURE)
        self.arm.forward()

    @property
    def task(self) -> str:
        """Name of the task."""
        return self.spec.name

    @property
    def goals(self) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """The demonstrated tasks whose learned goals together are the goal, each with the objects that it is about."""
        return self.spec.goals

    def part(self, name: str) -> Jointed:
        """A part that turns or slides, as it is seen."""
        return self.moving[name].seen(self.view)

    def room(self, name: str) -> Array:
        """Where something can be put down in or on an object: a point in its frame (3,)."""
        return np.array(self._room[name]) * (FLIP if self.view.mirrored else 1.0)

    def free_beside(self, name: str) -> bool:
        """Whether there is room for the arm on the outer side of a door that is wide open."""
        return free_beside(
            Model(load_mujoco(), self.arm.model, self.arm.data), self.view, self.part(name), self.moving[name].tracked.body
        )

    def hand_fits(self, name: str, door: str) -> bool:
        """Whether a hand gets to a thing behind a door when that is open."""
        return hand_fits(self.part(door), self.observe().pose(name).p)

    def travel(self, name: str) -> float:
        """How far a part can be opened [rad] or [m]."""
        return self.moving[name].travel

    def observe(self) -> Scene:
        """The present scene."""
        data = self.arm.data
        T_world = Pose(data.xpos[self._bodies], data.xquat[self._bodies]) @ self._T_body_frame
        return Scene(
            time=round(float(data.time) - self._start, 9),
            T_world_ee=self.view.pose(self.arm.T_world_ee()),
            aperture=self.arm.aperture,
            gripper_closed=self._closed,
            objects=self._types,
            T_world_objects=self.view.pose(T_world),
        )

    def step(self, command: Command) -> Scene:
        """Carry out the command for one period and return the scene after it."""
        self._closed = command.close_gripper
        self.arm.advance(self.view.twist(limited(command.twist)), command.close_gripper, self._steps)
        begin = perf_counter()
        scene = self.observe()
        self.ms = {"observe": 1e3 * (perf_counter() - begin), "controller": 1e3 * self.arm.controller_s}
        return scene

    def succeeded(self) -> bool:
        """RoboCasa's own judge, on the simulator's own state, after what RoboCasa does at the end of every step."""
        self.env.update_state()
        return bool(self.env._check_success())


def open_world(spec: TaskSpec, seed: int, split: Split = "target") -> RoboCasaWorld:
    """An episode of a task, drawn from the seed in the kitchens of a split; same seed, same episode.

    Raises
    ------
    InputError
        No kitchen was found that has what the task is about, within reach.
    """
    rng = default_rng([seed, 365])
    for _ in range(ATTEMPTS):
        try:
            world = RoboCasaWorld(spec, draw(spec, rng, split))
        except NoRoomError:
            continue
        if spec.closes and not world.free_beside("door"):
            continue
        if spec.closes and spec.carried and not world.hand_fits(spec.focus[0], "door"):
            continue
        return world
    raise InputError(f"no kitchen of RoboCasa in {ATTEMPTS} draws in which an arm gets to both sides of the door, seed {seed}")
