"""Accuracy, convergence and cost of the motion fields on RoboTasks9 (real robot demonstrations, MIT licence, Auddy et al. 2023).

    python benchmarks/skills.py FOLDER [--demos N] [--single-field]

FOLDER holds `*.npy` arrays (demos, samples, 7): position [cm], quaternion w x y z, ends aligned, no time stamps. Every fifth
sample is used and a demonstration is taken to last 10 s. Measured on the training demonstrations:

- position [cm] and orientation [deg]: mean error of the rollout from each demonstration's start, along the alignment by
dynamic time
  warping of the positions (orientation also along its own alignment, in brackets);
- converged: share of 15 rollouts within 0.5 cm and 3 deg of the goal after at most 3 times the demonstration's time, from starts
  disturbed by 10 cm and 45 deg, and by 30 cm and any rotation;
- fit: processor seconds for everything, model selection and splitting included; step: microseconds of one evaluation.
"""

from __future__ import annotations

import argparse
import timeit
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from time import process_time

import numba
import numpy as np
from threadpoolctl import threadpool_limits

from symskill_pddl.geometry import Array, Pose, quat_exp, quat_multiply, rotation_distance
from symskill_pddl.skills import Field, FitConfig, Trajectory, fit_fields

DURATION_S = 10.0


def load(path: Path, stride: int = 5) -> list[Trajectory]:
    """Demonstrations of one task, in metres."""
    data = np.load(path, allow_pickle=False)[:, ::-stride][:, ::-1]
    times = np.linspace(0.0, DURATION_S, data.shape[1])
    return [Trajectory(times, Pose(0.01 * demo[:, :3], demo[:, 3:])) for demo in data]


def execute(fields: Sequence[Field], T_start: Pose, config: FitConfig, limit_s: float) -> tuple[Pose, bool]:
    """Rollout (n,) through the sequence from one start; whether it came within 0.5 cm and 3 deg of the last goal."""
    T, way, index = T_start, [T_start], 0
    for _ in range(int(limit_s / config.period_s)):
        last = index == len(fields) - 1
        goal = fields[index].T_goal
        near_p, near_r = (0.005, np.radians(3.0)) if last else (config.via_tolerance_m, config.via_tolerance_rad)
        if np.linalg.norm(T.p - goal.p) < near_p and rotation_distance(T, goal) < near_r:
            if last:
                return Pose.stack(way), True
            index += 1
        twist = fields[index].twist(T)
        T = Pose(T.p + config.period_s * twist[:3], quat_multiply(quat_exp(config.period_s * twist[3:]), T.q))
        way.append(T)
    return Pose.stack(way), False


@numba.njit(cache=True)
def warp(d: Array) -> Array:
    """Pairs (m, 2) of the best alignment of a distance matrix (n, m)."""
    n, m = d.shape
    total = np.full((n + 1, m + 1), np.inf)
    total[0, 0] = 0.0
    for i in range(n):
        for j in range(m):
            total[i + 1, j + 1] = d[i, j] + min(total[i, j], total[i, j + 1], total[i + 1, j])
    pairs = np.zeros((n + m, 2), dtype=np.int64)
    i, j, count = n, m, 0
    while i > 0 and j > 0:
        pairs[count, 0], pairs[count, 1] = i - 1, j - 1
        count += 1
        a, b, c = total[i - 1, j - 1], total[i - 1, j], total[i, j - 1]
        if a <= b and a <= c:
            i, j = i - 1, j - 1
        elif b <= c:
            i -= 1
        else:
            j -= 1
    return pairs[:count]


def errors(way: Pose, demo: Pose) -> tuple[float, float, float]:
    """Position [cm], orientation [deg] along the positions' alignment, orientation [deg] along its own."""
    distance = np.linalg.norm(way.p[:, None] - demo.p[None], axis=-1)
    angle = 2.0 * np.arccos(np.clip(np.abs(way.q @ demo.q.T), 0.0, 1.0))
    pairs, own = warp(distance), warp(angle)
    return (
        100 * float(distance[pairs[:, 0], pairs[:, 1]].mean()),
        float(np.degrees(angle[pairs[:, 0], pairs[:, 1]].mean())),
        float(np.degrees(angle[own[:, 0], own[:, 1]].mean())),
    )


def disturbed(T: Pose, distance: float, angle: float | None, rng: np.random.Generator) -> Pose:
    """A pose moved by `distance` [m] and turned by `angle` [rad], or to any rotation."""
    direction, axis = rng.normal(size=3), rng.normal(size=3)
    p = T.p + distance * direction / np.linalg.norm(direction)
    if angle is None:
        return Pose(p, rng.normal(size=4))
    return Pose(p, quat_multiply(quat_exp(angle * axis / np.linalg.norm(axis)), T.q))


def measure(trajectories: list[Trajectory], config: FitConfig, rng: np.random.Generator) -> dict[str, float]:
    """All figures of one task."""
    start = process_time()
    fields = fit_fields(trajectories, config)
    fit_s = process_time() - start
    found = [errors(execute(fields, t.T_frame_ee[0], config, 3 * DURATION_S)[0], t.T_frame_ee) for t in trajectories]
    converged = [
        np.mean(
            [
                execute(fields, disturbed(trajectories[i % len(trajectories)].T_frame_ee[0], d, a, rng), config, 3 * DURATION_S)[
                    1
                ]
                for i in range(15)
            ]
        )
        for d, a in ((0.1, np.pi / 4), (0.3, None))
    ]
    T = trajectories[0].T_frame_ee[0]
    step = timeit.timeit(lambda: fields[0].twist(T), number=2000) / 2000
    position, orientation, own = np.mean(found, axis=0)
    return {
        "fields": len(fields),
        "pos cm": position,
        "ori deg": orientation,
        "(own)": own,
        "10cm+45": float(converged[0]),
        "30cm+any": float(converged[1]),
        "fit s": fit_s,
        "step us": 1e6 * step,
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--demos", type=int, default=9)
    parser.add_argument("--single-field", action="store_true", help="no splitting")
    arguments = parser.parse_args()
    config = replace(FitConfig(), max_fields=1) if arguments.single_field else FitConfig()
    rows = {}
    with threadpool_limits(1):
        for path in sorted(arguments.folder.glob("*.npy")):
            rows[path.stem] = measure(load(path)[: arguments.demos], config, np.random.default_rng(0))
    if not rows:
        parser.error(f"no .npy files in {arguments.folder}")
    print(f"{'task':16s}" + "".join(f"{name:>10s}" for name in next(iter(rows.values()))))
    rows["mean"] = {name: float(np.mean([row[name] for row in rows.values()])) for name in next(iter(rows.values()))}
    for task, row in rows.items():
        print(f"{task:16s}" + "".join(f"{value:10.2f}" for value in row.values()))


if __name__ == "__main__":
    main()
