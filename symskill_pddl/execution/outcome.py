"""What a run came to, and how long its parts took."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from symskill_pddl.execution.timing import Spread
from symskill_pddl.symbols import State


class Category(StrEnum):
    """How a run ended."""

    SUCCESS = "success"
    UNREACHABLE = "goal unreachable"
    PLANNER = "planner failed"
    REPLANS = "replan limit"
    TIME = "time limit"
    WORLD = "world failed"
    """The world raised, stood still, or showed what a robot cannot be moved by."""
    MISSED = "goal missed"
    """Without monitor, or without planning again: the plan is over or was left, and the goal does not hold."""


class Cause(StrEnum):
    """What went wrong."""

    PERCEPTION = "perception"
    """The atoms do not tell what is: an object at rest in no known relation, or a goal that holds and is none."""
    PRECONDITION = "precondition"
    """A step could not start."""
    PLANNING = "planning"
    """No plan, or no planner."""
    MOTION = "motion"
    """The hand came to rest, or was blocked, before the step's effects held."""
    GRASP = "grasp"
    """The fingers closed on nothing, or lost what they held."""
    EXTERNAL = "external"
    """Something changed that the robot has not touched."""
    TIMEOUT = "timeout"
    """A step or the run used up its time."""


@dataclass(frozen=True)
class StepRecord:
    """One execution of a step: when [s], and the verdict that ended it."""

    step: str
    start_s: float
    stop_s: float
    verdict: str
    reason: str
    attempt: int
    """0 at the first try; otherwise how often it had been blamed."""


@dataclass(frozen=True)
class Outcome:
    """The result of `execute`.

    Attributes
    ----------
    success, category, reason
        Whether the goal atoms hold, how the run ended, and why in words.
    cause : Cause or None
        What a failed run failed of.
    troubles : tuple of Cause
        What went wrong in its steps, in order, whether it was recovered from or not.
    replans : int
        Calls of the planner after the first plan was given up.
    steps : tuple of StepRecord
    recoveries : tuple of str
        Names of the general recoveries, in order.
    time_s : float
        Duration in the world's time [s].
    plan_seconds : tuple of float
        Wall-clock time of every planner call [s].
    times : dict of str to Spread
        Wall-clock times [ms] of the tick, of its stages and of planning, as `timing.spreads` names them.
    state : State
        The atoms at the end.
    """

    success: bool
    category: Category
    reason: str
    cause: Cause | None
    troubles: tuple[Cause, ...]
    replans: int
    steps: tuple[StepRecord, ...]
    recoveries: tuple[str, ...]
    time_s: float
    plan_seconds: tuple[float, ...]
    times: dict[str, Spread]
    state: State
