"""Where episodes are run: in this process, in several, or on a Ray cluster. The results do not depend on it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from typing import Any, Protocol

from symskill_pddl import workers
from symskill_pddl.errors import InputError, MissingDependencyError
from symskill_pddl.evaluation.results import EpisodeResult

Key = tuple[str, int]
"""Task and seed of an episode."""
Work = Callable[[str, int], EpisodeResult]
"""Runs one episode."""
Begin = Callable[[], Work]
"""Called once in every process: loads what the work needs. Has to be picklable."""


class Pool(Protocol):
    """A place for episodes."""

    def run(self, begin: Begin, episodes: Sequence[Key]) -> Iterator[tuple[str, EpisodeResult]]:
        """Task and result of every episode, in any order."""


@dataclass(frozen=True)
class Processes:
    """`jobs` processes of this machine; one runs in this process."""

    jobs: int = 1

    def __post_init__(self) -> None:
        if self.jobs < 1:
            raise InputError(f"an evaluation needs at least one job, got {self.jobs}")

    def run(self, begin: Begin, episodes: Sequence[Key]) -> Iterator[tuple[str, EpisodeResult]]:
        jobs = min(self.jobs, len(episodes))
        if jobs <= 1:
            work = begin() if episodes else None
            for task, seed in episodes:
                assert work is not None
                yield task, work(task, seed)
            return
        # spawned, not forked: a fork copies whatever threads and locks this process has
        with workers.pool(jobs, "spawn", _start, (begin,)) as pool:
            futures = {pool.submit(_work, task, seed): task for task, seed in episodes}
            try:
                for future in as_completed(futures):
                    yield futures[future], future.result()
            finally:
                # when one stops in the middle, what has not begun does not begin
                pool.shutdown(wait=False, cancel_futures=True)


_process: Work
"""What a worker process keeps between episodes."""


def _start(begin: Begin) -> None:
    global _process
    _process = begin()


def _work(task: str, seed: int) -> EpisodeResult:
    return _process(task, seed)


@dataclass(frozen=True)
class Ray:
    """A Ray cluster, a worker per processor of it. Every node needs this package and the library under the same path.

    Attributes
    ----------
    address : str
        Of the cluster (``host:6379``, ``ray://host:10001``, ``auto``); ``local`` starts one on this machine.
    jobs : int
        Workers at most; 0 for as many as the cluster has processors.
    """

    address: str = "auto"
    jobs: int = 0

    def run(self, begin: Begin, episodes: Sequence[Key]) -> Iterator[tuple[str, EpisodeResult]]:
        if not episodes:
            return
        ray = _ray()
        mine = not ray.is_initialized()
        if mine:
            try:
                address = None if self.address == "local" else self.address
                ray.init(address, log_to_driver=False, logging_level="error", include_dashboard=False)
            except (ConnectionError, OSError, RuntimeError, ValueError) as error:
                raise InputError(f"no Ray cluster at '{self.address}': {str(error).splitlines()[0]}") from None
        try:
            yield from _on(ray, begin, episodes, self.jobs or int(ray.cluster_resources().get("CPU", 1)))
        finally:
            if mine:
                ray.shutdown()


def _on(ray: Any, begin: Begin, episodes: Sequence[Key], count: int) -> Iterator[tuple[str, EpisodeResult]]:
    # an actor per worker, so that the library is loaded once in each
    actor = ray.remote(num_cpus=1, max_restarts=2, max_task_retries=2)(_Worker)
    idle = [actor.remote(begin) for _ in range(min(count, len(episodes)))]
    running: dict[Any, tuple[str, Any]] = {}
    waiting = list(reversed(episodes))
    while waiting or running:
        while idle and waiting:
            worker, (task, seed) = idle.pop(), waiting.pop()
            running[worker.run.remote(task, seed)] = task, worker
        (done,), _ = ray.wait(list(running))
        task, worker = running.pop(done)
        idle.append(worker)
        yield task, ray.get(done)


class _Worker:
    """What runs on a cluster."""

    def __init__(self, begin: Begin) -> None:
        # as the program itself does: nothing here draws. (Ray keeps a worker's linear algebra on as many threads as it has
        # processors, which is one.)
        os.environ.setdefault("MUJOCO_GL", "disabled")
        self._work = begin()

    def run(self, task: str, seed: int) -> EpisodeResult:
        return self._work(task, seed)


def _ray() -> Any:
    try:
        import ray
    except ImportError:
        raise MissingDependencyError("--ray needs Ray, which is not installed; pip install 'symskill-pddl[ray]'") from None
    return ray
