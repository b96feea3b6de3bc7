"""Commands that move the robot or tell of it: run, evaluate, report."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import asdict
from functools import partial as partial_of
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from symskill_pddl.cli import work
from symskill_pddl.cli.console import emit_json, not_yet, progress, remark, say, table
from symskill_pddl.cli.film import check_video, filmed
from symskill_pddl.cli.options import (
    DisturbOption,
    EditedOption,
    GoalOption,
    JsonFlag,
    LibraryArgument,
    NoMonitorFlag,
    NoObstaclesFlag,
    NoReplanningFlag,
    NoResamplingFlag,
    PlannerOption,
    SeedOption,
    TaskOption,
    VideoOption,
    require_folder,
)
from symskill_pddl.errors import InputError

if TYPE_CHECKING:
    from symskill_pddl.evaluation.results import EpisodeResult, Results
    from symskill_pddl.evaluation.trial import Episode
    from symskill_pddl.execution.config import ExecutionConfig
    from symskill_pddl.execution.outcome import Outcome
    from symskill_pddl.kitchen.film import Film
    from symskill_pddl.library import Library
    from symskill_pddl.planning import Planner


def run(
    library: LibraryArgument,
    task: TaskOption,
    seed: SeedOption = 0,
    planner: PlannerOption = None,
    goal: GoalOption = None,
    domain: EditedOption = None,
    problem: Annotated[
        Path | None, typer.Option("--problem", metavar="PROBLEM", help="Objects and goal from this file, a problem of --domain.")
    ] = None,
    no_monitor: NoMonitorFlag = False,
    no_resampling: NoResamplingFlag = False,
    no_replanning: NoReplanningFlag = False,
    no_obstacles: NoObstaclesFlag = False,
    disturb: DisturbOption = None,
    trace: Annotated[Path | None, typer.Option("--trace", help="Write every decision to this file (JSON lines).")] = None,
    video: VideoOption = None,
    json: JsonFlag = False,
) -> None:
    """Plan and carry out a task in the kitchen. Exit status 1 if the goal is missed."""
    from symskill_pddl.evaluation.trial import prepare
    from symskill_pddl.planning import get

    if trace is not None:
        require_folder(trace)
    check_video(video)
    if problem is not None and (domain is None or goal is not None):
        raise InputError("--problem needs --domain, whose problem it is, and states the goal, so --goal cannot stand with it")
    learned, engine, posed = work.open_library(library), get(planner or "auto"), None
    if domain is not None:
        learned, written, comparison = work.edit(learned, domain)
        for finding in comparison.findings:
            remark(str(finding))
        posed = work.posed_problem(problem, written, comparison) if problem is not None else None
    with progress(f"setting up {task}, seed {seed}"):
        episode = prepare(learned, task, seed, goal=goal, posed=posed, disturbances=disturb or ())
    for note in episode.notes:
        remark(note)
    checksum = work.checksum(library, domain)
    config = work.execution_config(no_resampling=no_resampling, no_replanning=no_replanning, no_obstacles=no_obstacles)
    with filmed(episode.kitchen, video) as film:
        result, outcome = run_shown(
            learned, episode, seed, engine, monitor=not no_monitor, trace=trace, checksum=checksum, config=config, film=film
        )
    if json:
        emit_json(outcome_json(episode, result, outcome))
    else:
        tell(result, outcome)
    if not result.success:
        raise typer.Exit(1)


def run_shown(
    library: Library,
    episode: Episode,
    seed: int,
    planner: Planner,
    *,
    monitor: bool,
    trace: Path | None,
    checksum: str,
    config: ExecutionConfig | None = None,
    film: Film | None = None,
) -> tuple[EpisodeResult, Outcome]:
    """Run an episode with its steps shown as they begin; the trace takes its place when the run is over."""
    from symskill_pddl.evaluation.trial import run_episode
    from symskill_pddl.execution.trace import TraceWriter

    with ExitStack() as stack:
        advance = stack.enter_context(progress(f"running {episode.kitchen.task}, seed {seed}"))

        def shown(line: Any) -> None:
            if line.event == "step":
                text = " ".join((line.step.name, *line.step.args))
                advance(text=f"{episode.kitchen.task} at {line.time:.0f} s: {text}")
                if film is not None:
                    film.caption = text

        # a crash leaves what was written beside the old trace, which stays as it was
        partial = trace.with_name(f"{trace.name}.partial") if trace is not None else None
        writer = stack.enter_context(TraceWriter(partial)) if partial is not None else None
        found = run_episode(
            library,
            episode,
            seed,
            planner,
            monitor=monitor,
            config=config,
            trace=writer,
            library_checksum=checksum,
            on_event=shown,
        )
    if trace is not None and partial is not None:
        partial.replace(trace)
    return found


def outcome_json(episode: Episode, result: EpisodeResult, outcome: Outcome) -> dict[str, Any]:
    """A run for programs."""
    return {
        "task": episode.kitchen.task,
        "goal": [str(a) for a in sorted(episode.problem.goal)],
        **result.model_dump(exclude={"steps", "recoveries"}),
        "recoveries": list(outcome.recoveries),
        "steps": [
            {
                "step": s.step,
                "start_s": round(s.start_s, 3),
                "stop_s": round(s.stop_s, 3),
                "verdict": s.verdict,
                "reason": s.reason,
            }
            for s in outcome.steps
        ],
        "times_ms": {name: asdict(spread) for name, spread in outcome.times.items()},
    }


def tell(result: EpisodeResult, outcome: Outcome) -> None:
    """A run for people."""
    from symskill_pddl.execution.timing import AGAIN, FIRST, TICK

    rows = [(f"{s.start_s:.1f}", f"{s.stop_s:.1f}", s.step, s.verdict, s.reason) for s in outcome.steps]
    if rows:
        table("", ("from [s]", "to [s]", "step", "verdict", "because"), rows)
    recovered = f", recoveries: {', '.join(outcome.recoveries)}" if outcome.recoveries else ""
    cause = f" ({result.cause})" if result.cause else ""
    say(f"{result.category}{cause}: {result.reason} ({result.time_s:.1f} s, {result.replans} new plans{recovered})")
    measured = [f"{name} {t.p95:.2f} ms (of {t.n})" for name in (TICK, FIRST, AGAIN) if (t := outcome.times.get(name))]
    if measured:
        say(f"computing time at the 95th percentile: {', '.join(measured)}")


def evaluate(
    library: LibraryArgument,
    output: Annotated[Path, typer.Option("-o", "--output", help="The results file to write.")],
    tasks: Annotated[str | None, typer.Option("--tasks", help="all, or names separated by commas.")] = None,
    suite: Annotated[
        str | None,
        typer.Option("--suite", help="atomic, composed, disturbed, mixed, or a disturbance's name: tasks and what goes wrong."),
    ] = None,
    trials: Annotated[int, typer.Option("--trials", help="Episodes per task.")] = 20,
    seed: Annotated[int, typer.Option("--seed", help="Seed of the first episode.")] = 1000,
    planner: PlannerOption = None,
    domain: EditedOption = None,
    no_monitor: NoMonitorFlag = False,
    no_resampling: NoResamplingFlag = False,
    no_replanning: NoReplanningFlag = False,
    no_obstacles: NoObstaclesFlag = False,
    disturb: DisturbOption = None,
    jobs: Annotated[int, typer.Option("--jobs", help="Processes.")] = 1,
    ray: Annotated[bool, typer.Option("--ray", help="Not in this version.")] = False,
    json: JsonFlag = False,
) -> None:
    """Run many seeded episodes and count; the results do not depend on --jobs.

    Until the end, every episode is kept in OUTPUT.partial.jsonl: called again after a kill, with the same settings, the
    evaluation goes on where it was.
    """
    from symskill_pddl.evaluation.partial import Partial, partial_path
    from symskill_pddl.evaluation.results import save_results
    from symskill_pddl.evaluation.suite import Suite, chosen, run_suite

    if ray:
        raise not_yet("--ray")
    config = work.execution_config(no_resampling=no_resampling, no_replanning=no_replanning, no_obstacles=no_obstacles)
    preset = chosen(tasks, suite)
    disturbances = (*preset.disturbances, *(disturb or ()))
    asked = Suite(preset.tasks, trials, seed, planner or "auto", not no_monitor, disturbances, config)
    require_folder(output)
    work.open_edited(library, domain)
    count, checksum = len(asked.episodes), work.checksum(library, domain)
    with Partial(partial_path(output), asked.settings(checksum), asked.tasks) as partial:
        if partial.done:
            remark(f"{count} episodes, {len(partial.done)} of them done before")
        with progress(f"{count} episodes", total=count) as advance:
            advance(len(partial.done))

            def done(task: str, episode: EpisodeResult) -> None:
                partial.add(task, episode)
                advance(1)
                advance.remark(f"{task} {episode.seed}: {episode.category} ({episode.time_s:.0f} s)")

            results = run_suite(
                partial_of(work.open_edited, domain=domain),
                library,
                asked,
                checksum=checksum,
                jobs=jobs,
                done=dict(partial.done),
                on_episode=done,
            )
        save_results(output, results)
        partial.remove()
    if json:
        emit_json(results.model_dump(mode="json"))
    else:
        show_results(results)


def show_results(results: Results) -> None:
    """A results file as a table."""
    rows = []
    for task in results.tasks:
        low, high = task.interval
        failures, troubles = (", ".join(f"{n} {name}" for name, n in of.items()) or "-" for of in (task.failures, task.troubles))
        typical = "-" if task.median_time_s is None else f"{task.median_time_s:.1f}"
        rows.append(
            (
                task.task,
                f"{task.successes}/{task.trials}",
                f"{low:.2f}-{high:.2f}",
                typical,
                f"{task.mean_replans:.1f}",
                f"{task.mean_recoveries:.1f}",
                troubles,
                failures,
            )
        )
    table("", ("task", "successes", "95 % interval", "median [s]", "new plans", "recoveries", "troubles", "failures"), rows)


def report(
    source: Annotated[
        Path, typer.Argument(metavar="TRACE|RESULTS", help="trace.jsonl of a run, or results.json of an evaluation.")
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="The HTML page to write.")],
) -> None:
    """Make a page from a trace or from results."""
    work.write_report(source, output)
    remark(f"{output}: written")
