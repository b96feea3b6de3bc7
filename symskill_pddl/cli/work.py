"""Steps that several commands take: loading what a user named, and saying how long it takes."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from symskill_pddl.cli.console import progress
from symskill_pddl.cli.options import output
from symskill_pddl.errors import FormatError, InputError
from symskill_pddl.files import DOMAIN, NAMES, PAGE, PROBLEM, Kind, make_folder, remove_empty, sealed
from symskill_pddl.reading import parse_json, read_text

JOBS = max(1, min(os.cpu_count() or 1, 8))
"""Processes that fit skills side by side; the result is the same with any number."""

if TYPE_CHECKING:
    from symskill_pddl.demos import Demo
    from symskill_pddl.evaluation.moment import Moment
    from symskill_pddl.execution.config import ExecutionConfig
    from symskill_pddl.learning import LearnConfig, LearnReport
    from symskill_pddl.learning.vision import VisionSelector
    from symskill_pddl.library import Experience, Library
    from symskill_pddl.pddl import Names, Task
    from symskill_pddl.pddl.check import Comparison
    from symskill_pddl.symbols import Domain, Plan, Problem


def open_library(path: Path) -> Library:
    """The library of a folder."""
    from symskill_pddl.library import Library

    return Library.load(path)


def check_replaced(folder: Path, files: Sequence[Path], *, force: bool) -> None:
    """Find out before the work that a library must not be written here, or would take away what it is learned from."""
    from symskill_pddl.library_io import SHAPE

    SHAPE.check(folder)
    if not SHAPE.holds(folder):
        return
    if not force:
        raise InputError(f"'{folder}' holds a library already: --into adds to it, --force replaces it")
    for file in files:
        if file.resolve().is_relative_to(folder.resolve()):
            raise InputError(f"'{file}' lies in the library '{folder}', which would be replaced: copy it to another place first")


def learn_from(
    files: Sequence[Path],
    folder: Path,
    *,
    into: bool = False,
    replace: bool = True,
    selector: VisionSelector | None = None,
    config: LearnConfig | None = None,
) -> tuple[Library, LearnReport]:
    """Learn from files of demonstrations, and save the library when all went well; nobody else writes it meanwhile.

    `into`: there is a library in `folder`; learn from its demonstrations too. `replace`: another one that is there may be
    replaced. `selector` chooses references. The hints of a library that is added to stay, as far as `config` has no others.
    """
    from symskill_pddl.demos import load_demos
    from symskill_pddl.learning import LearnConfig
    from symskill_pddl.library_io import writing

    if len({f.stem for f in files}) != len(files):
        raise InputError(f"two files have one name, demonstrations could not be told apart: {', '.join(map(str, files))}")
    demos: list[Demo] = []
    for file in files:
        demos += load_demos(file)
    if into:
        open_library(folder)  # where there is none nothing is made
    with writing(folder, replace=into or replace) as save:
        library, report = _learned(demos, open_library(folder) if into else None, selector, config or LearnConfig())
        save(library)
    return library, report


def _learned(
    demos: list[Demo], old: Library | None, selector: VisionSelector | None, config: LearnConfig
) -> tuple[Library, LearnReport]:
    from symskill_pddl.learning import added, learn_reported

    if old is not None:
        demos, config = list(added(old, demos)), config.with_older_hints(old.hints)
    title = f"learning from {len(demos)} demonstrations in {len({d.source for d in demos})} files"
    with progress(title) as advance:
        library, report = learn_reported(
            demos, config, jobs=JOBS, progress=lambda stage: advance(text=f"{title}: {stage}"), selector=selector
        )
    if old is not None:
        from symskill_pddl.execution.experience import with_experience

        library = with_experience(library, {o.operator.name: o.experience for o in old.operators}, old.runs)
    return library, report


def vision_selector(name: str, url: str | None, cache: Path | None, *, insecure: bool = False) -> VisionSelector:
    """References by the model ``openai:MODEL`` or ``gemini:MODEL``; its answers are kept in a folder of the user's cache."""
    from symskill_pddl.learning.vision import Asker, VisionSelector, endpoint_named

    endpoint = endpoint_named(name, url, insecure=insecure)
    if cache is None:
        try:
            home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
        except RuntimeError:
            raise InputError(
                "there is no home folder to keep the model's answers in; say where with --references-cache"
            ) from None
        cache = home / "symskill" / "references"
    # found out before an answer is paid for that cannot be kept
    make_folder(cache)
    return VisionSelector(Asker(endpoint, cache=cache))


