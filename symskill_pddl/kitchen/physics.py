"""The stepping loop: MuJoCo's model and data, torque control between its half steps, and what only a simulator can read or set.

robosuite's own loop runs its Python controllers at every physics step and is five times slower.
"""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from symskill_pddl.control import PassiveController
from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.kitchen import layout, loose
from symskill_pddl.kitchen.backend import load_mujoco
from symskill_pddl.kitchen.fixtures import joint_of
from symskill_pddl.kitchen.layout import SceneLayout
from symskill_pddl.kitchen.model import ARM_JOINTS, EE_SITE, FINGER_JOINTS, scene_model

OPEN_APERTURE = 0.08
ROBOT = "robot"
"""Stands for every part of the robot among what touches."""
_OPEN, _CLOSED = (0.04, -0.04), (-0.02, 0.02)


class Physics:
    """One kitchen in motion. All this is the simulator's own state: for set-up, judges and disturbances, not for controllers.

    Attributes
    ----------
    scene : SceneLayout
    model, data : mujoco.MjModel, mujoco.MjData
        Those given, else new ones.
    controller : PassiveController
    bodies : dict of str to int
        MuJoCo's body of every object.
    hand : int
        The body of the hand.
    robot : frozenset of int
        The bodies of the arm and the hand.
    loads : list of callable
        Called in every physics step; they add forces to `data.xfrc_applied` and `data.qfrc_applied`, which are zero before.
    controller_s : float
        Wall-clock time of the controller in the last `advance` [s].
    """

    def __init__(
        self,
        scene: SceneLayout = layout.KITCHEN,
        controller: PassiveController | None = None,
        *,
        model: Any = None,
        data: Any = None,
    ) -> None:
        self._mj = load_mujoco()
        self.scene = scene
        self.model = scene_model(scene) if model is None else model
        self.data = self._mj.MjData(self.model) if data is None else data
        self.controller = controller or PassiveController()
        self.loads: list[Callable[[], None]] = []
        self.controller_s = 0.0

        joint = self.model.joint
        self._arm_q = np.array([joint(name).qposadr[0] for name in ARM_JOINTS])
        self._arm_v = np.array([joint(name).dofadr[0] for name in ARM_JOINTS])
        self._finger_q = np.array([joint(name).qposadr[0] for name in FINGER_JOINTS])
        self._part_q = {name: int(joint(joint_of(name)).qposadr[0]) for name in scene.parts}
        self._part_v = {name: int(joint(joint_of(name)).dofadr[0]) for name in scene.parts}
        self._loose_q = {name: int(joint(loose.joint_of(name)).qposadr[0]) for name in scene.loose}
        self._loose_v = {name: int(joint(loose.joint_of(name)).dofadr[0]) for name in scene.loose}
        self._site = int(self.model.site(EE_SITE).id)
        self.hand = int(self.model.body("gripper0_right_right_gripper").id)
        body = self.model.body
        self.bodies = {name: int(body(loose.body_of(name) if name in scene.loose else name).id) for name in scene.types}
        self._body_ids = np.array(list(self.bodies.values()))
        self.bodies[layout.OBSTACLE] = int(body(layout.OBSTACLE).id)
        names = (body(b).name for b in range(self.model.nbody))
        self.robot = frozenset(b for b, name in enumerate(names) if name.startswith(("robot0", "gripper0")))
        self._owner = self._owners()
        actuator = self.model.actuator
        self._motors = np.array([actuator(n.replace("robot0_joint", "robot0_torq_j")).id for n in ARM_JOINTS])
        self._fingers = np.array([actuator(f"gripper0_right_gripper_finger_joint{i}").id for i in (1, 2)])
        self.arm_range: Array = np.array([joint(name).range for name in ARM_JOINTS])
        # the arm's own rows: views of the simulator's arrays, and where its mass matrix lies in the sparse one
        data, (q, v, u) = self.data, (_span(ids) for ids in (self._arm_q, self._arm_v, self._motors))
        self._arm = data.qpos[q], data.qvel[v], data.qfrc_bias[v], data.ctrl[u]
        self._all_J = np.zeros((6, self.model.nv))
        self._J, self._M = self._all_J[:, v], np.zeros((len(ARM_JOINTS), len(ARM_JOINTS)))
        self._M_at = _mass_entries(self.model, self._arm_v)

    # --- reading the state

    def T_world_ee(self) -> Pose:
        site = self.data.site(EE_SITE)
        q = np.empty(4)
        self._mj.mju_mat2Quat(q, site.xmat)
        return Pose(site.xpos, q)

    def T_world_objects(self) -> Pose:
        """Poses (n,) of the objects in the order of `scene.types`."""
        return Pose(self.data.xpos[self._body_ids], self.data.xquat[self._body_ids])

    def T_world(self, name: str) -> Pose:
        body = self.bodies[name]
        return Pose(self.data.xpos[body], self.data.xquat[body])

    @property
    def aperture(self) -> float:
        """Opening between the finger pads [m]."""
        left, right = self.data.qpos[self._finger_q]
        return max(0.0, float(left - right))

    @property
    def arm(self) -> Array:
        """Joint positions (7,) [rad]."""
        return np.asarray(self.data.qpos[self._arm_q])

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

    def hand_velocity(self) -> Array:
        """Linear velocity (3,) of the end-effector frame [m/s], world axes."""
        return np.asarray(self.jacobian()[:3] @ self.data.qvel[self._arm_v])

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

    def set_arm(self, q: ArrayLike, aperture: float = OPEN_APERTURE) -> None:
        """Joint positions (7,) [rad] and opening of the fingers [m], at rest."""
        if np.shape(q) != (7,) or not np.all(np.isfinite(q)):
            raise InputError(f"the arm needs 7 finite joint positions, got {q!r}")
        self.data.qpos[self._arm_q], self.data.qvel[self._arm_v] = q, 0.0
        self.data.qpos[self._finger_q] = (aperture / 2, -aperture / 2)

    def put_obstacle(self, p: ArrayLike) -> None:
        """Hold the obstacle at a point (3,) [m]; it gives way to nothing."""
        self.data.mocap_pos[self.model.body_mocapid[self.bodies[layout.OBSTACLE]]] = p

    def forward(self) -> None:
        """Recompute all that follows from the state."""
        self._mj.mj_forward(self.model, self.data)

    def jacobian(self) -> Array:
        """Jacobian (6, 7) of the end-effector frame, linear rows first, world axes."""
        self._mj.mj_jacSite(self.model, self.data, self._all_J[:3], self._all_J[3:], self._site)
        return np.ascontiguousarray(self._J)

    def kinematics(self) -> None:
        """Recompute poses only (for inverse kinematics)."""
        self._mj.mj_kinematics(self.model, self.data)
        self._mj.mj_comPos(self.model, self.data)

    # --- motion

    def advance(self, twist: Array, close_gripper: bool, steps: int) -> None:
        """Run physics steps with the arm tracking `twist` (6,) and the fingers driven shut or open."""
        mj, model, data = self._mj, self.model, self.data
        dt, torques, jacobian = model.opt.timestep, self.controller.torques, self.jacobian
        (q, qd, bias, motors), M, M_at, qM = self._arm, self._M, self._M_at, data.qM
        data.ctrl[self._fingers] = _CLOSED if close_gripper else _OPEN
        self._unload()
        self.controller_s = 0.0
        for _ in range(steps):
            mj.mj_step1(model, data)
            if self.loads:
                self._unload()
                for load in self.loads:
                    load()
            begin = perf_counter()
            qM.take(M_at, out=M)
            motors[:] = torques(q, qd, jacobian(), M, bias, twist, dt)
            self.controller_s += perf_counter() - begin
            mj.mj_step2(model, data)
        # poses belong to the state after the last step, not the one before it
        mj.mj_forward(model, data)

    def _unload(self) -> None:
        self.data.qfrc_applied[:] = 0.0
        self.data.xfrc_applied[:] = 0.0


def _span(ids: NDArray[np.int_]) -> slice:
    """Indices that follow each other, as a slice, which makes a view."""
    assert np.array_equal(ids, ids[0] + np.arange(len(ids))), ids
    return slice(int(ids[0]), int(ids[-1]) + 1)


def _mass_entries(model: Any, dofs: NDArray[np.int_]) -> NDArray[np.int_]:
    """Where the mass matrix of a chain of joints, each moving the next, lies in the model's sparse one `qM` (n, n)."""
    found = np.zeros((len(dofs), len(dofs)), dtype=int)
    for i, dof in enumerate(dofs):
        # a row holds a joint's own entry, then those of its ancestors, the nearest first
        for back in range(i + 1):
            found[i, i - back] = found[i - back, i] = model.dof_Madr[dof] + back
    return found
