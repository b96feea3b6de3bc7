"""How well a field follows its demonstrations, judged by what it does: by rollouts."""

from __future__ import annotations

import numpy as np

from symskill_pddl.geometry import Array, Pose, quat_exp, quat_multiply, quat_rotate
from symskill_pddl.skills.config import FitConfig
from symskill_pddl.skills.field import Field
from symskill_pddl.skills.trajectory import Trajectory


def rollout(field: Field, T_start: Pose, duration_s: float, period_s: float) -> Pose:
    """Explicit Euler motion (n, steps) of the field from starts (n,)."""
    from symskill_pddl.skills.kernels import rollouts

    n = T_start.shape
    steps = int(np.ceil(duration_s / period_s))
    p, q = rollouts(
        np.array(T_start.p, order="C").reshape(-1, 3),
        np.array(T_start.q, order="C").reshape(-1, 4),
        steps,
        period_s,
        field.arrays,
    )
    return Pose(p.reshape(*n, steps + 1, 3), q.reshape(*n, steps + 1, 4))


def deviation(field: Field, trajectories: list[Trajectory], shown: Array, config: FitConfig) -> float:
    """How far rollouts and demonstrations part, in tolerances: three quarters of the demonstrations do better.

    A rollout has to stay where any demonstration was, and to come past everything its own one did. Their own spread, the
    largest distance from one demonstration to the nearest of the others, is taken off.
    """
    starts = Pose.stack([t.T_frame_ee[0] for t in trajectories])
    duration = 1.5 * max(t.duration_s for t in trajectories) + 1.0
    driven = rollout(field, starts, duration, config.period_s)
    ways = _ending_in_goal(shown)
    p = ways[..., :3] * config.tolerance_m + field.position.goal
    q = quat_multiply(quat_exp(ways[..., 3:] * config.tolerance_rad), field.orientation.goal)
    values, spread = [], []
    for i in range(len(trajectories)):
        to_all = np.stack([_pose_distances(driven.p[i], driven.q[i], p[j], q[j], config) for j in range(len(p))])
        own, corridor = to_all[i].min(0).max(), to_all.min((0, 2)).max()
        values.append(max(own, corridor))
        between = [_pose_distances(p[i], q[i], p[j], q[j], config).min(1) for j in range(len(p)) if j != i]
        spread.append(np.min(between, axis=0).max() if between else 0.0)
    return max(0.0, float(np.quantile(values, 0.75) - np.median(spread)))


def _ending_in_goal(shown: Array) -> Array:
    """The demonstrations (demos, samples, 6), bent smoothly so that all end in the mean goal."""
    return shown - (np.linspace(0.0, 1.0, shown.shape[1]) ** 2)[None, :, None] * shown[:, -1:]


def strays(field: Field, trajectories: list[Trajectory], shown: Array, config: FitConfig) -> float:
    """How far [m] the last way to the goal leaves the demonstrations from starts that were not demonstrated.

    The mean start is moved aside, and turned about the last direction: from behind an object, its grasp is still to be approached
    as shown. Positions only.
    """
    goal = field.position.goal
    ways = _ending_in_goal(shown)[..., :3] * config.tolerance_m
    start, mean = ways[:, 0].mean(0), ways.mean(0)
    size = np.linalg.norm(mean, axis=-1)
    if size.max() < config.final_m:
        return 0.0
    across = np.linalg.svd(start[None])[2][1:]  # (2, 3), orthogonal to the straight way
    aside = start + config.disturbance_m * np.concatenate([across, -across])
    last = mean[-1 - int(np.argmax(size[::-1] > config.final_m))]
    turns = quat_exp(np.array([[0.5], [1.0], [1.5]]) * np.pi * last / np.linalg.norm(last))
    starts = np.concatenate([aside, quat_rotate(turns, start)])
    T = Pose(goal + starts, np.tile(trajectories[0].T_frame_ee.q[0], (len(starts), 1)))
    slowest = max(t.duration_s for t in trajectories)
    duration = 1.5 * slowest + 2.0 + config.disturbance_m / float(field.position.lpv.pace.min())
    way = rollout(field, T, duration, config.period_s).p - goal
    last_way = way[np.linalg.norm(way, axis=-1) < config.final_m]
    if len(last_way) == 0:
        return 0.0
    gaps = np.linalg.norm(last_way[:, None] - ways.reshape(-1, 3), axis=-1).min(1)
    return float(gaps.max())


def _pose_distances(pa: Array, qa: Array, pb: Array, qb: Array, config: FitConfig) -> Array:
    """(n, m) distances in units of the tolerances, the larger of position and rotation."""
    squares = (pa * pa).sum(-1)[:, None] + (pb * pb).sum(-1)[None, :] - 2.0 * pa @ pb.T
    angles = 2.0 * np.arccos(np.clip(np.abs(qa @ qb.T), 0.0, 1.0))
    return np.maximum(np.sqrt(np.maximum(squares, 0.0)) / config.tolerance_m, angles / config.tolerance_rad)


def retreat(way: Array) -> float:
    """Largest rise of the distance to the goal along errors (n, d), as a fraction of its largest; 0 within a tolerance."""
    distance = np.linalg.norm(way, axis=1)
    rise = float((distance - np.minimum.accumulate(distance)).max())
    return rise / float(distance.max()) if rise > 1.0 else 0.0
