import numpy as np
import pytest

from symskill_pddl.kitchen import make
from symskill_pddl.kitchen.backend import load_mujoco
from symskill_pddl.scene import Command

pytestmark = pytest.mark.simulation


@pytest.mark.parametrize("task", ["PnPCabToCounter", "Play"])
def test_the_controller_gets_the_simulators_own_numbers(task):
    kitchen = make(task, 0)
    physics, model, data = kitchen.physics, kitchen.physics.model, kitchen.physics.data
    kitchen.step(Command.of([0.1, 0.0, -0.1], [0.0, 0.2, 0.0], True))

    # the same, read from the state the slow way
    mj, v = load_mujoco(), physics._arm_v
    full, J = np.zeros((model.nv, model.nv)), np.zeros((6, model.nv))
    mj.mj_fullM(model, full, data.qM)
    mj.mj_jacSite(model, data, J[:3], J[3:], physics._site)
    given = []
    physics.controller.torques = lambda *arguments: given.append([np.array(a) for a in arguments]) or np.full(7, 0.5)
    before = data.qpos[physics._arm_q].copy(), data.qvel[v].copy(), data.qfrc_bias[v].copy()
    physics.advance(np.zeros(6), False, 1)
    q, qd, jacobian, M, bias, twist, dt = given[-1]
    np.testing.assert_array_equal(q, before[0])
    np.testing.assert_array_equal(qd, before[1])
    np.testing.assert_array_equal(bias, before[2])
    np.testing.assert_array_equal(jacobian, J[:, v])
    np.testing.assert_array_equal(M, full[np.ix_(v, v)])
    assert (twist.tolist(), dt) == ([0.0] * 6, 0.002)
    np.testing.assert_array_equal(data.ctrl[physics._motors], 0.5)
