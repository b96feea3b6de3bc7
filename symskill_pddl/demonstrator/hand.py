"""The demonstrator's hand: carries out strokes on a world through twists, in closed loop, and remembers what was seen."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from symskill_pddl.demonstrator.human import Faults, Person, Stroke, stroke, vary
from symskill_pddl.geometry import Array, Pose, quat_conjugate, quat_log, quat_multiply, rotation_distance
from symskill_pddl.scene import Command, Scene, World

GAIN_1_S = 3.0
"""How fast a pose error is worked off."""
MAX_LINEAR_M_S, MAX_ANGULAR_RAD_S = 0.25, 1.2
"""Limits of what the hand commands, so that a recording stays within what a learned skill may do."""


class Hand:
    """One person's hand in one episode. All it does goes through `World.step`; every scene it saw is in `scenes`."""

    def __init__(self, world: World, person: Person, faults: Faults, rng: np.random.Generator) -> None:
        self.world, self.person, self.faults, self.rng = world, person, faults, rng
        self.scenes: list[Scene] = [world.observe()]
        self.closed = self.scenes[-1].gripper_closed
        self.T_world_home = self.scenes[-1].T_world_ee

    @property
    def scene(self) -> Scene:
        return self.scenes[-1]

    @property
    def T(self) -> Pose:
        """`T_world_ee` now."""
        return self.scene.T_world_ee

    def go(self, via: Sequence[Pose], *, careful: bool = False, pause: bool = False) -> None:
        """One stroke from here through `via` to the last of them."""
        pause_s = float(self.rng.uniform(0.4, 1.2)) if pause else 0.0
        self._follow(
            stroke((self.T, *via), self.person, self.rng, period_s=self.world.period_s, pause_s=pause_s, careful=careful)
        )
        for _ in range(8):
            if np.linalg.norm(self.T.p - via[-1].p) < 0.004 and rotation_distance(self.T, via[-1]) < 0.03:
                return
            self._towards(via[-1], np.zeros(6))

    def leave(self, via: Sequence[Pose] = ()) -> None:
        """Back to about where the hand was at first, and a short rest there, as a person ends a demonstration."""
        self.closed = False
        self.go([*via, vary(self.T_world_home, self.rng, 0.025, 0.08)])
        self.rest(float(self.rng.uniform(1.0, 2.5)))

    def rest(self, seconds: float) -> None:
        """Stay here."""
        T = self.T
        for _ in range(max(1, round(seconds / self.world.period_s))):
            self._towards(T, np.zeros(6))

    def fingers(self, close: bool, wait_s: float = 0.6) -> None:
        """Open or close the fingers and wait for them, the hand at rest."""
        self.closed = close
        self.rest(wait_s + float(self.rng.uniform(0.0, 0.3)))

    def _follow(self, path: Stroke) -> None:
        poses, dt = path.T_world_ee, self.world.period_s
        linear = np.diff(poses.p, axis=0) / dt
        angular = quat_log(quat_multiply(poses.q[1:], quat_conjugate(poses.q[:-1]))) / dt
        for k in range(len(path.times) - 1):
            # the error is taken where the hand should be now, the feed-forward carries it to the next pose
            self._towards(poses[k], np.concatenate([linear[k], angular[k]]))

    def _towards(self, target: Pose, feed_forward: Array) -> None:
        error = np.concatenate([target.p - self.T.p, quat_log(quat_multiply(target.q, quat_conjugate(self.T.q)))])
        twist = feed_forward + GAIN_1_S * error
        for part, limit in ((slice(0, 3), MAX_LINEAR_M_S), (slice(3, 6), MAX_ANGULAR_RAD_S)):
            twist[part] *= min(1.0, limit / max(float(np.linalg.norm(twist[part])), 1e-12))
        self.scenes.append(self.world.step(Command(twist, self.closed)))
