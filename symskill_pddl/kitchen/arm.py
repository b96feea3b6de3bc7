"""Inverse kinematics of the arm: start poses, and whether a hand pose is within reach at all."""

from __future__ import annotations

import numpy as np

from symskill_pddl.control import ELBOW_UP
from symskill_pddl.geometry import Array, Pose, quat_conjugate, quat_log, quat_multiply
from symskill_pddl.kitchen.physics import Physics


def solve(
    physics: Physics, T_world_ee: Pose, start: Array | None = None, tolerance: float = 1e-3, margin: float = 0.03
) -> Array | None:
    """Joint positions that put the hand at a pose, by damped least squares with the elbow leaning up in the null space.

    Leaves the arm's state as it was.

    Parameters
    ----------
    T_world_ee : Pose
        Wanted hand pose.
    start : (7,), optional
        Where the search starts [rad].
    tolerance : float
        Largest error accepted [m and rad].
    margin : float
        Distance kept from every joint limit [rad].

    Returns
    -------
    (7,) joint positions [rad], or None when none was found.
    """
    before, aperture = physics.arm.copy(), physics.aperture
    low, high = physics.arm_range[:, 0] + margin, physics.arm_range[:, 1] - margin
    rest = np.asarray(ELBOW_UP)
    q = np.array(rest if start is None else start, dtype=np.float64)
    found = None
    for step in range(200):
        physics.set_arm(q, aperture)
        physics.kinematics()
        T = physics.T_world_ee()
        error = np.concatenate([T_world_ee.p - T.p, quat_log(quat_multiply(T_world_ee.q, quat_conjugate(T.q)))])
        if np.abs(error).max() < tolerance:
            found = q.copy()
            break
        J = physics.jacobian()
        pull = 0.1 * (rest - q) * max(0.0, 1.0 - step / 150)
        inverse = J.T @ np.linalg.inv(J @ J.T + 1e-4 * np.eye(6))
        dq = inverse @ np.clip(error, -0.1, 0.1) + pull - inverse @ (J @ pull)
        q = np.clip(q + np.clip(dq, -0.2, 0.2), low, high)
    physics.set_arm(before, aperture)
    physics.kinematics()
    return found
