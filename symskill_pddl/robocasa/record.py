"""Recordings: the demonstrator does a task in RoboCasa's training kitchens, and what RoboCasa calls a success is kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symskill_pddl.demos import Demo
from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose
from symskill_pddl.robocasa.demonstrator import demonstrate
from symskill_pddl.robocasa.tasks import TASKS
from symskill_pddl.robocasa.world import RoboCasaWorld, open_world
from symskill_pddl.scene import Scene

MAX_SEED = 2**31 - 1


def record(task: str, n: int, seed: int) -> tuple[Demo, ...]:
    """`n` demonstrations of a task by people who differ; the same arguments give the same ones.

    Parameters
    ----------
    task : str
    n : int
        How many, at least 1.
    seed : int
        The first episode's seed; the following episodes have the following seeds. Those that RoboCasa's judge calls no success
        are dropped, and those in which food tumbled.

    Raises
    ------
    InputError
        For a count below 1 or a negative seed; if more than half of `2 n + 10` episodes fail.
    """
    if n < 1 or not 0 <= seed <= MAX_SEED:
        raise InputError(f"recording needs at least 1 demonstration and a seed from 0 to {MAX_SEED}, got {n} and {seed}")
    demos: list[Demo] = []
    tried, limit = 0, 2 * n + 10
    for episode in range(seed, seed + DRAWS * limit):
        if len(demos) == n or tried == limit:
            break
        world = open_world(TASKS[task], episode, "train")
        if not _usual(world):
            continue
        tried += 1
        scenes = demonstrate(world, np.random.default_rng([episode, 1]))
        if world.succeeded() and _upright(scenes):
            attributes = {"seed": episode, "layout": int(world.env.layout_id), "style": int(world.env.style_id)}
            demos.append(_demo(scenes, f"demo_{len(demos)}", task, world.extents, attributes))
    if len(demos) < n:
        raise InputError(f"task '{task}': of {tried} episodes from seed {seed} on only {len(demos)} succeeded, not {n}")
    return tuple(demos)


DRAWS = 4
"""Kitchens opened for one episode in which the part is of usual size."""
USUAL_DOOR_M, USUAL_DRAWER_M = (0.38, 0.48), 0.6
"""From the hinge to the handle, and how far to the side a drawer's handle is: people show what to do with parts of usual size."""


def _usual(world: RoboCasaWorld) -> bool:
    """Whether the part that is to be moved is about as large as it is in most kitchens."""
    if world.spec.about == "door":
        return USUAL_DOOR_M[0] < abs(float(world.moving["door"].pivot[1])) < USUAL_DOOR_M[1]
    return world.spec.about != "drawer" or abs(world.part("drawer").T_world_home.p[1]) < USUAL_DRAWER_M


TUMBLED_RAD = 0.35
"""Food that ends further from upright has tumbled."""


def _upright(scenes: Sequence[Scene]) -> bool:
    """Whether food ends as upright as it was: a judge may not mind that it tumbled, but nobody would show that."""
    foods = [name for name, kind in scenes[0].objects.items() if kind == "food"]
    up = [[scene.pose(name).rotate([0.0, 0.0, 1.0]) for scene in (scenes[0], scenes[-1])] for name in foods]
    return all(float(np.arccos(np.clip(before @ after, -1.0, 1.0))) < TUMBLED_RAD for before, after in up)


def _demo(
    scenes: Sequence[Scene], name: str, task: str, extents: dict[str, tuple[float, float, float]], attributes: dict[str, int]
) -> Demo:
    demo = Demo.from_scenes(scenes, name=name, task=task, source="robocasa", extents=extents, attributes=attributes)
    # to micrometres, far below what any sensor sees: what stands still then compresses to nothing
    rounded = [Pose(np.round(T.p, 6), np.round(T.q, 6)) for T in (demo.T_world_ee, demo.T_world_objects)]
    return replace(
        demo,
        times=np.round(demo.times, 6),
        aperture=np.round(demo.aperture, 6),
        T_world_ee=rounded[0],
        T_world_objects=rounded[1],
    )
