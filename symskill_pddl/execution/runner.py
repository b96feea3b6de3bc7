"""Running one skill: phases in order, fingers between them, obstacles around them. Scenes in, commands out.

The runner knows nothing of atoms, and whether the skill has done its job is not its business; the monitor decides.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import ArrayLike

from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.execution.around import Strangers
from symskill_pddl.execution.config import MotionConfig
from symskill_pddl.execution.detour import Detour
from symskill_pddl.execution.recovery import capped
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.scene import Command, Scene
from symskill_pddl.skills import Phase, Skill, Superellipsoids, modulate, scalar
from symskill_pddl.skills.skill import UNSHIFTED

_LOCAL = 8.0
"""Locality of obstacles that the whole hand keeps away from."""


class Fingers:
    """Tells whether the fingers have settled since they were told to move."""

    def __init__(self, scene: Scene, config: MotionConfig) -> None:
        self._config = config
        self._since: float | None = None
        self._previous = scene
        self.closing = scene.gripper_closed

    def tell(self, closing: bool, scene: Scene) -> None:
        """Command the fingers; a change starts a wait."""
        if closing != self.closing:
            self.closing, self._since = closing, scene.time

    def settling(self, scene: Scene) -> bool:
        """Whether they are still on their way. To be asked once a tick."""
        previous, self._previous = self._previous, scene
        if self._since is None:
            return False
        waited, dt = scene.time - self._since, scene.time - previous.time
        slow = dt > 0 and abs(scene.aperture - previous.aperture) / dt < self._config.settle_speed
        if waited >= self._config.settle_max_s or (waited >= self._config.settle_min_s and slow):
            self._since = None
            return False
        return True


@dataclass(frozen=True, eq=False)
class Motion:
    """What the runner wants in one tick, and where it is in its skill. Names as in `monitor.Tick`."""

    command: Command
    stage: int
    stage_s: float
    settling: bool
    speed: float
    turn: float
    rest_s: float


class SkillRun:
    """One execution of a skill, with its frames bound to objects.

    Parameters
    ----------
    binding : mapping of str to str
        Object bound to each parameter; the phases' frames are parameters.
    shift : (str, Pose) or None
        A frame and the transform of all fields that live in it (resampled goal).
    first : int
        The phase to begin with.
    awaited : (int, callable) or None
        A phase that brings something about, and whether it has: until then only rest ends that phase, its tolerance does not.
    obstacles : callable
        The obstacles of a scene that the demonstrations knew; they do not count where they stand around the goal.
    strange : Strangers or None
        Others, which the whole hand keeps away from.

    Raises
    ------
    InputError
        If a phase names a frame that is no parameter of the operator.
    """

    def __init__(
        self,
        skill: Skill,
        binding: Mapping[str, str],
        scene: Scene,
        config: MotionConfig,
        *,
        shift: tuple[str, Pose] | None = None,
        first: int = 0,
        awaited: tuple[int, Callable[[], bool]] | None = None,
        obstacles: Callable[[Scene], Superellipsoids] | None = None,
        strange: Strangers | None = None,
    ) -> None:
        for phase in skill.phases:
            if phase.frame not in binding:
                raise InputError(
                    f"the skill has a phase in frame '{phase.frame}', the operator's parameters are {alternatives(binding)}"
                )
        self._skill, self._binding, self._config = skill, binding, config
        self._shift, self._awaited, self._obstacles, self._strange = shift, awaited, obstacles, strange
        self._fingers = Fingers(scene, config)
        self._stage, self._stage_since = first, scene.time
        self._rest_since = scene.time
        self._previous = self._start = scene
        self._detour: tuple[int, Detour] | None = None
        self._waited = scene.time
        """When the hand last waited for an obstacle to go away: that is not being blocked."""
        self.obstacles_ms = 0.0
        """How much of the last tick's time went into obstacles [ms]."""

    @property
    def avoids(self) -> bool:
        """Whether there may be obstacles."""
        return self._obstacles is not None

    @property
    def stage(self) -> int:
        """The phase that runs."""
        return self._stage

    @property
    def phases(self) -> int:
        return len(self._skill.phases)

    @property
    def shift_vector(self) -> tuple[float, ...] | None:
        """The goal's shift as position and quaternion (w, x, y, z), None where the skill runs as learned."""
        return None if self._shift is None else tuple(self._shift[1].vector().tolist())

    def tick(self, scene: Scene) -> Motion:
        """The command for this period."""
        settling = self._fingers.settling(scene)
        self._note_rest(scene)
        if not settling:
            self._advance(scene)
            settling = self._fingers.settling(scene)
        if settling:
            # a phase counts its time, and its rests, from when the fingers are ready for it
            self._stage_since = self._rest_since = scene.time
        ended = self._stage == self.phases
        nominal = np.zeros(6)
        # with the fingers closed or opened at the end there is nothing left to do but to be still
        changed = self._skill.close_gripper_at_end != self._skill.phases[-1].close_gripper
        if not settling and not (ended and changed):
            nominal = self._twist(min(self._stage, self.phases - 1), scene)
        begin = perf_counter()
        twist, waits = self._modulated(nominal, scene)
        if waits:
            self._waited = scene.time
        self.obstacles_ms = 1e3 * (perf_counter() - begin)
        return Motion(
            Command(capped(twist, self._config.max_speed, self._config.max_turn), self._fingers.closing),
            self._stage,
            scene.time - self._stage_since,
            settling,
            float(np.linalg.norm(nominal[:3])),
            float(np.linalg.norm(nominal[3:])),
            scene.time - max(self._rest_since, self._waited),
        )

    def _advance(self, scene: Scene) -> None:
        """Go through all phases that are over; stop where the fingers have to move first."""
        while self._stage < self.phases:
            phase = self._skill.phases[self._stage]
            if phase.close_gripper != self._fingers.closing:
                self._fingers.tell(phase.close_gripper, scene)
                return
            if not self._over(phase, scene):
                return
            self._stage, self._stage_since = self._stage + 1, scene.time
            self._rest_since = scene.time
        self._fingers.tell(self._skill.close_gripper_at_end, scene)

    def _over(self, phase: Phase, scene: Scene) -> bool:
        T_world_frame, shift = self._frame(phase, scene)
        if not self._carries_on() and phase.reached(T_world_frame, scene.T_world_ee, shift):
            return True
        if scene.time - self._rest_since < self._config.rest_s:
            return False
        return phase.reached(T_world_frame, scene.T_world_ee, shift, scale=self._config.loose)

    def _carries_on(self) -> bool:
        """Whether the phase has still to bring about what it is for.

        The tolerance of a hand's position is many degrees of a short lever; the field's end is nearer than that.
        """
        return self._awaited is not None and self._awaited[0] == self._stage and not self._awaited[1]()

    def _note_rest(self, scene: Scene) -> None:
        dt = scene.time - self._previous.time
        moved, turned = scalar.apart(scene.T_world_ee, self._previous.T_world_ee)
        self._previous = scene
        if dt <= 0 or moved / dt > self._config.rest_speed or turned / dt > self._config.rest_turn:
            self._rest_since = scene.time

    def _frame(self, phase: Phase, scene: Scene) -> tuple[Pose, Pose]:
        shifted = self._shift is not None and self._shift[0] == phase.frame
        T_world_frame = (scene if self._config.track else self._start).pose(self._binding[phase.frame])
        return T_world_frame, self._shift[1] if shifted and self._shift else UNSHIFTED

    def _twist(self, stage: int, scene: Scene) -> Array:
        phase = self._skill.phases[stage]
        T_world_frame, shift = self._frame(phase, scene)
        return np.asarray(phase.twist(T_world_frame, scene.T_world_ee, shift))

    def _modulated(self, nominal: Array, scene: Scene) -> tuple[Array, bool]:
        """The twist around the obstacles, and whether the hand waits for one to go away."""
        if self._obstacles is None or not np.any(nominal[:3]):
            return nominal, False
        stage = min(self._stage, self.phases - 1)
        phase = self._skill.phases[stage]
        T_world_frame, shift = self._frame(phase, scene)
        if self._strange is None:
            return self._bent(nominal, scene, phase.goal_p(T_world_frame, shift)), False
        if self._detour is None or self._detour[0] != stage:
            self._detour = stage, Detour(self._strange)
        T_world_field = T_world_frame if shift is UNSHIFTED else T_world_frame @ shift
        led = self._detour[1](phase.field, T_world_field, nominal, scene, scene.time - self._rest_since)
        twist = self._bent(led.twist, scene, phase.goal_p(T_world_frame, shift) if led.target is None else led.target.p)
        # the hand's own size is in these obstacles: they reach far enough as they are
        twist[:3] = modulate(twist[:3], scene.T_world_ee.p, self._strange(scene), locality=_LOCAL)
        return twist, led.waits

    def _bent(self, twist: Array, scene: Scene, goal: ArrayLike) -> Array:
        assert self._obstacles is not None
        bent = modulate(twist[:3], scene.T_world_ee.p, self._obstacles(scene), goal=goal)
        return np.concatenate([bent, twist[3:]])
