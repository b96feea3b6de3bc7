"""`symskill quickstart`: from the shipped demonstrations to a robot that finishes a task although somebody shuts the door."""

from __future__ import annotations

from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated

import typer

from symskill_pddl.cli import work
from symskill_pddl.cli.console import progress, remark, say, table
from symskill_pddl.cli.film import check_video, filmed
from symskill_pddl.cli.options import ForceFlag, SeedOption, VideoOption
from symskill_pddl.cli.options import output as checked_output
from symskill_pddl.files import DOMAIN, NAMES, PAGE, PLAN, PROBLEM, TRACE, make_folder, sealed

if TYPE_CHECKING:
    from symskill_pddl.evaluation.results import EpisodeResult
    from symskill_pddl.execution.outcome import Outcome, StepRecord
    from symskill_pddl.execution.trace import Trace

WORLD = "kitchen"
"""It comes with demonstrations."""
FILES = {
    "domain.pddl": DOMAIN,
    "names.json": NAMES,
    "problem.pddl": PROBLEM,
    "problem.names.json": NAMES,
    "plan.txt": PLAN,
    "trace.jsonl": TRACE,
    "report.html": PAGE,
}
"""What it makes beside the library."""
DISTURBANCE = "close-door@op={}"
"""Somebody shuts the cabinet when the step before the middle of the plan starts."""


def quickstart(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for everything that is made.")] = Path("symskill-out"),
    task: Annotated[str, typer.Option("--task", help="A task of the kitchen.")] = "StoreCheese",
    seed: SeedOption = 0,
    disturb: Annotated[
        list[str] | None, typer.Option("--disturb", metavar="SPEC", help="What is to go wrong; may be repeated.")
    ] = None,
    video: VideoOption = None,
    force: ForceFlag = False,
) -> None:
    """Learn, export, plan, run with one disturbance, and write a report."""
    from symskill_pddl.cli.execute import run_shown
    from symskill_pddl.cli.views import operator_table
    from symskill_pddl.evaluation.trial import prepare
    from symskill_pddl.execution.trace import read_trace
    from symskill_pddl.pddl import write_plan
    from symskill_pddl.planning import get
    from symskill_pddl.worlds import arena_named, check_task

    begin = monotonic()
    arena = arena_named(WORLD)
    check_task(arena, task)
    for spec in disturb or ():
        arena.check_disturbance(spec)
    check_video(video, WORLD, force=force)
    files = work.shipped_demos()
    make_folder(output)
    places = {name: checked_output(output / name, kind, force=force) for name, kind in FILES.items()}
    library, learning = work.learn_from(files, output / "library", replace=force)

    domain, texts = work.exported_domain(library, output, WORLD, "strips", {})
    work.write_all(texts, force=force)
    with progress(f"setting up {task}, seed {seed}"):
        episode = prepare(library, task, seed, world=WORLD, domain_name=WORLD)
    header = (f"task {task}, seed {seed}",)
    problem = output / "problem.pddl"
    work.write_all(work.exported_problem(episode.problem, episode.domain, problem, "strips", {}, header), force=force)

    # the plan comes from the files, as any other planner's would
    engine = get("auto")
    exported = work.read_domain_file(output / "domain.pddl")
    result = engine.solve(exported, work.read_problem_file(problem, exported))
    plan = result.unwrap()
    places["plan.txt"].write(sealed(write_plan(plan), last=True))

    disturbances = disturb or [DISTURBANCE.format(max(0, len(plan) // 2 - 1))]
    # same task, same seed: the same episode, now with something going wrong
    episode = prepare(library, task, seed, world=WORLD, disturbances=disturbances, domain_name=WORLD)
    checksum = work.checksum_of(output / "library")
    trace, page = output / "trace.jsonl", output / "report.html"
    with filmed(episode.world, video, WORLD) as film:
        kept = places[trace.name]
        found, outcome = run_shown(library, episode, seed, engine, monitor=True, trace=kept, checksum=checksum, film=film)
    work.write_report(trace, page, library, force=force)

    table(*operator_table(library))
    say()
    say(f"Learned from {len(files)} files of demonstrations in {sum(s for _, s in learning.seconds):.1f} s: {output / 'library'}")
    say(f"PDDL: {output / 'domain.pddl'} ({len(domain.operators)} actions), {output / 'problem.pddl'}")
    say(f"Plan: {output / 'plan.txt'}, {len(plan)} steps in {1000 * result.seconds:.0f} ms by {result.planner}")
    for name, args in plan.steps:
        say(f"    ({' '.join((name, *args))})")
    say()
    say(f"{task}, seed {seed}, with {' and '.join(disturbances)}  (! what was done to the scene, ~ what the robot did about it):")
    tell_story(read_trace(trace), found, outcome)
    say(f"Every decision: {trace}   To read: {page}{'' if video is None else f'   To watch: {video}'}")
    remark(f"{monotonic() - begin:.0f} s in all")
    if not found.success:
        raise typer.Exit(1)


def tell_story(trace: Trace, result: EpisodeResult, outcome: Outcome) -> None:
    """What was done, what went wrong, how the robot recovered, and how it ended."""
    lines = [(step.start_s, 1, f"{step.step}  {_ending(step)}") for step in outcome.steps]
    lines += [(note.time, 2, f"!  {note.text}") for note in trace.of("note")]
    lines += [(recovery.time, 0, f"~  {recovery.name}: {recovery.reason}") for recovery in trace.of("recovery")]
    for time, _, text in sorted(lines):
        say(f"    {time:6.1f} s  {text}")
    ending = "Success" if result.success else f"Failure ({result.category}): {result.reason}"
    again = f" after {result.replans} new plan{'' if result.replans == 1 else 's'}" if result.replans else ""
    say(f"{ending}{again}, {result.time_s:.0f} s on the robot's clock")


def _ending(step: StepRecord) -> str:
    return "done" if step.verdict == "EffectsHold" else f"left after {step.stop_s - step.start_s:.1f} s: {step.reason}"
