"""The kitchen as a Gymnasium environment; importing this module registers `symskill/Kitchen-v0`.

    import gymnasium, symskill_pddl.kitchen.gymnasium_env
    env = gymnasium.make("symskill/Kitchen-v0", task="OpenDrawer")

`gymnasium.make("symskill_pddl.kitchen.gymnasium_env:symskill/Kitchen-v0")` needs no import. Install it with the extra `[gym]`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, SupportsFloat

import numpy as np
from numpy.typing import ArrayLike, NDArray

from symskill_pddl.errors import InputError, MissingDependencyError
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import make, parse_disturbance, task_named
from symskill_pddl.kitchen.world import Kitchen
from symskill_pddl.panda.arm import MAX_RATE, MAX_SPEED
from symskill_pddl.scene import Command, Scene

try:
    import gymnasium
    from gymnasium import spaces
except ImportError as error:
    raise MissingDependencyError(f"the Gymnasium environment needs gymnasium ({error}): pip install gymnasium") from None

if TYPE_CHECKING:
    from symskill_pddl.kitchen.render import Camera

ENV_ID = "symskill/Kitchen-v0"
SCALE = np.array([MAX_SPEED] * 3 + [MAX_RATE] * 3)
"""What an action of 1 means: [m/s] three times, [rad/s] three times."""
MAX_STEPS = 1200
"""Control steps until an episode is cut off (60 s), unless `gymnasium.make` is told otherwise."""
FAR_M = 10.0
"""Bound of every coordinate of a position; the room is smaller."""

Observation = dict[str, Any]


class KitchenEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """One task of the kitchen at 20 control steps a second.

    Action, (7,) in [-1, 1]: linear velocity of the hand in units of 0.6 m/s, its angular velocity in units of 2 rad/s, both
    in world axes, and the gripper, which closes above 0 and opens otherwise. What is faster than one unit is slowed to it.

    Observation, a dict of float32 arrays: `gripper` (7,), `aperture` (1,) [m], `closed` (1,) the commanded state, and
    `objects` with a pose (7,) under each name. A pose is position [m] and unit quaternion (w, x, y, z), in the world's axes;
    the robot's base is the origin, the counter's top z = 0.

    The reward is 1 in the step in which the judge, who alone reads the simulator's state, sees the task done, and 0 before.
    With that step the episode has terminated. It is truncated by `gymnasium.make`'s time limit only.

    `reset(seed=N)` starts the very episode `symskill_pddl.kitchen.make(task, N)` does; without a seed the next one is drawn.

    Parameters
    ----------
    task : str
        One of `symskill_pddl.kitchen.TASKS`.
    disturbances : sequence of str
        What is to go wrong in every episode, as for ``symskill run --disturb``; moments are given in seconds (``@t=``).
    render_mode : str or None
        'rgb_array' for pictures, which need a library that draws off screen.
    camera : str
        Where pictures are taken from.

    Raises
    ------
    InputError
        Unknown task, disturbance or render mode.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 20}  # noqa: RUF012  # Gymnasium's own way to say it

    def __init__(
        self,
        task: str = "OpenSingleDoor",
        disturbances: Sequence[str] = (),
        render_mode: str | None = None,
        camera: str = "overview",
    ) -> None:
        task_named(task)
        for spec in disturbances:
            parse_disturbance(spec)
        if render_mode not in (None, "rgb_array"):
            raise InputError(f"unknown render mode {render_mode!r}; there is: rgb_array")
        self.task, self.disturbances, self.render_mode = task, tuple(disturbances), render_mode
        self.action_space = spaces.Box(-1.0, 1.0, (7,), np.float32)
        self._camera_name = camera
        self._camera: Camera | None = None
        self._kitchen: Kitchen | None = None
        names = make(task, 0, disturbances).observe().objects
        self.observation_space = spaces.Dict(
            {
                "gripper": _poses(),
                "aperture": spaces.Box(0.0, 0.1, (1,), np.float32),
                "closed": spaces.Box(0.0, 1.0, (1,), np.float32),
                "objects": spaces.Dict({name: _poses() for name in names}),
            }
        )

    @property
    def kitchen(self) -> Kitchen:
        """The world of the present episode.

        Raises
        ------
        InputError
            Before the first `reset`.
        """
        if self._kitchen is None:
            raise InputError("the environment has no episode yet: call reset() first")
        return self._kitchen

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict[str, Any]]:
        """Start an episode; `options` has to be empty."""
        super().reset(seed=seed)
        if options:
            raise InputError(f"reset takes no options, got {options!r}")
        drawn = int(self.np_random.integers(2**31)) if seed is None else seed
        self._forget_camera()
        self._kitchen = make(self.task, drawn, self.disturbances)
        return _observation(self._kitchen.observe()), {"seed": drawn, "success": False, "focus": self._kitchen.focus}

    def step(self, action: ArrayLike) -> tuple[Observation, SupportsFloat, bool, bool, dict[str, Any]]:
        """One control period of 50 ms."""
        kitchen, a = self.kitchen, np.asarray(action, dtype=float)
        if a.shape != (7,) or not np.all(np.isfinite(a)):
            raise InputError(f"an action is seven finite numbers in [-1, 1], got {action!r}")
        a = np.clip(a, -1.0, 1.0)
        scene = kitchen.step(Command(SCALE * a[:6], bool(a[6] > 0.0)))
        success = kitchen.succeeded()
        return _observation(scene), float(success), success, False, {"success": success, "focus": kitchen.focus}

    def render(self) -> NDArray[np.uint8] | None:
        """A picture (480, 640, 3), or None without a render mode. Errors as for `symskill_pddl.kitchen.render.Camera`."""
        if self.render_mode is None:
            return None
        if self._camera is None:
            from symskill_pddl.kitchen.render import Camera

            self._camera = Camera(self.kitchen, self._camera_name)
        return self._camera.image()

    def close(self) -> None:
        """Release what pictures needed."""
        self._forget_camera()

    def _forget_camera(self) -> None:
        if self._camera is not None:
            self._camera.close()
            self._camera = None


def _poses() -> spaces.Box:
    bound = np.array([FAR_M] * 3 + [1.0] * 4, dtype=np.float32)
    return spaces.Box(-bound, bound, dtype=np.float32)


def _vector(T: Pose) -> NDArray[np.float32]:
    return T.vector().astype(np.float32)


def _observation(scene: Scene) -> Observation:
    poses = scene.T_world_objects.vector().astype(np.float32)
    return {
        "gripper": _vector(scene.T_world_ee),
        "aperture": np.array([scene.aperture], dtype=np.float32),
        "closed": np.array([scene.gripper_closed], dtype=np.float32),
        "objects": dict(zip(scene.objects, poses, strict=True)),
    }


gymnasium.register(ENV_ID, entry_point="symskill_pddl.kitchen.gymnasium_env:KitchenEnv", max_episode_steps=MAX_STEPS)
