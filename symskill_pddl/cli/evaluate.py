"""`symskill evaluate`: many seeded episodes, counted; the same ones with a mechanism switched off, compared."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from symskill_pddl.cli import options, work
from symskill_pddl.cli.console import emit_json, progress, remark, say, table
from symskill_pddl.errors import InputError
from symskill_pddl.files import RESULTS, TRACE, make_folder
from symskill_pddl.worlds import DEFAULT, ready

if TYPE_CHECKING:
    from symskill_pddl.evaluation.paired import Difference
    from symskill_pddl.evaluation.results import EpisodeResult, Results
    from symskill_pddl.evaluation.spread import Pool
    from symskill_pddl.evaluation.suite import Suite


def evaluate(
    library: options.LibraryArgument,
    output: Annotated[Path, typer.Option("-o", "--output", help="The results file to write.")],
    tasks: Annotated[str | None, typer.Option("--tasks", help="all, or names separated by commas.")] = None,
    suite: Annotated[
        str | None,
        typer.Option("--suite", help="Tasks and what goes wrong by one name: atomic, composed, or another that the world has."),
    ] = None,
    trials: Annotated[int, typer.Option("--trials", help="Episodes per task.")] = 20,
    seed: Annotated[int, typer.Option("--seed", help="Seed of the first episode.")] = 1000,
    world: options.WorldOption = DEFAULT,
    planner: options.PlannerOption = None,
    domain: options.EditedOption = None,
    no_monitor: options.NoMonitorFlag = False,
    no_resampling: options.NoResamplingFlag = False,
    no_replanning: options.NoReplanningFlag = False,
    no_tracking: options.NoTrackingFlag = False,
    no_obstacles: options.NoObstaclesFlag = False,
    against: Annotated[
        list[str] | None,
        typer.Option("--against", metavar="MECHANISM", help="Also without it, same episodes, compared; may be repeated."),
    ] = None,
    keep_failed: Annotated[
        Path | None, typer.Option("--keep-failed", metavar="DIR", help="Keep the traces of the episodes that fail.")
    ] = None,
    disturb: options.DisturbOption = None,
    jobs: Annotated[int | None, typer.Option("--jobs", help="Processes, 1 if not given; with --ray, workers at most.")] = None,
    ray: Annotated[
        str | None, typer.Option("--ray", metavar="ADDRESS", help="Run on the Ray cluster there; local starts one here.")
    ] = None,
    json: options.JsonFlag = False,
    force: options.ForceFlag = False,
) -> None:
    """Run many seeded episodes and count; the results do not depend on --jobs and --ray.

    Until the end, every episode is kept in OUTPUT.partial.jsonl: called again after a kill, with the same settings, the
    evaluation goes on where it was.
    """
    from symskill_pddl.evaluation.ablations import without
    from symskill_pddl.evaluation.paired import compare
    from symskill_pddl.evaluation.spread import Processes, Ray
    from symskill_pddl.evaluation.suite import Suite, chosen

    config = work.execution_config(
        no_resampling=no_resampling, no_replanning=no_replanning, no_tracking=no_tracking, no_obstacles=no_obstacles
    )
    preset, mechanisms = chosen(ready(world), tasks, suite), against or []
    disturbances = (*preset.disturbances, *(disturb or ()))
    asked = Suite(preset.tasks, trials, seed, planner or "auto", not no_monitor, disturbances, config, world)
    if len(set(mechanisms)) < len(mechanisms):
        raise InputError(f"--against names a mechanism twice: {', '.join(mechanisms)}")
    others = {mechanism: without(asked, mechanism) for mechanism in mechanisms}
    pool: Pool = Processes(1 if jobs is None else jobs) if ray is None else Ray(ray, jobs or 0)
    options.output(output, RESULTS, force=force, inputs=[domain, library])
    work.open_edited(library, domain)
    run = partial(_run, library, domain, pool=pool, force=force)
    results = run(asked, output, "", keep_failed, keep=bool(others))
    compared: dict[str, tuple[Difference, ...]] = {}
    for mechanism, other in others.items():
        path = output.with_name(f"{output.stem}.no-{mechanism}{output.suffix}")
        kept = keep_failed / f"no-{mechanism}" if keep_failed is not None else None
        found = run(other, path, f" without {mechanism}", kept, keep=True)
        compared[mechanism] = compare(results, found)
    if json:
        document = results.model_dump(mode="json")
        rows = {mechanism: [row.model_dump(mode="json") for row in found] for mechanism, found in compared.items()}
        emit_json(document | {"against": rows} if others else document)
        return
    show_results(results)
    for mechanism, differences in compared.items():
        say()
        show_differences(mechanism, differences)


def _run(
    library: Path,
    domain: Path | None,
    suite: Suite,
    output: Path,
    what: str,
    failed: Path | None,
    *,
    keep: bool,
    pool: Pool,
    force: bool,
) -> Results:
    from symskill_pddl.evaluation.resumable import evaluate as run

    if failed is not None:
        make_folder(failed)
    file = options.output(output, RESULTS, force=force, inputs=[domain, library])
    if failed is not None:
        for task, seed in suite.episodes:
            options.output(failed / f"{task}-{seed}.jsonl", TRACE, force=force)
    count, checksum = len(suite.episodes), work.checksum_of(library, domain)
    with progress(f"{count} episodes{what}", total=count) as advance:

        def start(before: int) -> None:
            if before:
                remark(f"{count} episodes{what}, {before} of them done before")
            advance(before)

        def done(task: str, episode: EpisodeResult) -> None:
            advance(1)
            advance.remark(f"{task} {episode.seed}: {episode.category} ({episode.time_s:.0f} s)")

        return run(
            partial(work.open_unchanged, domain=domain, checksum=checksum),
            library,
            suite,
            file,
            checksum=checksum,
            pool=pool,
            failed=failed,
            keep=keep,
            on_start=start,
            on_episode=done,
        )


def show_results(results: Results) -> None:
    """A results file as a table."""
    rows = []
    for task in results.tasks:
        low, high = task.interval
        failures, troubles = (", ".join(f"{n} {name}" for name, n in of.items()) or "-" for of in (task.failures, task.troubles))
        typical = "-" if task.median_time_s is None else f"{task.median_time_s:.1f}"
        numbers = (f"{task.successes}/{task.trials}", f"{low:.2f}-{high:.2f}", typical)
        rows.append((task.task, *numbers, f"{task.mean_replans:.1f}", f"{task.mean_recoveries:.1f}", troubles, failures))
    table("", ("task", "successes", "95 % interval", "median [s]", "new plans", "recoveries", "troubles", "failures"), rows)


def show_differences(mechanism: str, differences: Sequence[Difference]) -> None:
    """A comparison as a table."""
    rows = []
    for d in differences:
        low, high = d.interval
        rates = (f"{d.both + d.only_first}/{d.trials}", f"{d.both + d.only_second}/{d.trials}")
        rows.append((d.task, *rates, f"{d.difference:+.2f}", f"{low:+.2f} to {high:+.2f}", f"{d.p_value:.2g}"))
    table("", ("task", f"with {mechanism}", "without", "difference", "95 % interval", "p (McNemar)"), rows)
