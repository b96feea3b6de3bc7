"""The kitchen as a robosuite environment; importing this module registers it.

    import robosuite, symskill_pddl.kitchen.robosuite_env
    env = robosuite.make("SymSkillKitchen", robots="Panda", task="OpenDrawer", seed=7)

Model, episodes and judges are those of `symskill_pddl.kitchen`; controllers, observables, cameras and the loop are robosuite's.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import Any

import numpy as np

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array
from symskill_pddl.kitchen.backend import load_robosuite
from symskill_pddl.kitchen.model import task_model, tune
from symskill_pddl.kitchen.physics import Physics
from symskill_pddl.kitchen.tasks import task_named
from symskill_pddl.kitchen.world import set_up

load_robosuite()

from robosuite.environments.manipulation.manipulation_env import ManipulationEnv  # noqa: E402
from robosuite.utils.observables import Observable, sensor  # noqa: E402


class SymSkillKitchen(ManipulationEnv):  # type: ignore[misc]  # its metaclass registers it under this name
    """One task of the kitchen.

    Parameters
    ----------
    robots : str or list of str
        'Panda': the kitchen is laid out for it.
    task : str
        One of `symskill_pddl.kitchen.TASKS`.
    seed : int, optional
        The first `reset` starts the episode of `symskill_pddl.kitchen.make(task, seed)`, the later ones go on in the stream.
    use_object_obs : bool
        Whether there are `NAME_pos` (3,) [m] and `NAME_quat` (4,) (x, y, z, w) of every object.
    reward_scale : float
        Reward in a step after which the judge sees the task done; 0 otherwise.
    **arguments
        As for every `ManipulationEnv`; without them nothing is drawn, and the model is not compiled again at a reset.

    Raises
    ------
    InputError
        Unknown task, or another robot, base or hand.
    """

    def __init__(
        self,
        robots: Any,
        task: str = "OpenSingleDoor",
        seed: int | None = None,
        use_object_obs: bool = True,
        reward_scale: float = 1.0,
        **arguments: Any,
    ) -> None:
        self.task_spec, self.use_object_obs, self.reward_scale = task_named(task), use_object_obs, reward_scale
        self._draws = np.random.default_rng(seed)
        quiet = {"use_camera_obs": False, "has_offscreen_renderer": False, "render_camera": "overview", "hard_reset": False}
        super().__init__(robots, base_types="NullMount", seed=seed, **{"camera_names": "overview", **quiet, **arguments})
        # robosuite has made an episode already, and the first reset makes another
        self._draws = np.random.default_rng(seed)

    def _check_robot_configuration(self, robots: Any) -> None:
        names = [robots] if isinstance(robots, str) else list(robots)
        if names != ["Panda"]:
            raise InputError(f"the kitchen is laid out for one robot, 'Panda'; got {', '.join(map(repr, names))}")

    def _load_model(self) -> None:
        super()._load_model()
        self.model = task_model(self.task_spec.scene, self.robots[0].robot_model)

    def _initialize_sim(self, xml_string: str | None = None) -> None:
        super()._initialize_sim(xml_string)
        tune(self.task_spec.scene, self.sim.model._model)
        self.sim.model.opt.timestep = self.model_timestep

    def _reset_internal(self) -> None:
        super()._reset_internal()
        self.physics = Physics(self.task_spec.scene, model=self.sim.model._model, data=self.sim.data._data)
        if not self.deterministic_reset:
            self.episode = set_up(self.task_spec, self.physics, self._draws)
            # robosuite's controllers remember where the arm was when they were made; the fingers it would leave half open
            robot = self.robots[0]
            robot.init_qpos = self.physics.arm
            robot.reset(rng=self.rng)
            self.physics.set_arm(self.physics.arm)

    def _setup_observables(self) -> OrderedDict[str, Any]:
        observables: OrderedDict[str, Any] = super()._setup_observables()
        if self.use_object_obs:
            for name in self.task_spec.scene.types:
                for suffix, read in (("pos", self._position(name)), ("quat", self._orientation(name))):
                    key = f"{name}_{suffix}"
                    observables[key] = Observable(key, sensor(modality="object")(read), sampling_rate=self.control_freq)
        return observables

    def _position(self, name: str) -> Any:
        return lambda _cache: np.array(self.physics.T_world(name).p)

    def _orientation(self, name: str) -> Any:
        def read(_cache: dict[str, Array]) -> Array:
            return np.roll(self.physics.T_world(name).q, -1)

        return read

    def reward(self, action: Any = None) -> float:  # noqa: ARG002
        """`reward_scale` when the task is done, else 0."""
        return self.reward_scale * float(self._check_success())

    def _check_success(self) -> bool:
        return self.task_spec.judge(self.physics, self.episode.focus)