@dataclass(frozen=True)
class Runs:
    """What recorded runs say together."""

    checksums: tuple[str, ...]
    experience: Mapping[str, Experience]


def read_runs(files: Sequence[Path]) -> Runs:
    """Count what happened in recorded runs; raises `InputError` where one is no run, had no monitor, or is given twice."""
    from hashlib import sha256

    from symskill_pddl.execution.experience import experience_of
    from symskill_pddl.execution.trace import read_trace
    from symskill_pddl.library import Experience

    checksums: list[str] = []
    total: dict[str, Experience] = {}
    for file in files:
        trace = read_trace(file)
        checksums.append(sha256(file.read_bytes()).hexdigest()[:16])
        if checksums[-1] in checksums[:-1]:
            raise InputError(f"{file}: the same run as another one: every run counts once")
        try:
            found = experience_of(trace)
        except InputError as error:
            raise InputError(f"{file}: {error}") from None
        for name, experience in found.items():
            total[name] = total.get(name, Experience()) + experience
    return Runs(tuple(checksums), total)


def learn_costs(runs: Runs, folder: Path) -> tuple[Library, tuple[str, ...]]:
    """Add runs to a library and save it; also the names of steps that are no operators of it."""
    from symskill_pddl.execution.experience import with_experience
    from symskill_pddl.library_io import writing

    open_library(folder)  # where there is none nothing is made
    with writing(folder) as save:
        library = with_experience(open_library(folder), runs.experience, runs.checksums)
        save(library)
    known = {o.operator.name for o in library.operators}
    return library, tuple(name for name in sorted(runs.experience) if name not in known)


def shipped_demos() -> tuple[Path, ...]:
    """The demonstrations of the kitchen that come with the package."""
    import symskill_pddl

    folder = Path(symskill_pddl.__file__).parent / "data" / "kitchen"
    files = tuple(sorted(folder.glob("*.hdf5")))
    if not files:
        raise InputError(f"the package has no demonstrations in '{folder}'; record some with: symskill record TASK -o FILE")
    return files


def renames(path: Path | None) -> dict[str, str]:
    """The ``--names`` file."""
    from symskill_pddl.pddl import load_renames

    return load_renames(path) if path is not None else {}


def forms(domain: Domain, dialect: str, folder: Path) -> tuple[tuple[str, Path], ...]:
    """Dialects to write, and where; ``all`` puts the plainest that can say the domain into the folder, the others below it."""
    from symskill_pddl.pddl import expressible

    if dialect != "all":
        return ((dialect, folder),)
    first, *others = expressible(domain)
    return ((first, folder), *((other, folder / other) for other in others))


File = tuple[Path, Kind, bytes]
"""Where a file goes, what it is, and its content."""


def write_all(files: Sequence[File], *, force: bool, inputs: Iterable[Path | None] = ()) -> None:
    """Write files that belong together, and their folders: all of them, or none if one of them must not be replaced."""
    made = [folder for path, _, _ in files for folder in make_folder(path.parent)]
    try:
        outputs = [(output(path, kind, force=force, inputs=inputs), content) for path, kind, content in files]
    except InputError:
        remove_empty(made)
        raise
    with ExitStack() as stack:
        for file, content in outputs:
            stack.enter_context(file.draft()).write_bytes(content)


