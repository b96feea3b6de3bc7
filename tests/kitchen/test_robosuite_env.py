import subprocess
import sys

import numpy as np
import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import make
from symskill_pddl.kitchen.backend import load_robosuite

pytestmark = pytest.mark.simulation
QUIET = {"has_renderer": False, "has_offscreen_renderer": False, "use_camera_obs": False}


def environment(task, seed, **arguments):
    robosuite = load_robosuite()
    from robosuite.utils.log_utils import ROBOSUITE_DEFAULT_LOGGER

    import symskill_pddl.kitchen.robosuite_env

    ROBOSUITE_DEFAULT_LOGGER.setLevel("ERROR")
    assert symskill_pddl.kitchen.robosuite_env.SymSkillKitchen.__name__ in robosuite.ALL_ENVIRONMENTS
    controller = robosuite.load_composite_controller_config(robot="Panda")
    assert controller["body_parts"]["right"]["type"] == "OSC_POSE"
    arguments = {"controller_configs": controller, **QUIET, **arguments}
    return robosuite.make("SymSkillKitchen", robots="Panda", task=task, seed=seed, **arguments)


@pytest.fixture(scope="module")
def env():
    env = environment("OpenDrawer", 7)
    yield env
    env.close()


def test_it_is_one_of_robosuites_own_kind(env):
    from robosuite.environments.manipulation.manipulation_env import ManipulationEnv

    assert isinstance(env, ManipulationEnv)
    assert env.action_dim == 7


def test_the_first_reset_starts_the_episode_of_the_seed():
    env, kitchen = environment("PnPCounterToCab", 3), make("PnPCounterToCab", 3)
    seen, scene = env.reset(), kitchen.observe()
    assert env.episode.focus == kitchen.focus
    np.testing.assert_allclose(seen["robot0_eef_pos"], scene.T_world_ee.p, atol=1e-6)
    for name in scene.objects:
        T = Pose(seen[f"{name}_pos"], np.roll(seen[f"{name}_quat"], 1))
        np.testing.assert_allclose(T.p, scene.pose(name).p, atol=1e-6, err_msg=name)
        np.testing.assert_allclose(T.q, scene.pose(name).q, atol=1e-6, err_msg=name)
    assert seen["robot0_gripper_qpos"][0] == pytest.approx(0.04, abs=2e-3)


def test_same_seed_same_placements_and_motion(env):
    other = environment("OpenDrawer", 7)
    fresh = environment("OpenDrawer", 7)
    first, again, second = other.reset(), fresh.reset(), other.reset()
    np.testing.assert_array_equal(first["object-state"], again["object-state"])
    assert np.abs(first["cheese_pos"] - second["cheese_pos"]).max() > 1e-3
    action = np.array([0.2, 0.1, 0.3, 0.0, 0.1, 0.0, 1.0])
    fresh.reset()
    for _ in range(3):
        a, b = other.step(action)[0], fresh.step(action)[0]
    np.testing.assert_array_equal(a["robot0_joint_pos"], b["robot0_joint_pos"])


def test_osc_holds_still_and_moves(env):
    start = env.reset()
    for _ in range(10):
        seen, reward, done, _ = env.step(np.zeros(7))
    np.testing.assert_allclose(seen["robot0_eef_pos"], start["robot0_eef_pos"], atol=1e-3)
    assert (reward, done) == (0.0, False)
    action = np.zeros(7)
    action[2], action[6] = 0.5, 1.0
    for _ in range(10):
        seen = env.step(action)[0]
    assert seen["robot0_eef_pos"][2] - start["robot0_eef_pos"][2] > 0.03
    assert seen["robot0_gripper_qpos"][0] < 0.02


def test_the_judge_is_the_kitchens(env):
    env.reset()
    assert not env._check_success()
    env.physics.set_part("drawer", 0.19)
    _, reward, _, _ = env.step(np.zeros(7))
    assert env._check_success()
    assert reward == 1.0


def test_compiling_the_model_again_changes_nothing():
    env = environment("TurnOnStove", 1, hard_reset=True, use_object_obs=False)
    seen = env.reset()
    assert "cheese_pos" not in seen
    assert env.physics.model is env.sim.model._model
    np.testing.assert_allclose(seen["robot0_eef_pos"], make("TurnOnStove", 1).observe().T_world_ee.p, atol=1e-6)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"robots": "Sawyer"}, "laid out for one robot, 'Panda'; got 'Sawyer'"),
        ({"robots": ["Panda", "Panda"]}, "one robot"),
        ({"robots": "Panda", "task": "Fly"}, "unknown task 'Fly'"),
    ],
)
def test_bad_arguments(env, arguments, message):
    with pytest.raises(InputError, match=message):
        type(env)(**arguments)


def test_learning_and_planning_do_not_load_it():
    code = "import sys, symskill_pddl.learning, symskill_pddl.planning, symskill_pddl.kitchen; print('robosuite' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "False\n"


def test_robosuites_own_gymnasium_wrapper_takes_it(env):
    from robosuite.wrappers import GymWrapper

    wrapped = GymWrapper(env)
    observation, _ = wrapped.reset()
    after, reward, terminated, truncated, _ = wrapped.step(wrapped.action_space.sample())
    assert observation.shape == after.shape == wrapped.observation_space.shape
    assert (reward, terminated, truncated) == (0.0, False, False)


def test_an_episode_is_played_back_from_its_model_and_states():
    env, other = environment("OpenDrawer", 7), environment("OpenDrawer", 1)
    env.reset()
    other.reset()
    # as robosuite's recordings hold it
    other.reset_from_xml_string(env.sim.model.get_xml())
    other.sim.set_state_from_flattened(env.sim.get_state().flatten())
    other.sim.forward()
    for name in env.task_spec.scene.types:
        np.testing.assert_allclose(other.physics.T_world(name).p, env.physics.T_world(name).p, atol=1e-5, err_msg=name)
    assert not other._check_success()
