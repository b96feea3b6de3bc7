"""`Kitchen`: the simulated kitchen as a `World`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from time import perf_counter

import numpy as np
from numpy.random import Generator, default_rng

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.disturbances import Disturbance, Running
from symskill_pddl.kitchen.episode import Episode
from symskill_pddl.kitchen.physics import Physics
from symskill_pddl.kitchen.tasks import TaskSpec, task_named
from symskill_pddl.panda import reach
from symskill_pddl.panda.arm import limited
from symskill_pddl.scene import Command, Scene

PHYSICS_STEPS = 25


class Kitchen:
    """One episode: the robot in front of the counter, a task, and what may go wrong.

    Attributes
    ----------
    episode : Episode
        What was drawn from the seed.
    physics : Physics
        The simulator. Judges, disturbances and demonstrators may look; learned controllers see `observe()` only.
    events : list of (float, str)
        What was done to the scene so far, and when it began [s].
    views : list of callable
        What stands between the true poses of the objects and those that are seen.
    forced_open : bool
        Whether the fingers are held open in the coming control period, whatever the command.
    extents : dict of str to (float, float, float)
        Half sizes per type [m].
    watchers : list of callable
        Called with every scene that `step` returns.
    touched_s : float
        How long the robot has touched an obstacle that was put in its way [s].

    Raises
    ------
    InputError
        A disturbance is not possible in this scene.
    """

    def __init__(
        self, spec: TaskSpec, episode: Episode, physics: Physics, disturbances: Iterable[Disturbance] = (), seed: int = 0
    ) -> None:
        self.spec, self.episode, self.physics = spec, episode, physics
        disturbances = tuple(disturbances)
        for disturbance in disturbances:
            disturbance.check(spec.scene.types)
        self._disturbances = tuple(Running(disturbance, seed, i) for i, disturbance in enumerate(disturbances))
        self._added = {name: kind for disturbance in disturbances for name, kind in disturbance.kind.adds.items()}
        self.events: list[tuple[float, str]] = []
        self.watchers: list[Callable[[Scene], None]] = []
        self.views: list[Callable[[Pose], Pose]] = []
        self.extents = spec.scene.extents | {kind: layout.ADDED_EXTENTS[kind] for kind in self._added.values()}
        self.forced_open = False
        self._closed = False
        self._touched = 0
        self.ms: dict[str, float] = {}

    @property
    def period_s(self) -> float:
        """Control period [s]."""
        return 0.05

    @property
    def task(self) -> str:
        return self.spec.name

    @property
    def focus(self) -> tuple[str, ...]:
        """Names of the objects the task is about."""
        return self.episode.focus

    @property
    def goals(self) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """The demonstrated tasks whose goals together are the goal, each with the objects that it is about."""
        return self.spec.goal_of or ((self.task, self.focus),)

    @property
    def placements(self) -> tuple[tuple[str, str], ...]:
        """Of a goal in the play scene: what is to be where."""
        return self.spec.goal_at

    @property
    def touched_s(self) -> float:
        return round(self._touched * self.period_s, 3)

    @property
    def time(self) -> float:
        """Seconds since the start of the episode."""
        return round(float(self.physics.data.time), 9)

    def observe(self) -> Scene:
        """The present scene."""
        T_world_objects = self.physics.T_world_objects()
        if self._added:
            added = Pose.stack([self.physics.T_world(name) for name in self._added])
            T_world_objects = Pose(np.concatenate([T_world_objects.p, added.p]), np.concatenate([T_world_objects.q, added.q]))
        for view in self.views:
            T_world_objects = view(T_world_objects)
        return Scene(
            time=self.time,
            T_world_ee=self.physics.T_world_ee(),
            aperture=self.physics.aperture,
            gripper_closed=self._closed,
            objects=self.spec.scene.types | self._added,
            T_world_objects=T_world_objects,
        )

    def step(self, command: Command) -> Scene:
        """Carry out the command for one period and return the scene after it."""
        self.forced_open = False
        for disturbance in self._disturbances:
            disturbance.act(self)
        self._closed = command.close_gripper
        self.physics.advance(limited(command.twist), command.close_gripper and not self.forced_open, PHYSICS_STEPS)
        begin = perf_counter()
        scene = self.observe()
        self.ms = {"observe": 1e3 * (perf_counter() - begin), "controller": 1e3 * self.physics.controller_s}
        self._touched += layout.OBSTACLE in self._added and self.physics.robot_touches(layout.OBSTACLE)
        for watch in self.watchers:
            watch(scene)
        return scene

    def notify_step(self, k: int) -> None:
        """The executor starts its k-th operator (from 0): disturbances may wait for it."""
        for disturbance in self._disturbances:
            disturbance.operator_started(k)

    def note(self, text: str) -> None:
        """Something is done to the scene from now on."""
        self.events.append((self.time, text))

    def succeeded(self) -> bool:
        """The judge, on the simulator's own state."""
        return self.spec.judge(self.physics, self.episode.focus)


def make(task: str, seed: int, disturbances: Iterable[Disturbance] = ()) -> Kitchen:
    """An episode of a task, drawn from the seed; same seed, same episode, bit for bit.

    Raises
    ------
    InputError
        The task is unknown, or no episode within the arm's reach was drawn.
    MissingDependencyError
        robosuite, mujoco or a library they need is not installed.
    """
    spec = task_named(task)
    physics = Physics(spec.scene)
    try:
        episode = set_up(spec, physics, default_rng(seed))
    except InputError as error:
        raise InputError(f"{error}, seed {seed}") from None
    return Kitchen(spec, episode, physics, disturbances, seed)


def set_up(spec: TaskSpec, physics: Physics, rng: Generator) -> Episode:
    """Draw an episode and put everything in its place.

    Raises
    ------
    InputError
        No episode within the arm's reach was drawn.
    """
    for _ in range(50):
        episode = spec.draw(rng)
        if _set_up(physics, episode):
            return episode
    raise InputError(f"no episode within the arm's reach in 50 draws of task '{spec.name}'")


def _set_up(physics: Physics, episode: Episode) -> bool:
    """Put everything in place and let it come to rest; False when the arm could not reach what it has to."""
    physics.reset()
    for unit, shift in episode.shifts.items():
        physics.set_unit(unit, shift)
    for part, position in episode.positions.items():
        physics.set_part(part, position)
    poses = {name: episode.T_world(physics.scene, name) for name in episode.loose}
    for name, T in poses.items():
        physics.set_loose(name, T)
    start = reach.solve(physics, episode.T_start)
    if start is None:
        return False
    physics.set_arm(start)
    physics.forward()
    door = physics.T_world("door") if "door" in physics.scene.parts else None
    if any(reach.solve(physics, T, start) is None for T in episode.must_reach(physics.scene, door)):
        return False
    for _ in range(20):
        physics.advance(np.zeros(6), False, PHYSICS_STEPS)
    physics.set_arm(start)
    physics.start_clock()
    moved = (np.linalg.norm(physics.T_world(name).p - T.p) for name, T in poses.items())
    turned = (abs(physics.position(part) - position) for part, position in episode.positions.items())
    return bool(max(moved) < 0.01 and max(turned, default=0.0) < 0.02)
