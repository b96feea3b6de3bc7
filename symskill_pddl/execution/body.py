"""The robot as the executor sees it: one world, what was sensed of it, and the few motions that are not learned.

`Body` is the only part of this room that steps the world. It keeps the debounced state, the hand's path and the recent scenes.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import replace
from time import perf_counter

import numpy as np

from symskill_pddl.abstraction import Debounced, abstract, one_place
from symskill_pddl.execution.config import MotionConfig
from symskill_pddl.execution.guards import GuardedWorld
from symskill_pddl.execution.recovery import backed_off, near, servo, way_back
from symskill_pddl.execution.runner import Fingers
from symskill_pddl.execution.steady import Steady
from symskill_pddl.geometry import Array, Pose, quat_multiply, rotation_distance
from symskill_pddl.library import Library
from symskill_pddl.scene import Command, Scene, World
from symskill_pddl.skills import scalar
from symskill_pddl.symbols import State

_PATH_SPACING_M, _PATH_SPACING_RAD = 0.005, 0.05
_REST_WINDOW_S = 0.25
_MOVING_M_S = 0.02
"""Below this an object's velocity is taken for noise."""
_JUMPS_M_S = 3.0
"""Above this it has not moved: it was put there, or the perception has lost and found it."""


class Body:
    """A world with memory.

    Parameters
    ----------
    objects : mapping of str to str
        The objects the state speaks of; the scene may hold more.
    debounce_s : float
        For how long an atom reads otherwise before the state follows [s].
    """

    def __init__(
        self, world: World, library: Library, objects: Mapping[str, str], config: MotionConfig, debounce_s: float
    ) -> None:
        self._world, self._library, self._objects, self._config = GuardedWorld(world), library, frozenset(objects), config
        self._turns: dict[str, Array] = {}
        self.scene = self._world.last
        self._steady = Steady(self.scene)
        self.start_s = self.scene.time
        self._sense = Debounced(self._read(self.scene, frozenset()), self.scene.time, debounce_s)
        self.path: list[Pose] = [self.scene.T_world_ee]
        self._recent = deque([self.scene])
        self.grasp_entry = 0
        """Entry of `path` up to which the fingers were last open: where the present grasp was made."""
        self.closing = self.scene.gripper_closed
        self.live, self.period_s = self._world.live, self._world.period_s
        self.ms: dict[str, float] = {}

    @property
    def now(self) -> float:
        """The world's time [s]."""
        return self.scene.time

    @property
    def elapsed(self) -> float:
        """Time since the run began [s]."""
        return self.scene.time - self.start_s

    @property
    def state(self) -> State:
        """The atoms, after hysteresis and debounce, every object at one place."""
        return one_place(self._sense.state, self._library.classifiers)

    def step(self, command: Command) -> None:
        """One control period: act, look, abstract. `ms` holds how long the parts took."""
        begin = perf_counter()
        scene = self._world.step(command)
        seen = perf_counter()
        self.scene = self._turned(self._steady(scene))
        self._sense = self._sense.update(self._read(self.scene, self._sense.state), self.scene.time)
        own = self._world.ms
        world = 1e3 * (seen - begin) - sum(own.values())
        self.ms = {"world": world, **own, "abstract": 1e3 * (perf_counter() - seen)}
        self.closing = command.close_gripper
        moved, turned = scalar.apart(self.scene.T_world_ee, self.path[-1])
        if moved > _PATH_SPACING_M or turned > _PATH_SPACING_RAD:
            self.path.append(self.scene.T_world_ee)
        if not self.closing:
            self.grasp_entry = len(self.path) - 1
        self._recent.append(self.scene)
        while self.scene.time - self._recent[0].time > _REST_WINDOW_S:
            self._recent.popleft()

    def take(self, name: str, q: Array) -> None:
        """From now on see an object turned by `q` (4,) in its own frame: one that lies on another face than was shown."""
        self._turns[name] = quat_multiply(self._turns[name], q) if name in self._turns else q
        turn = Pose(np.zeros(3), q)
        self.scene = _with(self.scene, name, self.scene.pose(name) @ turn)
        # what is seen differently has not moved
        self._recent = deque(_with(scene, name, scene.pose(name) @ turn) for scene in self._recent)

    def _turned(self, scene: Scene) -> Scene:
        for name, q in self._turns.items():
            scene = _with(scene, name, scene.pose(name) @ Pose(np.zeros(3), q))
        return scene

    def _read(self, scene: Scene, before: State) -> State:
        state = abstract(scene, self._library.classifiers, before=before, gripper=self._library.gripper)
        return frozenset(a for a in state if self._objects.issuperset(a.args))

    def resting(self) -> frozenset[str]:
        """The objects in sight that have not moved (5 mm, 2 degrees) in the last quarter of a second."""
        then, now = self._recent[0], self.scene
        still = (np.linalg.norm(now.T_world_objects.p - then.T_world_objects.p, axis=-1) < 0.005) & (
            rotation_distance(now.T_world_objects, then.T_world_objects) < 0.035
        )
        watched = self._objects - now.unseen
        return frozenset(name for name, rests in zip(now.objects, still, strict=True) if rests and name in watched)

    def velocities(self) -> Array:
        """Linear velocities (n, 3) [m/s] of the scene's objects, in world axes, over the last quarter of a second; 0 at rest."""
        then, now = self._recent[0], self.scene
        if now.time <= then.time:
            return np.zeros((len(now.objects), 3))
        v = (now.T_world_objects.p - then.T_world_objects.p) / (now.time - then.time)
        speed = np.sqrt((v * v).sum(-1, keepdims=True))
        return np.where((speed > _MOVING_M_S) & (speed < _JUMPS_M_S), v, 0.0)

    def wait(self) -> None:
        """Stay where one is for one period, fingers as they are."""
        self.step(Command.hold(self.closing))

    def stop(self) -> None:
        """Take back a twist that was commanded last: nothing moves on while nobody looks."""
        self._world.stop()

    def hold(self, seconds: float, until: Callable[[], bool] = lambda: False) -> bool:
        """Stay where one is, fingers as they are, at most this long; whether `until` came true."""
        stop = self.now + seconds
        while self.now < stop - 1e-9:
            self.wait()
            if until():
                return True
        return False

    def fingers(self, closing: bool) -> None:
        """Move the fingers and wait until they have settled."""
        fingers = Fingers(self.scene, self._config)
        fingers.closing = self.closing
        fingers.tell(closing, self.scene)
        self.step(Command.hold(closing))
        while fingers.settling(self.scene):
            self.step(Command.hold(closing))

    def go(self, target: Pose, seconds: float) -> bool:
        """Straight to a pose, at a careful pace; whether it was reached in time."""
        stop = self.now + seconds
        while not near(self.scene.T_world_ee, target, distance_m=0.01, angle_rad=0.1):
            if self.now >= stop:
                return False
            twist = servo(self.scene.T_world_ee, target, gain=4.0, max_speed=0.15, max_turn=0.8)
            self.step(Command(twist, self.closing))
        return True

    def back_off(self, distance_m: float) -> bool:
        """Back along the hand's own approach direction."""
        return self.go(backed_off(self.scene.T_world_ee, distance_m), 3.0)

    def travelled(self, since: int) -> float:
        """Length of the path from its entry `since` on [m]."""
        points = np.array([T.p for T in self.path[since:]])
        return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())

    def go_back(self, length_m: float, since: int = 0) -> bool:
        """Back along the path one came, at most to its entry `since`; whether all of it was reached."""
        # every way point is a few centimetres off; one that is blocked ends the attempt
        return all(self.go(T, 2.0) for T in way_back(self.path[since:], length_m))


def _with(scene: Scene, name: str, T_world_object: Pose) -> Scene:
    p, q = np.array(scene.T_world_objects.p), np.array(scene.T_world_objects.q)
    row = list(scene.objects).index(name)
    p[row], q[row] = T_world_object.p, T_world_object.q
    return replace(scene, T_world_objects=Pose(p, q))
