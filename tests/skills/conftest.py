"""Small demonstrations that the skills' tests share."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from symskill_pddl.geometry import Pose
from symskill_pddl.skills import Field, FitConfig, Trajectory, fit_fields


def reach(seed: int, n: int = 100, turn: float = 1.0) -> Trajectory:
    """A slightly curved reach to the origin that turns on the way; 5 s."""
    rng = np.random.default_rng(seed)
    s = np.linspace(0.0, 1.0, n)[:, None]
    s = 3 * s**2 - 2 * s**3
    start = np.array([0.4, 0.1, 0.2]) + rng.normal(0, 0.03, 3)
    x = start * (1 - s) + np.array([0, 0, 0.06]) * np.sin(np.pi * s)
    r = (1 - s) * (np.array([0.5, 0.3, -0.4]) + rng.normal(0, 0.1, 3)) * turn
    return Trajectory(np.linspace(0.0, 5.0, n), Pose.from_rotvec(x, r))


def u_shape(seed: int, turn: float = 0.0) -> Trajectory:
    """Down, sideways and up to the goal; 6 s."""
    rng = np.random.default_rng(seed)
    corners = np.array([[0, 0, 0.3], [0, 0, 0], [0.3, 0, 0], [0.3, 0, 0.25]]) + rng.normal(0, 0.005, (4, 3))
    t = np.linspace(0.0, 1.0, 40)[:, None]
    x = gaussian_filter1d(np.concatenate([a + (b - a) * t for a, b in pairwise(corners)]), 3, axis=0, mode="nearest")
    r = np.linspace(0.0, 1.0, len(x))[:, None] * np.array([0, 0, turn])
    return Trajectory(0.05 * np.arange(len(x)), Pose.from_rotvec(x, r))


def grasp(seed: int) -> Trajectory:
    """From one side to 6 cm above the goal and, slower, straight down; with pauses and noise. 7.5 s."""
    rng = np.random.default_rng(seed)

    def ease(n: int) -> np.ndarray:
        u = np.linspace(0.0, 1.0, n)[:, None]
        return 3 * u**2 - 2 * u**3

    start, via, goal = np.array([0.3, 0.2, 0.3]) + rng.normal(0, 0.05, 3), np.array([0, 0, 0.06]), rng.normal(0, 0.002, 3)
    still = [np.repeat(x[None], n, 0) for x, n in ((start, 20), (via, 10), (goal, 20))]
    x = np.concatenate([still[0], start + (via - start) * ease(40), still[1], via + (goal - via) * ease(60), still[2]])
    x = x + rng.normal(0, 3e-4, x.shape)
    return Trajectory(0.05 * np.arange(len(x)), Pose.from_rotvec(x, rng.normal(0, 0.002, x.shape)))


def execute(
    fields: tuple[Field, ...], T: Pose, config: FitConfig, limit_s: float, final: tuple[float, float] = (0.005, 0.03)
) -> tuple[Pose, bool]:
    """Run fields in sequence by explicit Euler steps until the last goal is reached."""
    way, index = [T], 0
    for _ in range(int(limit_s / config.period_s)):
        last = index == len(fields) - 1
        goal = fields[index].T_goal
        near_p, near_r = final if last else (config.via_tolerance_m, config.via_tolerance_rad)
        if np.linalg.norm(T.p - goal.p) < near_p and np.linalg.norm((goal.inverse() @ T).rotvec()) < near_r:
            if last:
                return Pose.stack(way), True
            index += 1
        twist = fields[index].twist(T)
        turn = Pose.from_rotvec(np.zeros(3), config.period_s * twist[3:])
        T = Pose(T.p + config.period_s * twist[:3], (turn @ Pose(np.zeros(3), T.q)).q)
        way.append(T)
    return Pose.stack(way), False


@pytest.fixture(scope="session")
def reaches() -> list[Trajectory]:
    return [reach(seed) for seed in range(8)]


@pytest.fixture(scope="session")
def field(reaches: list[Trajectory]) -> Field:
    (only,) = fit_fields(reaches)
    return only
