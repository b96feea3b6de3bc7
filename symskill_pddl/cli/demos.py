"""Commands that make and look at demonstrations and libraries: record, learn, show."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from symskill_pddl.cli.console import emit_json, progress, remark, say, table
from symskill_pddl.cli.options import ForceFlag, JsonFlag, LibraryArgument, WorldOption
from symskill_pddl.cli.options import output as checked_output
from symskill_pddl.errors import InputError
from symskill_pddl.files import DEMOS, DRAWING
from symskill_pddl.worlds import DEFAULT, ready

if TYPE_CHECKING:
    from symskill_pddl.learning import LearnConfig
    from symskill_pddl.learning.vision import VisionSelector

TRACE = ".jsonl"


def record(
    task: Annotated[str, typer.Argument(metavar="TASK", help="A task of the world.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="The HDF5 file to write.")],
    n: Annotated[int, typer.Option("-n", help="How many demonstrations.")] = 10,
    seed: Annotated[int, typer.Option(help="Seed of the first episode.")] = 0,
    world: WorldOption = DEFAULT,
    force: ForceFlag = False,
) -> None:
    """Record demonstrations of a task in a simulated world."""
    from symskill_pddl.arena import Recordable
    from symskill_pddl.demos import encode_demos

    arena = ready(world, task)
    if not isinstance(arena, Recordable):
        raise InputError(f"the world '{world}' has no demonstrator")
    file = checked_output(output, DEMOS, force=force)
    with progress(f"recording {n} demonstrations of {task}"):
        demos, truths = arena.record(task, n, seed)
    file.write(encode_demos(demos, str(output), truths))
    remark(f"{output}: {len(demos)} demonstrations, {sum(d.duration_s for d in demos):.0f} s")


def learn(
    files: Annotated[list[Path] | None, typer.Argument(metavar="DEMOS...", help="Files of demonstrations.")] = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="The library's folder.")] = None,
    into: Annotated[
        Path | None, typer.Option("--into", metavar="LIBRARY", help="Add the demonstrations to those of this library.")
    ] = None,
    traces: Annotated[
        list[Path] | None,
        typer.Option("--traces", metavar="TRACE", help="Runs to learn costs from, trace.jsonl each; may be repeated."),
    ] = None,
    references: Annotated[
        str | None,
        typer.Option(
            "--references",
            metavar="KIND:MODEL",
            help="Let a vision-language model choose references: openai:MODEL or gemini:MODEL.",
        ),
    ] = None,
    references_url: Annotated[
        str | None, typer.Option("--references-url", metavar="URL", help="Its base address, such as http://localhost:8000/v1.")
    ] = None,
    references_cache: Annotated[
        Path | None, typer.Option("--references-cache", metavar="FOLDER", help="Where its answers are kept.")
    ] = None,
    insecure: Annotated[
        bool, typer.Option("--insecure", help="Send the key over plain http to another machine, readable to all on the way.")
    ] = False,
    force: ForceFlag = False,
    config: Annotated[
        Path | None, typer.Option("--config", metavar="FILE", help="Settings of learning, a TOML file; see --help-config.")
    ] = None,
    hints: Annotated[
        Path | None, typer.Option("--hints", metavar="FILE", help="What geometry cannot know, a TOML file; docs/learning.md.")
    ] = None,
    hint: Annotated[
        list[str] | None,
        typer.Option("--hint", metavar="KEY=VALUE", help="One hint, such as joints.block=free; may be repeated."),
    ] = None,
    help_config: Annotated[
        bool, typer.Option("--help-config", help="Show every setting with its value, unit and reason, and exit.")
    ] = False,
) -> None:
    """Learn predicates, operators and skills from demonstrations, and costs from recorded runs."""
    from symskill_pddl.cli.settings import parameters, read_settings
    from symskill_pddl.cli.work import check_replaced, learn_costs, read_runs, vision_selector

    settings = read_settings(config, hints, hint or ())
    if help_config:
        rows = [(e.name, e.value, e.unit, e.reason) for e in parameters(settings)]
        table("Settings of learning (A is the widest opening of the hand)", ("setting", "value", "unit", "reason"), rows)
        return
    target = output if into is None else into
    if target is None or (output is not None and into is not None):
        raise InputError("say where the library goes: -o FOLDER for a new one, or --into LIBRARY to add to one")
    # a shell makes `--traces runs/*.jsonl` one option and many arguments
    runs = [*(traces or ()), *(f for f in files or () if f.suffix == TRACE)]
    demos = [f for f in files or () if f.suffix != TRACE]
    if not demos and (into is None or not runs):
        raise InputError("nothing to learn from: name files of demonstrations, or runs with --traces and a library with --into")
    if references is None and (references_url is not None or references_cache is not None or insecure):
        raise InputError("--references-url, --references-cache and --insecure belong to --references KIND:MODEL")
    counted = read_runs(runs)
    if demos:
        if into is None:
            check_replaced(target, demos, force=force)
        selector = None
        if references is not None:
            selector = vision_selector(references, references_url, references_cache, insecure=insecure)
        _learn_demos(demos, target, into=into is not None, selector=selector, config=settings)
    if runs:
        learned, told = learn_costs(counted, target)
        for name in told:
            remark(f"the runs have steps '{name}', which is no operator of the library: left out")
        for o in (o for o in learned.operators if o.operator.name in counted.experience):
            own = o.experience
            remark(f"{o.operator.name}: {own.successes} of {own.tries} tries worked, cost {o.operator.cost:g} s")


def _learn_demos(files: list[Path], target: Path, *, into: bool, selector: VisionSelector | None, config: LearnConfig) -> None:
    from symskill_pddl.cli.settings import derived
    from symskill_pddl.cli.work import learn_from

    library, report = learn_from(files, target, into=into, selector=selector, config=config)
    if selector is not None:
        for note in (*selector.agreement.notes, str(selector.agreement)):
            remark(note)
    for note in report.notes:
        remark(note)
    for line in derived(report.symbols.demos):
        remark(line)
    remark(report.summary)
    spent = sum(seconds for _, seconds in report.seconds)
    counts = f"{len(library.classifiers)} predicates, {len(library.operators)} operators, {len(library.skills)} skills"
    remark(f"{target}: {counts}, {spent:.1f} s")


def show(
    library: LibraryArgument,
    json: JsonFlag = False,
    why: Annotated[
        str | None, typer.Option("--why", metavar="NAME", help="Where an operator or a predicate comes from, and why it is so.")
    ] = None,
    picture: Annotated[
        Path | None, typer.Option("--picture", metavar="FILE.svg", help="With --why: draw the predicate over its data.")
    ] = None,
    plots: Annotated[
        Path | None, typer.Option("--plots", metavar="DIR", help="Draw every skill into this folder, a picture for each phase.")
    ] = None,
    form: Annotated[
        str | None, typer.Option("--table", metavar="FORM", help="The operators alone, as a markdown or latex table.")
    ] = None,
    force: ForceFlag = False,
) -> None:
    """Show a library: predicates, operators and skills."""
    from symskill_pddl.cli import views
    from symskill_pddl.cli.operators import operators_as
    from symskill_pddl.cli.why import why as reasons_of
    from symskill_pddl.cli.work import open_library

    if picture is not None and why is None:
        raise InputError("--picture belongs to --why PREDICATE")
    if form is not None and (why is not None or json):
        raise InputError("--table prints the operators alone, without --why and --json")
    if plots is not None and (why is not None or form is not None or json):
        raise InputError("--plots draws the skills, without --why, --table and --json")
    learned = open_library(library)
    if plots is not None:
        from symskill_pddl.cli.plots import draw_skills

        remark(f"{plots}: {len(draw_skills(learned, plots, force=force))} pictures")
        return
    if form is not None:
        say("\n".join(operators_as(learned, form)))
        return
    if why is not None:
        if picture is not None:
            from symskill_pddl.cli.picture import draw_predicate

            draw_predicate(learned, why, checked_output(picture, DRAWING, force=force, inputs=[library]))
            remark(f"{picture}: drawn")
        reasons = reasons_of(learned, why)
        if json:
            emit_json(reasons.document)
        else:
            say("\n".join(reasons.lines))
        return
    if json:
        emit_json(views.library_json(learned))
        return
    for title, columns, rows in views.library_tables(learned):
        table(title, columns, rows)
        say()
