"""Inverse kinematics of the arm: start poses, and whether a hand pose is within reach at all."""

from __future__ import annotations

import numpy as np

from symskill_pddl.control import ELBOW_UP
from symskill_pddl.geometry import Array, Pose, quat_conjugate, quat_log, quat_multiply
from symskill_pddl.panda.arm import Arm


def solve(
    robot: Arm, T_world_ee: Pose, start: Array | None = None, tolerance: float = 1e-3, margin: float = 0.03
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
    rest = np.asarray(ELBOW_UP)
    before, aperture = robot.arm.copy(), robot.aperture
    # the search is local: try from where the arm is asked to start, from rest, and with the wrist turned to its other side
    other = rest * np.array([1.0, 1.0, 1.0, 1.0, -1.0, 1.0, 1.0]) + np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.4])
    starts = [rest, other] if start is None else [np.asarray(start, dtype=np.float64), rest, other]
    found = None
    for q in starts:
        found = _search(robot, T_world_ee, q, tolerance, margin)
        if found is not None:
            break
    robot.set_arm(before, aperture)
    robot.kinematics()
    return found


def _search(robot: Arm, T_world_ee: Pose, start: Array, tolerance: float, margin: float) -> Array | None:
    """One local search; moves the arm."""
    rest, aperture = np.asarray(ELBOW_UP), robot.aperture
    low, high = robot.arm_range[:, 0] + margin, robot.arm_range[:, 1] - margin
    q = start.copy()
    for step in range(200):
        robot.set_arm(q, aperture)
        robot.kinematics()
        T = robot.T_world_ee()
        error = np.concatenate([T_world_ee.p - T.p, quat_log(quat_multiply(T_world_ee.q, quat_conjugate(T.q)))])
        if np.abs(error).max() < tolerance:
            return q
        J = robot.jacobian()
        pull = 0.05 * (rest - q) * max(0.0, 1.0 - step / 100)
        inverse = J.T @ np.linalg.inv(J @ J.T + 1e-4 * np.eye(6))
        dq = inverse @ np.clip(error, -0.1, 0.1) + pull - inverse @ (J @ pull)
        q = np.clip(q + np.clip(dq, -0.2, 0.2), low, high)
    return None
