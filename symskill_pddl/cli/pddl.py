"""Commands about PDDL files: export, problem, planners, plan, check."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from symskill_pddl.cli import options, work
from symskill_pddl.cli.console import emit_json, progress, remark, say, table
from symskill_pddl.errors import InputError, NoPlanError
from symskill_pddl.files import PLAN, PROBLEM, sealed
from symskill_pddl.worlds import DEFAULT, ready

if TYPE_CHECKING:
    from symskill_pddl.evaluation.moment import Moment
    from symskill_pddl.evaluation.trial import Episode
    from symskill_pddl.library import Library

UNIFIED = "unified-planning:"
_REMARKS = 5
"""How many lines about what is odd in a text are enough."""

NameOption = Annotated[str, typer.Option("--name", help="The domain's name.")]


def export(
    library: options.LibraryArgument,
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for domain.pddl and names.json.")],
    dialect: options.DialectOption = "strips",
    name: NameOption = "learned",
    names: options.NamesOption = None,
    strict: Annotated[bool, typer.Option("--strict", help="All that held in every demonstration is a precondition.")] = False,
    force: options.ForceFlag = False,
) -> None:
    """Write a library's domain as PDDL."""
    learned, renamed = work.open_library(library), work.renames(names)
    made: list[work.File] = []
    told = []
    for form, folder in work.forms(learned.domain(name, strict=strict), dialect, output):
        domain, files = work.exported_domain(learned, folder, name, form, renamed, strict=strict)
        made += files
        told.append(f"{folder / 'domain.pddl'}: {len(domain.predicates)} predicates, {len(domain.operators)} actions ({form})")
    work.write_all(made, force=force, inputs=[library, names])
    for line in told:
        remark(line)


def problem(
    library: options.LibraryArgument,
    output: Annotated[Path, typer.Option("-o", "--output", help="The problem file to write.")],
    task: Annotated[str | None, typer.Option("--task", help="A task of the world.")] = None,
    seed: options.SeedOption = 0,
    world: options.WorldOption = DEFAULT,
    moment: Annotated[
        str | None,
        typer.Option("--from", metavar="MOMENT", help="Instead of a task: a moment of a recording, demos.hdf5:demo_0@2.5s."),
    ] = None,
    goal: options.GoalOption = None,
    goal_at: Annotated[
        str | None, typer.Option("--goal-at", metavar="TIME", help="With --from: what the recording shows then, 8.5s or END.")
    ] = None,
    dialect: options.DialectOption = "strips",
    name: NameOption = "learned",
    names: options.NamesOption = None,
    force: options.ForceFlag = False,
) -> None:
    """Write an episode of a task, or a moment of a recording, as a PDDL problem: its objects and atoms, and its goal."""
    if (task is None) == (moment is None):
        raise InputError("say where the problem comes from: --task TASK of a world, or --from demos.hdf5:demo_0@0s")
    if goal_at is not None and (moment is None or goal is not None):
        raise InputError("--goal-at belongs to --from, and stands in place of --goal")
    if task is not None:
        ready(world, task)
    learned = work.open_library(library)
    options.output(output, PROBLEM, force=force, inputs=[library, names])
    posed: Episode | Moment
    if moment is not None:
        posed, header = work.moment_problem(learned, moment, goal, goal_at, name)
    else:
        posed, header = _episode_problem(learned, task or "", seed, world, goal, name)
    for a in posed.assumed:
        header.append(f"assumed {a.atom}: {a.atom.args[0]} is in no known relation, this is the nearest (margin {a.margin:.2f})")
    for told in header[1:]:
        remark(told)
    renamed = work.renames(names)
    made: list[work.File] = []
    for form, folder in work.forms(posed.domain, dialect, output.parent):
        made += work.exported_problem(posed.problem, posed.domain, folder / output.name, form, renamed, header)
    work.write_all(made, force=force, inputs=[library, names])
    remark(f"{output}: {len(posed.problem.objects)} objects, goal {' '.join(str(a) for a in sorted(posed.problem.goal))}")


def _episode_problem(
    learned: Library, task: str, seed: int, world: str, goal: str | None, name: str
) -> tuple[Episode, list[str]]:
    from symskill_pddl.evaluation.trial import prepare

    with progress(f"setting up {task}, seed {seed}"):
        return prepare(learned, task, seed, world=world, goal=goal, domain_name=name), [f"task {task}, seed {seed}"]


def planners(json: options.JsonFlag = False) -> None:
    """List the planners that are installed, and what each accepts."""
    from symskill_pddl.planning import missing
    from symskill_pddl.planning import planners as installed

    with progress("asking for installed planners"):
        found = installed(unified=True)
    if json:
        emit_json([{"name": p.name, "version": p.version, "licence": p.licence, "dialects": list(p.dialects)} for p in found])
        return
    rows = [(p.name, p.version, p.licence, ", ".join(p.dialects)) for p in found if not p.name.startswith(UNIFIED)]
    table("", ("planner", "version", "licence", "reads"), rows)
    if engines := [p.name.removeprefix(UNIFIED) for p in found if p.name.startswith(UNIFIED)]:
        remark(f"through unified-planning, as {UNIFIED}ENGINE: {', '.join(engines)}")
    if absent := missing():
        remark(f"not installed: {', '.join(absent)}; pip install 'symskill-pddl[planners]'")


