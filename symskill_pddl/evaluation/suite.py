"""Many episodes, one after the other or over processes. The results do not depend on how many processes there are."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

from symskill_pddl.errors import InputError, MissingDependencyError, SymSkillError, alternatives
from symskill_pddl.evaluation.results import EpisodeResult, Results, Settings, TaskResult, summarise
from symskill_pddl.evaluation.trial import prepare, run_episode
from symskill_pddl.kitchen import TASKS, parse_disturbance, task_named
from symskill_pddl.library import Library
from symskill_pddl.planning import get

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

    def __post_init__(self) -> None:
        if self.trials < 1 or self.seed < 0:
            raise InputError(
                f"an evaluation needs at least one trial and a seed of at least 0, got {self.trials} and {self.seed}"
            )
        if not self.tasks or len(set(self.tasks)) != len(self.tasks):
            raise InputError(f"an evaluation needs one or more different tasks, got: {', '.join(self.tasks) or 'none'}")
        for task in self.tasks:
            task_named(task)
        for spec in self.disturbances:
            parse_disturbance(spec)
        get(self.planner)

    @property
    def episodes(self) -> tuple[tuple[str, int], ...]:
        """(task, seed) of every episode, in order."""
        return tuple((task, self.seed + i) for task in self.tasks for i in range(self.trials))


def tasks_named(text: str) -> tuple[str, ...]:
    """``all`` or a comma-separated list of the kitchen's tasks."""
    if text == "all":
        return tuple(TASKS)
    names = tuple(name.strip() for name in text.split(",") if name.strip())
    if not names:
        raise InputError(f"no task named; there are: all, {alternatives(TASKS)}")
    return names


def run_suite(
    load: Callable[[Path], Library],
    path: Path,
    suite: Suite,
    *,
    checksum: str = "",
    jobs: int = 1,
    on_episode: Callable[[str, EpisodeResult], None] | None = None,
) -> Results:
    """Run every episode of a suite.

    Parameters
    ----------
    load, path
        How and from where each process gets the library; `load` has to be a function of a module.
    jobs : int
        Number of processes; 1 runs in this one.
    on_episode : callable, optional
        Told the task and the result whenever an episode is done, in any order.
    """
    if jobs < 1:
        raise InputError(f"an evaluation needs at least one job, got {jobs}")
    found: dict[tuple[str, int], EpisodeResult] = {}
    for task, result in _run_all(load, path, suite, min(jobs, len(suite.episodes))):
        found[task, result.seed] = result
        if on_episode is not None:
            on_episode(task, result)
    tasks: list[TaskResult] = [summarise(task, (found[key] for key in suite.episodes if key[0] == task)) for task in suite.tasks]
    settings = Settings(
        library=checksum,
        planner=get(suite.planner).name,
        monitor=suite.monitor,
        disturbances=suite.disturbances,
        seed=suite.seed,
        trials=suite.trials,
    )
    return Results(settings=settings, tasks=tuple(tasks))


def _run_all(load: Callable[[Path], Library], path: Path, suite: Suite, jobs: int) -> Iterator[tuple[str, EpisodeResult]]:
    if jobs == 1:
        library = load(path)
        for task, seed in suite.episodes:
            yield task, run_one(library, suite, task, seed)
        return
    # spawned, not forked: a fork copies whatever threads and locks this process has
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=_start, initargs=(load, path, suite)) as pool:
        futures = {pool.submit(_work, task, seed): task for task, seed in suite.episodes}
        for future in as_completed(futures):
            yield futures[future], future.result()


def run_one(library: Library, suite: Suite, task: str, seed: int) -> EpisodeResult:
    """One episode of a suite; what cannot be set up counts as failed, with its reason."""
    try:
        episode = prepare(library, task, seed, disturbances=suite.disturbances)
        result, _ = run_episode(library, episode, seed, get(suite.planner), monitor=suite.monitor)
    except MissingDependencyError:
        raise  # no episode would run
    except SymSkillError as error:
        return EpisodeResult(
            seed=seed, success=False, category=ERROR, reason=str(error), replans=0, recoveries=0, steps=0, time_s=0.0
        )
    return result


_process: tuple[Library, Suite]
"""What a worker process keeps between episodes."""


def _start(load: Callable[[Path], Library], path: Path, suite: Suite) -> None:
    global _process
    _process = (load(path), suite)


def _work(task: str, seed: int) -> EpisodeResult:
    library, suite = _process
    return run_one(library, suite, task, seed)
