"""The stepping loop: MuJoCo's model and data, and torque control of the arm between its half steps.

robosuite's own loop runs its Python controllers at every physics step and is five times slower.
"""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from symskill_pddl.control import PassiveController
from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, Pose, quat_multiply

OPEN_APERTURE = 0.08
_OPEN, _CLOSED = (0.04, -0.04), (-0.02, 0.02)
ARM_JOINTS = tuple(f"robot0_joint{i}" for i in range(1, 8))
FINGER_JOINTS = ("gripper0_right_finger_joint1", "gripper0_right_finger_joint2")
PADS = ("gripper0_right_finger1_pad_collision", "gripper0_right_finger2_pad_collision")
HAND = "gripper0_right_right_gripper"
GRIP_SITE = "gripper0_right_grip_site"
Q_GRIP_EE = np.array([np.sqrt(0.5), 0.0, 0.0, -np.sqrt(0.5)])
"""The grip site opens along x; the end-effector frame has y along the opening of the fingers."""
FINGER_FORCE = 45.0
"""Most the fingers' drives give [N], each; the real hand presses with up to 70 N."""


MAX_SPEED, MAX_RATE = 0.6, 2.0
"""What the arm carries out at most [m/s], [rad/s]; faster commands are scaled down."""


def limited(twist: Array) -> Array:
    """A twist (6,), scaled down as a whole to what the arm is allowed."""
    excess = max(float(np.linalg.norm(twist[:3])) / MAX_SPEED, float(np.linalg.norm(twist[3:])) / MAX_RATE, 1.0)
    return np.array(twist) / excess


def tune(mujoco: ModuleType, model: Any) -> None:
    """Set what robosuite's parts leave to the defaults: contacts that hold a grasp, the drives of the arm and of the fingers."""
    model.opt.timestep = 0.002
    model.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    model.opt.impratio = 5.0
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    tune_drives(model)


def tune_drives(model: Any) -> None:
    """Give the arm and the fingers the forces of the real ones."""
    for name in ARM_JOINTS:
        actuator = model.actuator(name.replace("robot0_joint", "robot0_torq_j")).id
        limit = 87.0 if int(name[-1]) < 5 else 12.0
        model.actuator_ctrlrange[actuator] = (-limit, limit)
    for i, name in enumerate(FINGER_JOINTS):
        actuator = model.actuator(f"gripper0_right_gripper_finger_joint{i + 1}").id
        # targets behind the closed position: without them a thin bar is held with 7 N only
        model.actuator_ctrlrange[actuator] = (-0.02, 0.04) if i == 0 else (-0.04, 0.02)
        model.actuator_forcerange[actuator] = (-FINGER_FORCE, FINGER_FORCE)
        model.dof_damping[model.joint(name).dofadr[0]] = 60.0


class Arm:
    """The arm and its hand in motion, in a model that holds whatever else.

    Attributes
    ----------
    model, data : mujoco.MjModel, mujoco.MjData
        The end-effector frame is that of a site, turned by a quaternion.
    controller : PassiveController
    hand : int
        The body of the hand.
    robot : frozenset of int
        The bodies of the arm and the hand.
    arm_range : ndarray (7, 2)
        Limits of the joints [rad].
    loads : list of callable
        Called in every physics step; they add forces to `data.xfrc_applied` and `data.qfrc_applied`, which are zero before.
    controller_s : float
        Wall-clock time of the controller in the last `advance` [s].
    """

    def __init__(
        self,
        mujoco: ModuleType,
        model: Any,
        data: Any,
        controller: PassiveController | None = None,
        *,
        site: str = GRIP_SITE,
        q_site_ee: Array | None = Q_GRIP_EE,
    ) -> None:
        self._mj, self.model, self.data = mujoco, model, data
        self.controller = controller or PassiveController()
        self.loads: list[Callable[[], None]] = []
        self.controller_s = 0.0
        joint, actuator = model.joint, model.actuator
        self._arm_q = np.array([joint(name).qposadr[0] for name in ARM_JOINTS])
        self._arm_v = np.array([joint(name).dofadr[0] for name in ARM_JOINTS])
        self._finger_q = np.array([joint(name).qposadr[0] for name in FINGER_JOINTS])
        self._site = int(model.site(site).id)
        self._q_site_ee = q_site_ee
        self.hand = int(model.body(HAND).id)
        names = (model.body(b).name for b in range(model.nbody))
        self.robot = frozenset(b for b, name in enumerate(names) if name.startswith(("robot0", "gripper0")))
        self._motors = np.array([actuator(n.replace("robot0_joint", "robot0_torq_j")).id for n in ARM_JOINTS])
        self._fingers = np.array([actuator(f"gripper0_right_gripper_finger_joint{i}").id for i in (1, 2)])
        self.arm_range: Array = np.array([joint(name).range for name in ARM_JOINTS])
        # the arm's own rows: views of the simulator's arrays, and where its mass matrix lies in the sparse one
        q, v, u = (_span(ids) for ids in (self._arm_q, self._arm_v, self._motors))
        self._arm = data.qpos[q], data.qvel[v], data.qfrc_bias[v], data.ctrl[u]
        self._all_J = np.zeros((6, model.nv))
        self._J, self._M = self._all_J[:, v], np.zeros((len(ARM_JOINTS), len(ARM_JOINTS)))
        self._M_at = _mass_entries(model, self._arm_v)

    # --- reading the state

    def T_world_ee(self) -> Pose:
        """Pose of the end-effector frame."""
        q = np.empty(4)
        self._mj.mju_mat2Quat(q, self.data.site_xmat[self._site])
        return Pose(self.data.site_xpos[self._site], q if self._q_site_ee is None else quat_multiply(q, self._q_site_ee))

    @property
    def aperture(self) -> float:
        """Opening between the finger pads [m]."""
        left, right = self.data.qpos[self._finger_q]
        return max(0.0, float(left - right))

    @property
    def arm(self) -> Array:
        """Joint positions (7,) [rad]."""
        return np.asarray(self.data.qpos[self._arm_q])

    def hand_velocity(self) -> Array:
        """Linear velocity (3,) of the end-effector frame [m/s], world axes."""
        return np.asarray(self.jacobian()[:3] @ self.data.qvel[self._arm_v])

    # --- setting it

    def set_arm(self, q: ArrayLike, aperture: float = OPEN_APERTURE) -> None:
        """Joint positions (7,) [rad] and opening of the fingers [m], at rest."""
        if np.shape(q) != (7,) or not np.all(np.isfinite(q)):
            raise InputError(f"the arm needs 7 finite joint positions, got {q!r}")
        self.data.qpos[self._arm_q], self.data.qvel[self._arm_v] = q, 0.0
        self.data.qpos[self._finger_q] = (aperture / 2, -aperture / 2)

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