def plan(
    domain: Annotated[Path, typer.Argument(metavar="DOMAIN", help="A PDDL domain.")],
    problem: Annotated[Path, typer.Argument(metavar="PROBLEM", help="A PDDL problem of it.")],
    planner: options.PlannerOption = None,
    timeout: Annotated[float, typer.Option(help="Time limit [s].")] = 10.0,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="The plan file; without it the plan is printed.")] = None,
    any_plan: Annotated[bool, typer.Option("--any-plan", help="Any plan will do, whatever the problem's metric.")] = False,
    all_engines: Annotated[bool, typer.Option("--all-engines", help="Ask every planner that is installed; a table.")] = False,
    k: Annotated[int, typer.Option("--k", metavar="N", help="Up to N plans that differ in a step.")] = 1,
    json: options.JsonFlag = False,
    force: options.ForceFlag = False,
) -> None:
    """Solve a problem, whoever wrote it. Exit status 1, and an explanation, if there is no plan.

    Planners that read PDDL are given the files as they are; the plan is validated by our own reading of them.
    """
    from symskill_pddl.planning import Limits, get

    if all_engines and (planner is not None or k != 1):
        raise InputError("--all-engines asks every planner for one plan; it goes with neither --planner nor --k")
    task = work.read_task_files(domain, problem)
    for line in task.remarks[:_REMARKS]:
        remark(line)
    limits = Limits(time_s=timeout)
    file = options.output(output, PLAN, force=force, inputs=[domain, problem]) if output is not None else None
    from symskill_pddl.cli import answers  # loads the planners

    if all_engines:
        found = answers.of_all(task, limits, any_plan=any_plan)
    elif k != 1:
        found = answers.several(get(planner or "auto"), task, k, limits)
    else:
        found = answers.one(get(planner or "auto"), task, limits, any_plan=any_plan)
    if json:
        emit_json(found.document())
    if (best := found.best) is None:
        if not json:
            found.tell()
            raise NoPlanError(f"'{problem}' has no plan: {found.status}")
        raise typer.Exit(1)
    if file is not None:
        from symskill_pddl.pddl.plan import write_plan

        file.write(sealed(write_plan(best), last=True))
    elif not json:
        found.show()
    found.tell()


def check(
    library: options.LibraryArgument,
    domain: Annotated[Path, typer.Argument(metavar="DOMAIN", help="A PDDL domain, perhaps edited.")],
    problem: Annotated[Path | None, typer.Argument(metavar="PROBLEM", help="A problem of it.")] = None,
    plan: Annotated[Path | None, typer.Argument(metavar="PLAN", help="A plan of that.")] = None,
    dialect: Annotated[str | None, typer.Option("--dialect", help="What it was exported as; else the nearest.")] = None,
    json: options.JsonFlag = False,
) -> None:
    """Compare a domain with the library, validate a problem and a plan of it, and bind the plan to skills.

    Exit status 1 if an action would not run or not do what the domain says, 2 if a file is wrong in itself.
    """
    from symskill_pddl.symbols import validate

    learned = work.open_library(library)
    edited = work.read_domain_file(domain)
    names = work.names_beside(domain)
    comparison = work.compared(learned.domain(edited.name), edited, names, dialect)
    bound = None
    if problem is not None:
        posed = work.read_problem_file(problem, edited)
        if plan is not None:
            steps, said = work.read_plan_file(plan, edited, posed)
            for line in said:
                remark(line)
            try:
                validate(edited, posed, steps)
            except InputError as error:
                raise InputError(f"{plan}: {error}") from None
            if comparison.runs:
                bound = comparison.plan(steps, work.names_beside(problem))
    if json:
        emit_json(
            {
                "runs": comparison.runs,
                "findings": [{"severity": f.severity.value, "where": f.where, "message": f.message} for f in comparison.findings],
                "bindings": [{"action": b.action, "operator": b.operator, "order": list(b.order)} for b in comparison.bindings],
                "plan": None if bound is None else [[name, *args] for name, args in bound.steps],
            }
        )
    else:
        for finding in comparison.findings:
            say(str(finding))
        if not comparison.findings:
            say(f"{domain}: as learned, {len(comparison.bindings)} actions, each with its skill")
        if bound is not None:
            say(f"{plan}: valid, {len(bound)} steps")
            for name, args in bound.steps:
                say(f"    ({' '.join((name, *args))}) by skill {learned.learned(name).skill}")
    if not comparison.runs:
        raise typer.Exit(1)
