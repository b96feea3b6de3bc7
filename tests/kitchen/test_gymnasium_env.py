import subprocess
import sys
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from symskill_pddl.errors import InputError
from symskill_pddl.kitchen import gymnasium_env as module
from symskill_pddl.kitchen import make
from symskill_pddl.kitchen.gymnasium_env import ENV_ID, KitchenEnv
from symskill_pddl.panda.arm import MAX_RATE, MAX_SPEED

pytestmark = pytest.mark.simulation


@pytest.fixture(scope="module")
def env():
    env = gymnasium.make(ENV_ID, task="OpenDrawer")
    yield env
    env.close()


def test_gymnasium_itself_finds_no_fault(env):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped, skip_render_check=True)


@pytest.mark.parametrize("task", ["PnPCounterToStove", "Play"])
def test_observations_are_of_the_space_in_both_scenes(task):
    env = KitchenEnv(task)
    observation, info = env.reset(seed=1)
    assert observation in env.observation_space
    assert set(info["focus"]) <= set(observation["objects"])


def test_a_seed_names_the_episode_and_one_action_the_command(env):
    observation, info = env.reset(seed=5)
    scene = make("OpenDrawer", 5).observe()
    assert (info["seed"], info["success"]) == (5, False)
    np.testing.assert_array_equal(observation["gripper"], scene.T_world_ee.vector().astype(np.float32))
    np.testing.assert_array_equal(observation["objects"]["drawer"], scene.pose("drawer").vector().astype(np.float32))
    action = np.array([0.0, 0.5, 0.5, 0.0, 0.0, 0.0, 1.0], np.float32)
    for _ in range(6):
        after, reward, terminated, truncated, _ = env.step(action)
    np.testing.assert_allclose((after["gripper"] - observation["gripper"])[1:3], 0.5 * MAX_SPEED * 0.3, atol=0.03)
    assert after["closed"][0] == 1.0
    assert after["aperture"][0] < 0.01
    assert (reward, terminated, truncated) == (0.0, False, False)
    assert module.SCALE[-1] == MAX_RATE


def test_done_when_the_judge_says_so(env):
    env.reset(seed=0)
    env.unwrapped.kitchen.physics.set_part("drawer", 0.19)
    observation, reward, terminated, truncated, info = env.step(np.zeros(7, np.float32))
    assert (reward, terminated, truncated, info["success"]) == (1.0, True, False, True)
    assert observation in env.observation_space


def test_the_time_is_limited():
    env = gymnasium.make(ENV_ID, task="OpenDrawer", max_episode_steps=3)
    env.reset(seed=0)
    assert [env.step(np.zeros(7, np.float32))[3] for _ in range(3)] == [False, False, True]


def test_disturbances_happen():
    env = KitchenEnv("OpenDrawer", disturbances=("push:60N,0.5s@t=0",))
    start, _ = env.reset(seed=0)
    for _ in range(8):
        observation, *_ = env.step(np.zeros(7))
    assert abs(observation["gripper"][1] - start["gripper"][1]) > 0.01


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"task": "Fly"}, "unknown task 'Fly'"),
        ({"disturbances": ("rain@t=1",)}, "unknown name 'rain'"),
        ({"render_mode": "human"}, "unknown render mode 'human'; there is: rgb_array"),
    ],
)
def test_bad_arguments(arguments, message):
    with pytest.raises(InputError, match=message):
        KitchenEnv(**arguments)


@pytest.mark.parametrize("action", [np.zeros(6), np.full(7, np.nan)])
def test_bad_actions(env, action):
    env.reset(seed=0)
    with pytest.raises(InputError, match="seven finite numbers"):
        env.unwrapped.step(action)


def test_no_step_before_reset_and_no_options():
    env = KitchenEnv()
    with pytest.raises(InputError, match="call reset"):
        env.step(np.zeros(7))
    with pytest.raises(InputError, match="takes no options"):
        env.reset(options={"speed": 2})
    assert env.render() is None


def test_without_gymnasium_one_line_says_what_to_install():
    code = (
        "import sys; sys.modules['gymnasium'] = None\n"
        "from symskill_pddl.errors import MissingDependencyError\n"
        "try:\n    import symskill_pddl.kitchen.gymnasium_env\nexcept MissingDependencyError as error:\n    print(error)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.count("\n") == 1
    assert "pip install gymnasium" in done.stdout
