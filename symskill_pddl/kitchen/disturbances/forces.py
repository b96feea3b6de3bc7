"""Forces of a person: on a part, on the hand, on a loose thing. They act in every physics step and are bounded."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from symskill_pddl.geometry import Array, Pose, quat_conjugate, quat_exp, quat_log, quat_multiply
from symskill_pddl.kitchen.disturbances.kind import Doing, periods

if TYPE_CHECKING:
    from symskill_pddl.kitchen.physics import Physics
    from symskill_pddl.kitchen.world import Kitchen

_STIFF = 30.0
"""Natural frequency of the spring between a person's hand and a thing [rad/s]; critically damped."""
_TWIST = 1.0
"""Largest torque on a thing that is led [Nm]."""


@contextmanager
def acting(physics: Physics, load: Callable[[], None]) -> Iterator[None]:
    """Call `load` in every physics step, for as long as this lasts."""
    physics.loads.append(load)
    try:
        yield
    finally:
        physics.loads.remove(load)


def turning(physics: Physics, part: str, speed: float, strongest: float) -> Callable[[], None]:
    """A hand that moves a part at a speed [rad/s or m/s], with no more than `strongest` [Nm or N]."""
    v = physics.joint_v(part)
    model, data = physics.model, physics.data
    # as much as a step allows; what the joint itself holds against comes on top
    gain = 0.2 * float(model.dof_M0[v]) / float(model.opt.timestep)
    against = np.sign(speed) * float(model.dof_frictionloss[v]) + float(model.dof_damping[v]) * speed

    def load() -> None:
        effort = against + gain * (speed - float(data.qvel[v]))
        data.qfrc_applied[v] += np.clip(effort, -strongest, strongest)

    return load


def pushing(physics: Physics, force: Array) -> Callable[[], None]:
    """A constant force (3,) [N] on the robot's hand."""

    def load() -> None:
        physics.data.xfrc_applied[physics.hand, :3] += force

    return load


class Leading:
    """A hand that holds a loose thing, upright, and leads it to where `target` is, with no more than `strongest` [N]."""

    def __init__(self, physics: Physics, name: str, strongest: float) -> None:
        self._physics, self._body, self._strongest = physics, physics.bodies[name], strongest
        self._v = physics.joint_v(name)
        T = physics.T_world(name)
        x, y, _ = T.rotate(np.array([1.0, 0.0, 0.0]))
        self.target = Pose(T.p, quat_exp([0.0, 0.0, np.arctan2(y, x)]))

    def __call__(self) -> None:
        data, model, v = self._physics.data, self._physics.model, self._v
        q = data.xquat[self._body]
        turn = quat_log(quat_multiply(quat_conjugate(q), self.target.q))
        linear = _STIFF**2 * (self.target.p - data.xpos[self._body]) - 2 * _STIFF * data.qvel[v : v + 3]
        angular = _STIFF**2 * turn - 2 * _STIFF * data.qvel[v + 3 : v + 6]
        force = capped(float(model.body_mass[self._body]) * linear, self._strongest)
        torque = capped(model.body_inertia[self._body] * angular, _TWIST)
        # the bias is the thing's weight: it is carried, whatever it stands on
        data.qfrc_applied[v : v + 6] += data.qfrc_bias[v : v + 6] + np.concatenate([force, torque])


def lead(kitchen: Kitchen, name: str, path: Sequence[Array], speeds: Sequence[float], strongest: float) -> Doing:
    """Lead a loose thing along points (3,) [m], upright and at a speed [m/s] to each, and let go of it there.

    What is in the way is pushed with no more than `strongest` [N]; what does not give way is given up after a second.
    """
    hand = Leading(kitchen.physics, name, strongest)
    with acting(kitchen.physics, hand):
        for point, speed in zip(path, speeds, strict=True):
            step = speed * kitchen.period_s
            while (gap := float(np.linalg.norm(point - hand.target.p))) > 1e-6:
                hand.target = Pose(hand.target.p + (point - hand.target.p) * min(1.0, step / gap), hand.target.q)
                yield
            for _ in periods(kitchen, 1.0):
                if np.linalg.norm(kitchen.physics.T_world(name).p - point) < 0.005:
                    break
                yield


def capped(values: Array, most: float) -> Array:
    """The vector, no longer than `most`."""
    return np.asarray(values * min(1.0, most / max(float(np.linalg.norm(values)), 1e-12)))
