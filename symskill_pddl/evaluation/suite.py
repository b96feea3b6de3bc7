"""Suites: which episodes, with what switched off and what going wrong, and what they come to."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from symskill_pddl.arena import Arena, Kind, Preset
from symskill_pddl.errors import InputError, MissingDependencyError, SymSkillError, alternatives
from symskill_pddl.evaluation.results import EpisodeResult, Results, Settings, TaskResult, summarise
from symskill_pddl.evaluation.spread import Key, Pool, Processes, Work
from symskill_pddl.evaluation.trial import prepare, run_episode
from symskill_pddl.execution.config import ExecutionConfig
from symskill_pddl.execution.trace import TraceWriter
from symskill_pddl.files import TRACE, draft
from symskill_pddl.library import Library
from symskill_pddl.planning import get
from symskill_pddl.worlds import DEFAULT, arena_named, check_seed, check_task

ERROR = "not run"
"""Category of an episode that could not be set up; it counts as a failure."""


@dataclass(frozen=True)
class Suite:
    """What to run: every task with the seeds ``seed ... seed + trials - 1``."""

    tasks: tuple[str, ...]
    trials: int
    seed: int
    planner: str = "auto"
    monitor: bool = True
    disturbances: tuple[str, ...] = ()
    config: ExecutionConfig = field(default_factory=ExecutionConfig)
    world: str = DEFAULT

    def __post_init__(self) -> None:
        if self.trials < 1 or self.seed < 0:
            raise InputError(
                f"an evaluation needs at least one trial and a seed of at least 0, got {self.trials} and {self.seed}"
            )
        check_seed(self.seed + self.trials - 1)
        if not self.tasks or len(set(self.tasks)) != len(self.tasks):
            raise InputError(f"an evaluation needs one or more different tasks, got: {', '.join(self.tasks) or 'none'}")
        arena = arena_named(self.world)
        for task in self.tasks:
            check_task(arena, task)
        for spec in self.disturbances:
            arena.check_disturbance(spec)
        get(self.planner)

    @property
    def episodes(self) -> tuple[tuple[str, int], ...]:
        """(task, seed) of every episode, in order."""
        return tuple((task, self.seed + i) for task in self.tasks for i in range(self.trials))

    def settings(self, checksum: str) -> Settings:
        """What its results file says of it; `checksum` is the library's."""
        return Settings(
            world=self.world,
            library=checksum,
            planner=get(self.planner).name,
            monitor=self.monitor,
            resampling=self.config.resample,
            replanning=self.config.replan,
            tracking=self.config.motion.track,
            obstacles=self.config.motion.avoid,
            disturbances=self.disturbances,
            seed=self.seed,
            trials=self.trials,
        )


def presets(arena: Arena) -> Mapping[str, Preset]:
    """Suites by name: all tasks of a kind, and what else the arena has."""
    kinds = {"atomic": of_kind(arena, "atomic"), "composed": of_kind(arena, "composed"), "play": of_kind(arena, "play goal")}
    return {name: Preset(tasks) for name, tasks in kinds.items() if tasks} | dict(arena.presets)


def of_kind(arena: Arena, *kinds: Kind) -> tuple[str, ...]:
    """The arena's tasks of these kinds."""
    return tuple(name for name, kind in arena.tasks.items() if kind in kinds)


def chosen(arena: Arena, tasks: str | None, preset: str | None) -> Preset:
    """What an evaluation is asked for: tasks by name, or one of the `presets`.

    Raises
    ------
    InputError
        Neither or both are given, or one is unknown.
    """
    if tasks is not None and preset is None:
        return Preset(tasks_named(arena, tasks))
    known = presets(arena)
    if preset is None or tasks is not None:
        raise InputError(f"an evaluation needs either --tasks or --suite; suites: {alternatives(known)}")
    if preset not in known:
        raise InputError(f"unknown suite '{preset}'; there are: {alternatives(known)}")
    return known[preset]


def tasks_named(arena: Arena, text: str) -> tuple[str, ...]:
    """A comma-separated list of tasks, or ``all``: the atomic and the composed ones, not those of play."""
    if text == "all":
        return of_kind(arena, "atomic", "composed")
    names = tuple(name.strip() for name in text.split(",") if name.strip())
    if not names:
        raise InputError(f"no task named; there are: all, {alternatives(arena.tasks)}")
    return names


def run_suite(
    load: Callable[[Path], Library],
    path: Path,
    suite: Suite,
    *,
    checksum: str = "",
    pool: Pool | None = None,
    failed: Path | None = None,
    done: Mapping[Key, EpisodeResult] | None = None,
    on_episode: Callable[[str, EpisodeResult], None] | None = None,
) -> Results:
    """Run every episode of a suite.

    Parameters
    ----------
    load, path
        How and from where each process gets the library; `load` has to be picklable.
    pool : Pool, optional
        Where episodes are run; in this process if it is not given.
    failed : Path, optional
        A folder for the traces of the episodes that fail, TASK-SEED.jsonl.
    done : mapping, optional
        Results, by task and seed, of episodes that need not be run again.
    on_episode : callable, optional
        Told the task and the result whenever an episode is done, in any order.
    """
    found = dict(done or {})
    left = [key for key in suite.episodes if key not in found]
    for task, result in (pool or Processes()).run(partial(_begin, load, path, suite, failed), left):
        found[task, result.seed] = result
        if on_episode is not None:
            on_episode(task, result)
    tasks: list[TaskResult] = [summarise(task, (found[key] for key in suite.episodes if key[0] == task)) for task in suite.tasks]
    return Results(settings=suite.settings(checksum), tasks=tuple(tasks))


def _begin(load: Callable[[Path], Library], path: Path, suite: Suite, failed: Path | None) -> Work:
    return partial(run_one, load(path), suite, failed=failed)


def run_one(library: Library, suite: Suite, task: str, seed: int, *, failed: Path | None = None) -> EpisodeResult:
    """One episode of a suite; what cannot be set up counts as failed, with its reason. `failed` is for its trace if it fails."""
    with ExitStack() as stack:
        kept, trace = None if failed is None else failed / f"{task}-{seed}.jsonl", None
        if kept is not None:
            written = stack.enter_context(draft(kept))
            trace = stack.enter_context(TraceWriter(written))
        try:
            episode = prepare(library, task, seed, world=suite.world, disturbances=suite.disturbances)
            result, _ = run_episode(
                library, episode, seed, get(suite.planner), monitor=suite.monitor, config=suite.config, trace=trace
            )
        except MissingDependencyError:
            raise  # no episode would run
        except SymSkillError as error:
            result = _not_run(seed, error)
        if kept is not None and (result.success or not written.stat().st_size):
            written.unlink()
            if TRACE.wrote(kept):  # of the same episode, when it failed before
                kept.unlink()
    return result


def _not_run(seed: int, error: SymSkillError) -> EpisodeResult:
    return EpisodeResult(
        seed=seed, success=False, category=ERROR, cause=ERROR, reason=str(error), replans=0, recoveries=0, steps=0, time_s=0.0
    )
