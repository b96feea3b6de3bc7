"""The simulated kitchen's state: what only a simulator can read or set."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from symskill_pddl.control import PassiveController
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import layout, loose
from symskill_pddl.kitchen.backend import load_mujoco
from symskill_pddl.kitchen.fixtures import joint_of
from symskill_pddl.kitchen.layout import SceneLayout
from symskill_pddl.kitchen.model import EE_SITE, scene_model
from symskill_pddl.panda.arm import Arm

ROBOT = "robot"
"""Stands for every part of the robot among what touches."""


class Physics(Arm):
    """One kitchen in motion. All this is the simulator's own state: for set-up, judges and disturbances, not for controllers.

    Attributes
    ----------
    scene : SceneLayout
    model, data : mujoco.MjModel, mujoco.MjData
        Those given, else new ones.
    bodies : dict of str to int
        MuJoCo's body of every object.
    """

    def __init__(
        self,
        scene: SceneLayout = layout.KITCHEN,
        controller: PassiveController | None = None,
        *,
        model: Any = None,
        data: Any = None,
    ) -> None:
        mujoco = load_mujoco()
        model = scene_model(scene) if model is None else model
        super().__init__(mujoco, model, mujoco.MjData(model) if data is None else data, controller, site=EE_SITE, q_site_ee=None)
        self.scene = scene
        joint, body = self.model.joint, self.model.body
        self._part_q = {name: int(joint(joint_of(name)).qposadr[0]) for name in scene.parts}
        self._part_v = {name: int(joint(joint_of(name)).dofadr[0]) for name in scene.parts}
        self._loose_q = {name: int(joint(loose.joint_of(name)).qposadr[0]) for name in scene.loose}
        self._loose_v = {name: int(joint(loose.joint_of(name)).dofadr[0]) for name in scene.loose}
        self.bodies = {name: int(body(loose.body_of(name) if name in scene.loose else name).id) for name in scene.types}
        self._body_ids = np.array(list(self.bodies.values()))
        self.bodies[layout.OBSTACLE] = int(body(layout.OBSTACLE).id)
        self._owner = self._owners()

    # --- reading the state

    def T_world_objects(self) -> Pose:
        """Poses (n,) of the objects in the order of `scene.types`."""
        return Pose(self.data.xpos[self._body_ids], self.data.xquat[self._body_ids])

    def T_world(self, name: str) -> Pose:
        body = self.bodies[name]
        return Pose(self.data.xpos[body], self.data.xquat[body])

    def position(self, part: str) -> float:
        """How far a part is open [rad] or [m]."""
        return float(self.data.qpos[self._part_q[part]])

    @property
    def door_angle(self) -> float:
        """[rad]"""
        return self.position("door")

    def joint_v(self, name: str) -> int:
        """Index, in the velocities, of the joint that a part turns or slides on, or of the six of what is loose."""
        return int(self.model.jnt_dofadr[self.model.body_jntadr[self.bodies[name]]])

    def speed(self, thing: str) -> float:
        """Speed of a loose thing's centre [m/s]."""
        v = self._loose_v[thing]
        return float(np.linalg.norm(self.data.qvel[v : v + 3]))

    def robot_touches(self, name: str) -> bool:
        """Whether any part of the robot is in contact with the object."""
        body = self.bodies[name]
        owners = self.model.geom_bodyid[self.data.contact.geom[: self.data.ncon]]
        return any((a == body and b in self.robot) or (b == body and a in self.robot) for a, b in owners.tolist())

    @property
    def loose(self) -> tuple[str, ...]:
        """Objects that nothing holds in place."""
        return tuple(name for name, body in self.bodies.items() if self.model.body_dofnum[body] == 6)

    def contacts(self) -> frozenset[tuple[str, str]]:
        """Pairs of what touches, in alphabetical order: objects, and `ROBOT`."""
        owners = self.model.geom_bodyid[self.data.contact.geom[: self.data.ncon]].tolist()
        pairs = ((self._owner[a], self._owner[b]) for a, b in owners)
        return frozenset((min(a, b), max(a, b)) for a, b in pairs if a and b and a != b)

    def _owners(self) -> list[str]:
        """By body: the object that it is or belongs to, `ROBOT`, or '' for the room."""
        names = {body: name for name, body in self.bodies.items()} | dict.fromkeys(self.robot, ROBOT)
        owner = [""] * self.model.nbody
        for body in range(1, self.model.nbody):  # parents come first
            owner[body] = names.get(body, owner[self.model.body_parentid[body]])
        return owner

    # --- setting the state, for episodes and tests

    def reset(self) -> None:
        """The model's zero state, with nothing acting on it."""
        self._mj.mj_resetData(self.model, self.data)
        self.loads.clear()
        self.controller.reset()

    def start_clock(self) -> None:
        """Bring everything to a halt and call this moment the start."""
        self.data.qvel[:] = 0.0
        self.data.time = 0.0
        self.controller.reset()
        self.forward()

    def set_unit(self, name: str, shift: ArrayLike) -> None:
        """Put a unit at its place in the layout plus `shift` (3,) [m]."""
        self.model.body_pos[self.bodies[name]] = np.asarray(self.scene.units[name].box.center) + np.asarray(shift)

    def set_part(self, name: str, position: float) -> None:
        """Open a part that far [rad] or [m], at rest."""
        self.data.qpos[self._part_q[name]], self.data.qvel[self._part_v[name]] = position, 0.0

    def set_loose(self, name: str, T_world_thing: Pose) -> None:
        """Put a loose thing somewhere, at rest."""
        at, v = self._loose_q[name], self._loose_v[name]
        self.data.qpos[at : at + 7], self.data.qvel[v : v + 6] = T_world_thing.vector(), 0.0

    def put_obstacle(self, p: ArrayLike) -> None:
        """Hold the obstacle at a point (3,) [m]; it gives way to nothing."""
        self.data.mocap_pos[self.model.body_mocapid[self.bodies[layout.OBSTACLE]]] = p
