"""Recordings: let the demonstrator do a task in fresh episodes and keep what it did as `Demo`s."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from symskill_pddl.demonstrator.human import Faults
from symskill_pddl.demos.demo import Demo
from symskill_pddl.demos.truth import Truth
from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import make
from symskill_pddl.kitchen.demonstrator import demonstrate
from symskill_pddl.kitchen.truth import TruthLog
from symskill_pddl.scene import Scene

MAX_SEED = 2**31 - 1


def record(task: str, n: int, seed: int, keep_failed: bool = False) -> tuple[Demo, ...]:
    """The demonstrations of `record_with_truth` alone."""
    return record_with_truth(task, n, seed, keep_failed)[0]


def record_with_truth(
    task: str, n: int, seed: int, keep_failed: bool = False, faults: Faults | None = None
) -> tuple[tuple[Demo, ...], dict[str, Truth]]:
    """`n` demonstrations of a task by people who differ; the same arguments give the same bytes.

    Parameters
    ----------
    task : str
        Name of a task of the kitchen.
    n : int
        How many demonstrations, at least 1.
    seed : int
        The first episode's seed; the following episodes have the following seeds.
    keep_failed : bool
        Keep the episodes in which the judge saw no success. Otherwise they are dropped and the next seeds are tried.
    faults : Faults, optional
        What goes wrong in all of them; drawn for each when not given.

    Returns
    -------
    tuple of Demo
        In order of their seeds; attributes `seed` and `success` (0 or 1).
    dict of str to Truth
        By name of demonstration: what really happened.

    Raises
    ------
    InputError
        For an unknown task, a count below 1 or a negative seed; if more than half of `2 n + 10` episodes fail.
    """
    if n < 1 or seed < 0 or seed > MAX_SEED:
        raise InputError(f"recording needs at least 1 demonstration and a seed from 0 to {MAX_SEED}, got {n} and {seed}")
    demos: list[Demo] = []
    truths: dict[str, Truth] = {}
    limit = n if keep_failed else 2 * n + 10
    for episode in range(seed, seed + limit):
        if len(demos) == n:
            break
        world = make(task, episode)
        log = TruthLog(world)
        scenes = demonstrate(world, np.random.default_rng([episode, 1]), faults=faults)
        success = world.succeeded()
        if success or keep_failed:
            attributes: dict[str, str | int | float] = {"seed": episode, "success": int(success)}
            demos.append(demo_of(scenes, f"demo_{len(demos)}", task, world.extents, attributes))
            truths[demos[-1].name] = log.truth()
    if len(demos) < n:
        raise InputError(f"task '{task}': of {limit} episodes from seed {seed} on only {len(demos)} succeeded, not {n}")
    return tuple(demos), truths


def demo_of(
    scenes: Sequence[Scene],
    name: str,
    task: str,
    extents: Mapping[str, tuple[float, float, float]],
    attributes: Mapping[str, str | int | float],
) -> Demo:
    """Scenes of one episode as one `Demo`; `extents` are half sizes [m] per type, of which the types seen are kept."""
    objects = dict(scenes[0].objects)
    return Demo(
        name=name,
        source="kitchen",
        task=task,
        times=np.round([scene.time - scenes[0].time for scene in scenes], 6),
        T_world_ee=_rounded(Pose.stack([scene.T_world_ee for scene in scenes])),
        aperture=np.round([scene.aperture for scene in scenes], 6),
        gripper_closed=np.array([scene.gripper_closed for scene in scenes]),
        objects=objects,
        T_world_objects=_rounded(Pose.stack([scene.T_world_objects for scene in scenes])),
        extents={t: half for t, half in extents.items() if t in objects.values()},
        attributes=dict(attributes),
    )


def _rounded(T: Pose) -> Pose:
    """To micrometres: far below what any sensor sees, and what stands still then compresses to nothing."""
    return Pose(np.round(T.p, 6), np.round(T.q, 6))