def exported_domain(
    library: Library, folder: Path, name: str, dialect: str, renamed: dict[str, str], *, strict: bool = False
) -> tuple[Domain, tuple[File, File]]:
    """The domain as it stands in the text, and what domain.pddl and names.json hold."""
    from symskill_pddl.describe import domain_comments
    from symskill_pddl.pddl import Names, write_domain

    domain = library.domain(name, strict=strict)
    names = Names.of(domain, renames=renamed)
    ids = {**names.types, **names.predicates, **names.operators}
    text = write_domain(
        names.domain(domain),
        dialect=dialect,
        comments={ids.get(key, key): value for key, value in domain_comments(library).items()},
        header=(
            "Learned from demonstrations by symskill. What a predicate means geometrically stands above it.",
            "This file may be edited by hand; `symskill check` says what an edit means.",
        ),
    )
    beside = (folder / "names.json", NAMES, names.dumps().encode())
    return names.domain(domain), ((folder / "domain.pddl", DOMAIN, sealed(text)), beside)


def moment_problem(library: Library, text: str, goal: str | None, goal_at: str | None, name: str) -> tuple[Moment, list[str]]:
    """The problem of a moment of a recording, and what its file says of it."""
    from symskill_pddl.evaluation.moment import Address, at_time, find_demo, problem_at, sample_at

    address = Address.parse(text)
    demo = find_demo(address)
    index = sample_at(demo, address.at_s)
    goal_index = None if goal_at is None else sample_at(demo, at_time(goal_at, goal_at))
    moment = problem_at(library, library.domain(name), demo, index, goal, goal_index)
    return moment, [f"{demo.where} at {demo.times[index] - demo.times[0]:g} s", *moment.notes]


def exported_problem(
    problem: Problem, domain: Domain, path: Path, dialect: str, renamed: dict[str, str], header: Sequence[str]
) -> tuple[File, File]:
    """What the file of a problem of a library's domain holds, and that of its names beside it."""
    from symskill_pddl.pddl import Names, write_problem

    names = Names.of(domain, problem.object_types, renames=renamed)
    text = write_problem(names.problem(problem), names.domain(domain), dialect=dialect, header=header)
    return (path, PROBLEM, sealed(text)), (path.with_suffix(".names.json"), NAMES, names.dumps().encode())


def read_domain_file(path: Path) -> Domain:
    """A PDDL domain."""
    from symskill_pddl.pddl import read_domain

    return read_domain(read_text(path, "domain"), str(path))


def names_beside(path: Path) -> Names | None:
    """The side-car of an exported file (``names.json`` of a domain, ``problem.names.json`` of a problem), if it is there."""
    from symskill_pddl.pddl import load_names

    beside = path.with_suffix(".names.json")
    candidates = (beside, path.with_name("names.json"))
    return next((load_names(candidate) for candidate in candidates if candidate.is_file()), None)


def compared(learned: Domain, edited: Domain, names: Names | None, dialect: str | None) -> Comparison:
    """Compare with the learned domain in the dialect given, else in the one in which least is wrong."""
    from symskill_pddl.pddl import DIALECTS
    from symskill_pddl.pddl.check import Severity, compare

    if dialect is not None:
        return compare(learned, edited, dialect=dialect, names=names)
    found: list[Comparison] = []
    for form in DIALECTS:
        try:
            found.append(compare(learned, edited, dialect=form, names=names))
        except InputError:  # the learned domain cannot be said in this dialect
            continue

    def wrong(comparison: Comparison) -> tuple[int, int]:
        return sum(f.severity is Severity.ERROR for f in comparison.findings), len(comparison.findings)

    return min(found, key=wrong)


def read_problem_file(path: Path, domain: Domain) -> Problem:
    """A PDDL problem of a domain."""
    from symskill_pddl.pddl import read_problem

    return read_problem(read_text(path, "problem"), domain, str(path))


def read_task_files(domain: Path, problem: Path) -> Task:
    """A domain and a problem as somebody wrote them."""
    from symskill_pddl.pddl import read_task

    return read_task(read_text(domain, "domain"), read_text(problem, "problem"), str(domain), str(problem))


def read_plan_file(path: Path, domain: Domain, problem: Problem) -> tuple[Plan, tuple[str, ...]]:
    """A plan of a problem, or what a planner printed with one in it; and what is to be said of it."""
    from symskill_pddl.pddl import read_plans

    read = read_plans(read_text(path, "plan"), domain, problem.object_types, str(path))[-1]
    return read.plan, read.remarks


