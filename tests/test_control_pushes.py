"""A hundred random pushes against a seven-joint arm that follows a learned field: the energy balance, and the way back."""

import numpy as np
import pytest

from symskill_pddl.control import ControlConfig, PassiveController
from symskill_pddl.geometry import Pose
from symskill_pddl.skills import FitConfig, Trajectory, fit_fields

mujoco = pytest.importorskip("mujoco")
pytestmark = pytest.mark.simulation

DT = 0.002
START = np.array([0.1, -0.4, 0.2, -1.9, 0.3, 1.7, 0.2])
LENGTHS, MASSES, AXES = (0.3, 0.05, 0.3, 0.08, 0.35, 0.08, 0.15), (3.0, 3.0, 3.0, 2.5, 2.5, 1.5, 0.7), "zyzyzyz"


def arm():
    """A chain of seven links with joints about z and y in turn, like a Panda's, without joint limits or friction."""
    axis = {"z": "0 0 1", "y": "0 1 0"}
    links = "".join(
        f'<body pos="0 0 {above}"><joint axis="{axis[a]}"/>'
        f'<inertial pos="0 0 {half}" mass="{m}" diaginertia="{0.01 * m} {0.01 * m} {0.006 * m}"/>'
        for above, half, m, a in zip((0.1, *LENGTHS[:-1]), 0.5 * np.array(LENGTHS), MASSES, AXES, strict=True)
    )
    text = (
        f'<mujoco><option timestep="{DT}" gravity="0 0 -9.81"/><worldbody>{links}'
        f'<body pos="0 0 {LENGTHS[-1]}"><site name="hand"/></body>{"</body>" * 7}</worldbody></mujoco>'
    )
    return mujoco.MjModel.from_xml_string(text)


def test_over_a_hundred_pushes_no_energy_is_made_and_the_arm_returns_to_its_field():
    model = arm()
    data = mujoco.MjData(model)
    data.qpos[:] = START
    mujoco.mj_forward(model, data)
    hand = model.site("hand").id
    M, J = np.zeros((7, 7)), np.zeros((6, 7))

    def pose() -> Pose:
        q = np.zeros(4)
        mujoco.mju_mat2Quat(q, data.site_xmat[hand])
        return Pose(data.site_xpos[hand].copy(), q)

    # a reach to where the hand begins, learned from one demonstration
    s = np.linspace(0.0, 1.0, 80)[:, None]
    goal = pose()
    shown = Pose.from_rotvec((1 - s) * np.array([-0.3, 0.2, 0.1]) + 0.05 * np.sin(np.pi * s), (1 - s) * np.array([0.2, 0.3, 0.0]))
    T = Pose(goal.p + shown.p, (shown @ Pose(np.zeros((80, 3)), np.tile(goal.q, (80, 1)))).q)
    (field,) = fit_fields([Trajectory(0.05 * np.arange(80), T)], FitConfig(max_fields=1))

    controller = PassiveController(
        ControlConfig(tank_refill=0.0, tank_capacity=200.0, posture=tuple(START), posture_rates=(0.0, 8.0))
    )
    rng = np.random.default_rng(0)
    worked, before, least, low = 0.0, np.zeros(7), np.inf, np.inf
    for push in range(100):
        force = rng.normal(size=3)
        force *= rng.uniform(5.0, 40.0) / np.linalg.norm(force)
        wrench, lasts = np.concatenate([force, rng.normal(0.0, 1.0, 3)]), rng.uniform(0.1, 0.3)
        for i in range(round(0.7 / DT)):
            mujoco.mj_jacSite(model, data, J[:3], J[3:], hand)
            mujoco.mj_fullM(model, M, data.qM)
            if i % 5 == 0:
                twist = field.twist(pose())
            tau = controller.torques(data.qpos, data.qvel, J, M, data.qfrc_bias, twist, DT)
            # stored and in the tank, whose books reach to the beginning of this step
            energy = 0.5 * data.qvel @ M @ data.qvel + controller.spring_energy + controller.tank_energy
            # what was extracted, the negative of what the pushes put in, comes out of what was stored and in the tank; and since
            # that holds from any moment on, the balance never rises above where it once was
            balance = energy - worked
            assert balance <= least + 0.05, f"push {push}, {i * DT:.3f} s: {balance - least} J came from nowhere"
            least = min(least, balance)
            low = min(low, controller.tank_energy)
            before = data.qvel.copy()
            load = J.T @ wrench if i * DT < lasts else np.zeros(7)
            data.qfrc_applied[:] = load + tau
            mujoco.mj_step(model, data)
            worked += DT * float(load @ (0.5 * (before + data.qvel)))
        off = J @ data.qvel - field.twist(pose())
        assert np.linalg.norm(off[:3]) < 0.03, f"push {push}: {off[:3]} m/s beside the field"
        assert np.linalg.norm(off[3:]) < 0.2, f"push {push}: {off[3:]} rad/s beside the field"
    assert worked > 10.0  # the pushes did push
    assert low > 0.0
    assert np.linalg.norm(data.site_xpos[hand] - goal.p) < 0.05
