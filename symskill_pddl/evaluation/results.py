"""`results.json`: what a suite of episodes came to."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, SerializerFunctionWrapHandler, model_serializer

from symskill_pddl.errors import InputError
from symskill_pddl.evaluation.statistics import median, wilson
from symskill_pddl.files import RESULTS, Output
from symskill_pddl.reading import read_text, validated
from symskill_pddl.worlds import DEFAULT

CONFIDENCE = 0.95


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class EpisodeResult(_Part):
    """One episode. Times are the world's [s]."""

    seed: int
    success: bool
    category: str
    """How it ended."""
    cause: str = ""
    """Of a failure, as `execution.outcome.Cause`, or that it could not be set up."""
    troubles: dict[str, int] = {}
    """What went wrong in its steps, recovered from or not: how often, per cause."""
    disturbances: int = 0
    """How many took place."""
    touched_s: float = 0.0
    """How long the robot touched an obstacle that was put in its way [s]."""
    reason: str
    replans: int
    recoveries: int
    steps: int
    time_s: float


class TaskResult(_Part):
    """All episodes of one task."""

    task: str
    trials: int
    successes: int
    interval: tuple[float, float]
    """Wilson interval of the success rate, at the suite's confidence."""
    failures: dict[str, int]
    """How many episodes failed, per cause."""
    troubles: dict[str, int]
    """What went wrong in the steps of all episodes, recovered from or not: how often, per cause."""
    disturbances: int
    mean_touched_s: float
    median_time_s: float | None
    """Of the successful episodes."""
    max_time_s: float | None
    mean_replans: float
    mean_recoveries: float
    episodes: tuple[EpisodeResult, ...]


class Settings(_Part):
    """What the suite was asked to do."""

    world: str = DEFAULT
    """Left out of the file where it is this."""
    library: str
    """Checksum of the library."""
    planner: str
    monitor: bool
    resampling: bool = True
    replanning: bool = True
    tracking: bool = True
    obstacles: bool = True
    disturbances: tuple[str, ...]
    seed: int
    trials: int

    @model_serializer(mode="wrap")
    def _plain(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        fields: dict[str, Any] = write(self)
        if self.world == DEFAULT:
            del fields["world"]
        return fields


class Results(_Part):
    """The whole file."""

    format: Literal["symskill-results"] = "symskill-results"
    schema_version: Literal[2] = 2
    settings: Settings
    confidence: float = CONFIDENCE
    tasks: tuple[TaskResult, ...]

    def dumps(self) -> str:
        """The file's text; the same results give the same bytes."""
        return self.model_dump_json(indent=2) + "\n"


def summarise(task: str, episodes: Iterable[EpisodeResult]) -> TaskResult:
    """The episodes of a task, in order of their seeds, with their counts."""
    ordered = tuple(sorted(episodes, key=lambda e: e.seed))
    if not ordered:
        raise InputError(f"task '{task}': no episode to summarise")
    good = [e.time_s for e in ordered if e.success]
    low, high = wilson(len(good), len(ordered), confidence=CONFIDENCE)
    return TaskResult(
        task=task,
        trials=len(ordered),
        successes=len(good),
        interval=(round(low, 4), round(high, 4)),
        failures=count(e.cause for e in ordered if not e.success),
        troubles=count(cause for e in ordered for cause, n in e.troubles.items() for _ in range(n)),
        disturbances=sum(e.disturbances for e in ordered),
        mean_touched_s=round(sum(e.touched_s for e in ordered) / len(ordered), 3),
        median_time_s=median(good),
        max_time_s=max(good, default=None),
        mean_replans=round(sum(e.replans for e in ordered) / len(ordered), 3),
        mean_recoveries=round(sum(e.recoveries for e in ordered) / len(ordered), 3),
        episodes=ordered,
    )


def count(names: Iterable[str]) -> dict[str, int]:
    """How often each occurs, by name."""
    counted = Counter(map(str, names))
    return {name: counted[name] for name in sorted(counted)}


def save_results(path: str | Path, results: Results) -> None:
    """Write atomically, in place of older results; raises `InputError` if something else is there."""
    Output(Path(path), RESULTS).write(results.dumps().encode("utf-8"))


def load_results(path: str | Path) -> Results:
    """Read a results file.

    Raises
    ------
    InputError
        It does not exist or cannot be read.
    FormatError
        It is not JSON, of another format or version, or a field is missing or wrong; names the field.
    """
    return validated(Results.model_validate, read_text(path, "results file"), f"'{path}' is not a results file")
