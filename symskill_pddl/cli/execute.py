"""Commands that move the robot or tell of it: run, report."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from symskill_pddl.cli import options, work
from symskill_pddl.cli.console import emit_json, progress, remark, say, table
from symskill_pddl.cli.film import check_video, filmed
from symskill_pddl.errors import InputError
from symskill_pddl.files import TRACE, Output
from symskill_pddl.worlds import DEFAULT, ready

if TYPE_CHECKING:
    from symskill_pddl.arena import Film
    from symskill_pddl.evaluation.results import EpisodeResult
    from symskill_pddl.evaluation.trial import Episode
    from symskill_pddl.execution.config import ExecutionConfig
    from symskill_pddl.execution.outcome import Outcome
    from symskill_pddl.library import Library
    from symskill_pddl.planning import Planner


def run(
    library: options.LibraryArgument,
    task: options.TaskOption,
    seed: options.SeedOption = 0,
    world: options.WorldOption = DEFAULT,
    planner: options.PlannerOption = None,
    goal: options.GoalOption = None,
    domain: options.EditedOption = None,
    problem: Annotated[
        Path | None, typer.Option("--problem", metavar="PROBLEM", help="Objects and goal from this file, a problem of --domain.")
    ] = None,
    no_monitor: options.NoMonitorFlag = False,
    no_resampling: options.NoResamplingFlag = False,
    no_replanning: options.NoReplanningFlag = False,
    no_tracking: options.NoTrackingFlag = False,
    no_obstacles: options.NoObstaclesFlag = False,
    disturb: options.DisturbOption = None,
    trace: Annotated[Path | None, typer.Option("--trace", help="Write every decision to this file (JSON lines).")] = None,
    video: options.VideoOption = None,
    json: options.JsonFlag = False,
    force: options.ForceFlag = False,
) -> None:
    """Plan and carry out a task. Exit status 1 if the goal is missed."""
    from symskill_pddl.evaluation.trial import prepare
    from symskill_pddl.planning import get

    check_video(video, world, force=force)
    if problem is not None and (domain is None or goal is not None):
        raise InputError("--problem needs --domain, whose problem it is, and states the goal, so --goal cannot stand with it")
    arena = ready(world, task)
    for spec in disturb or ():
        arena.check_disturbance(spec)
    kept = options.output(trace, TRACE, force=force, inputs=[library, domain, problem]) if trace is not None else None
    learned, engine, posed = work.open_library(library), get(planner or "auto"), None
    if domain is not None:
        learned, written, comparison = work.edit(learned, domain)
        for finding in comparison.findings:
            remark(str(finding))
        posed = work.posed_problem(problem, written, comparison) if problem is not None else None
    with progress(f"setting up {task}, seed {seed}"):
        episode = prepare(learned, task, seed, world=world, goal=goal, posed=posed, disturbances=disturb or ())
    for note in episode.notes:
        remark(note)
    checksum = work.checksum_of(library, domain)
    config = work.execution_config(
        no_resampling=no_resampling, no_replanning=no_replanning, no_tracking=no_tracking, no_obstacles=no_obstacles
    )
    with filmed(episode.world, video, world) as film:
        result, outcome = run_shown(
            learned, episode, seed, engine, monitor=not no_monitor, trace=kept, checksum=checksum, config=config, film=film
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
    trace: Output | None,
    checksum: str,
    config: ExecutionConfig | None = None,
    film: Film | None = None,
) -> tuple[EpisodeResult, Outcome]:
    """Run an episode with its steps shown as they begin; the trace takes its place when the run is over."""
    from symskill_pddl.evaluation.trial import run_episode
    from symskill_pddl.execution.trace import TraceWriter

    with ExitStack() as stack:
        advance = stack.enter_context(progress(f"running {episode.world.task}, seed {seed}"))

        def shown(line: Any) -> None:
            if line.event == "step":
                text = " ".join((line.step.name, *line.step.args))
                advance(text=f"{episode.world.task} at {line.time:.0f} s: {text}")
                if film is not None:
                    film.caption = text

        writer = None
        if trace is not None:
            # a crash leaves what was written beside the old trace, which stays as it was
            stack.enter_context(trace.growing(f"another run is writing '{trace.path}'"))
            writer = stack.enter_context(TraceWriter(trace.partial))
        return run_episode(
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


def outcome_json(episode: Episode, result: EpisodeResult, outcome: Outcome) -> dict[str, Any]:
    """A run for programs."""
    return {
        "task": episode.world.task,
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


def report(
    source: Annotated[
        Path, typer.Argument(metavar="TRACE|RESULTS", help="trace.jsonl of a run, or results.json of an evaluation.")
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="The HTML page to write.")],
    force: options.ForceFlag = False,
) -> None:
    """Make a page from a trace or from results."""
    work.write_report(source, output, force=force)
    remark(f"{output}: written")
