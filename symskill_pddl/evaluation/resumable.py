"""A suite from its settings to its results file, going on where a kill left it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from symskill_pddl.errors import InputError
from symskill_pddl.evaluation.partial import Partial, differences, partial_path
from symskill_pddl.evaluation.results import EpisodeResult, Results, load_results
from symskill_pddl.evaluation.spread import Pool
from symskill_pddl.evaluation.suite import Suite, run_suite
from symskill_pddl.files import Output, Replace
from symskill_pddl.library import Library


def evaluate(
    load: Callable[[Path], Library],
    path: Path,
    suite: Suite,
    output: Output,
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
    output : Output
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
        Other settings than those of the episodes so far, or of the results that are there and must not be replaced; or another
        evaluation is writing them.
    """
    settings = suite.settings(checksum)
    there = output.path.exists() and output.path.stat().st_size > 0
    if there and not (output.replace is Replace.ANYTHING and not output.kind.wrote(output.path)):
        found = load_results(output.path)
        different = differences(found.settings, tuple(t.task for t in found.tasks), settings, suite.tasks)
        if keep and not different:
            return found
        if different and output.replace is not Replace.ANYTHING:
            raise InputError(
                f"'{output.path}' holds the results of another evaluation ({'; '.join(different)}): "
                "choose another -o, or replace them with --force"
            )
    with Partial(partial_path(output.path), settings, suite.tasks) as partial:
        if on_start is not None:
            on_start(len(partial.done))

        def done(task: str, episode: EpisodeResult) -> None:
            partial.add(task, episode)
            if on_episode is not None:
                on_episode(task, episode)

        results = run_suite(
            load, path, suite, checksum=checksum, pool=pool, failed=failed, done=dict(partial.done), on_episode=done
        )
        output.write(results.dumps().encode())
        partial.remove()
    return results
