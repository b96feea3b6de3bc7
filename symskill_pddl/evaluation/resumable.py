"""A suite from its settings to its results file, going on where a kill left it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from symskill_pddl.evaluation.partial import Partial, partial_path
from symskill_pddl.evaluation.results import EpisodeResult, Results, load_results, save_results
from symskill_pddl.evaluation.spread import Pool
from symskill_pddl.evaluation.suite import Suite, run_suite
from symskill_pddl.library import Library


def evaluate(
    load: Callable[[Path], Library],
    path: Path,
    suite: Suite,
    output: Path,
    *,
    checksum: str,
    pool: Pool,
    failed: Path | None = None,
    keep: bool = False,
    on_start: Callable[[int], None] | None = None,
    on_episode: Callable[[str, EpisodeResult], None] | None = None,
) -> Results:
    """Run what is left of a suite, and write its results.

    Parameters
    ----------
    load, path, checksum
        How and from where each process gets the library, and what tells it from others.
    output : Path
        The results file; the episodes so far lie beside it until it is written.
    pool : Pool
        Where episodes are run.
    failed : Path, optional
        A folder for the traces of the episodes that fail.
    keep : bool
        A results file that is there already, of the same settings and tasks, is taken as it is.
    on_start : callable, optional
        Told how many episodes were done before.
    on_episode : callable, optional
        Told of every episode that is run now.

    Raises
    ------
    InputError
        Other settings than those of the episodes so far, or another evaluation is writing them.
    """
    settings = suite.settings(checksum)
    if keep and output.exists():
        found = load_results(output)
        if found.settings == settings and tuple(t.task for t in found.tasks) == suite.tasks:
            return found
    with Partial(partial_path(output), settings, suite.tasks) as partial:
        if on_start is not None:
            on_start(len(partial.done))

        def done(task: str, episode: EpisodeResult) -> None:
            partial.add(task, episode)
            if on_episode is not None:
                on_episode(task, episode)

        results = run_suite(
            load, path, suite, checksum=checksum, pool=pool, failed=failed, done=dict(partial.done), on_episode=done
        )
        save_results(output, results)
        partial.remove()
    return results
