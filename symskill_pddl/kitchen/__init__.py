"""The simulated kitchen, a `World`. robosuite and mujoco are imported when an episode is made, not before."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from symskill_pddl.kitchen.disturbances import Disturbance, parse_disturbance
from symskill_pddl.kitchen.tasks import TASKS, TaskSpec, task_named

if TYPE_CHECKING:
    from symskill_pddl.kitchen.world import Kitchen

__all__ = ["TASKS", "Disturbance", "TaskSpec", "make", "parse_disturbance", "task_named"]


def make(task: str, seed: int, disturbances: Iterable[Disturbance | str] = ()) -> Kitchen:
    """An episode of a task, drawn from the seed; same seed, same episode, bit for bit.

    Parameters
    ----------
    task : str
        One of `TASKS`.
    seed : int
    disturbances : iterable of Disturbance or str
        What is to go wrong; texts are parsed.

    Raises
    ------
    InputError
        The task or a disturbance is unknown.
    MissingDependencyError
        robosuite, mujoco or a library they need is not installed.
    """
    from symskill_pddl.kitchen.world import make as make_world

    task_named(task)
    return make_world(task, seed, [parse_disturbance(item) if isinstance(item, str) else item for item in disturbances])