def open_edited(path: Path, domain: Path | None) -> Library:
    """The library of a folder; under an edited domain if there is one."""
    return open_library(path) if domain is None else edit(open_library(path), domain)[0]


def open_unchanged(path: Path, domain: Path | None, checksum: str) -> Library:
    """As `open_edited`, if it is still the library and the domain of that checksum."""
    library = open_edited(path, domain)
    if checksum_of(path, domain) != checksum:
        raise InputError(f"'{path}' is not the library any more that it was when this began; begin anew")
    return library


def edit(library: Library, path: Path) -> tuple[Library, Domain, Comparison]:
    """The library under an edited domain, the domain as it stands in the file, and what was changed.

    Raises `InputError` where an action has no skill that does what it says, or needs what cannot be seen.
    """
    from symskill_pddl.execution.edited import edited_library
    from symskill_pddl.pddl.edit import undone

    written = read_domain_file(path)
    learned = library.domain(written.name)
    comparison = compared(learned, written, names_beside(path), None)
    try:
        return edited_library(library, undone(comparison, learned, written)), written, comparison
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def posed_problem(path: Path, written: Domain, comparison: Comparison) -> Problem:
    """A problem of an edited domain, under the library's names: objects by the problem's side-car, all else by the domain's."""
    beside = names_beside(path)
    back = comparison.names.inverse()
    if beside is not None:
        back = back.model_copy(update={"objects": beside.inverse().objects})
    return back.problem(read_problem_file(path, written))


def execution_config(*, no_resampling: bool, no_replanning: bool, no_tracking: bool, no_obstacles: bool) -> ExecutionConfig:
    """The settings of an execution with some of its mechanisms switched off."""
    from symskill_pddl.execution.config import ExecutionConfig, MotionConfig

    motion = MotionConfig(track=not no_tracking, avoid=not no_obstacles)
    return ExecutionConfig(resample=not no_resampling, replan=not no_replanning, motion=motion)


def checksum_of(folder: Path, domain: Path | None = None) -> str:
    """Tells one library from another: of library.json, which holds the checksums of all other files, and of an edited domain."""
    from hashlib import sha256

    found = sha256((folder / "library.json").read_bytes())
    if domain is not None:
        found.update(read_text(domain, "domain").encode())
    return found.hexdigest()


def write_report(source: Path, path: Path, library: Library | None = None, *, force: bool = False) -> None:
    """A page from a trace or from a results file, whichever `source` is."""
    from symskill_pddl.report import results_page, run_page

    if is_results(source):
        from symskill_pddl.evaluation.ablations import switched_off
        from symskill_pddl.evaluation.results import load_results
        from symskill_pddl.report.results import ResultRow

        results = load_results(source)
        rows = [
            ResultRow(
                task=task.task,
                trials=task.trials,
                successes=task.successes,
                interval=task.interval,
                failures=task.failures,
                times={
                    "median time [s]": "-" if task.median_time_s is None else f"{task.median_time_s:.1f}",
                    "new plans per run": f"{task.mean_replans:.1f}",
                    "recoveries per run": f"{task.mean_recoveries:.1f}",
                    "troubles in steps": ", ".join(f"{cause} {n}" for cause, n in task.troubles.items()) or "-",
                },
            )
            for task in results.tasks
        ]
        settings = results.settings
        facts = (
            ("world", settings.world),
            ("seeds", f"{settings.seed} to {settings.seed + settings.trials - 1}"),
            ("planner", settings.planner),
            ("switched off", ", ".join(switched_off(settings)) or "nothing"),
            ("disturbances", ", ".join(settings.disturbances) or "none"),
            ("intervals", f"Wilson, {100 * results.confidence:.0f} %"),
            ("library", settings.library),
        )
        page = results_page(rows, facts=facts)
    else:
        from symskill_pddl.execution.trace import read_trace

        page = run_page(read_trace(source), library)
    output(path, PAGE, force=force, inputs=[source]).write(page.encode())


def is_results(path: Path) -> bool:
    """Whether a file is one JSON object that calls itself results; everything else is taken for a trace."""
    try:
        document = parse_json(read_text(path, "trace or results file"), str(path))
    except FormatError:
        return False
    return isinstance(document, dict) and "event" not in document
