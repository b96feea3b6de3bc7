"""The readers that are fuzzed, by name: for each a folder of files that are right, and the call that reads it."""

from __future__ import annotations

import gzip
import hashlib
import json
import re
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent.parent
DATA = ROOT / "tests" / "data"


def _nothing(_: Path) -> None:
    pass


@dataclass(frozen=True)
class Reader:
    """`read` may raise children of `SymSkillError` only; `repair` makes checksums right after something was changed."""

    seed: Callable[[Path], None]
    read: Callable[[Path], object]
    repair: Callable[[Path], None] = _nothing


def quiet(_: str) -> None:
    """Takes remarks."""


# ------------------------------------------------------------------------------------------------------------------- PDDL


def _kitchen_pddl(folder: Path) -> None:
    shutil.copy(ROOT / "domains" / "kitchen" / "domain.pddl", folder)
    shutil.copy(ROOT / "domains" / "kitchen" / "names.json", folder)
    shutil.copy(sorted((ROOT / "problems" / "kitchen").glob("*.pddl"))[0], folder / "problem.pddl")
    (folder / "plan.txt").write_text(
        "; by hand\n0.000: (reach-door-closed door-1 cabinet-1) [1.0]\n1.0: (open-door door-1 cabinet-1)\n; cost = 2 (unit)\n"
    )


def _kept(*names: str) -> Callable[[Path], None]:
    def seed(folder: Path) -> None:
        _kitchen_pddl(folder)
        for path in folder.iterdir():
            if path.name not in names:
                path.unlink()

    return seed


KITCHEN = ROOT / "domains" / "kitchen" / "domain.pddl"


def _task(domain: Path, problem: Path) -> None:
    from symskill_pddl.cli.work import read_domain_file, read_problem_file, read_task_files
    from symskill_pddl.errors import SymSkillError
    from symskill_pddl.pddl import Names

    for then in (
        lambda: read_task_files(domain, problem),
        lambda: Names.of(read_domain_file(domain)),
        lambda: read_problem_file(problem, read_domain_file(domain)),
    ):
        try:
            then()
        except SymSkillError:
            continue


def _domain(folder: Path) -> None:
    _task(folder / "domain.pddl", sorted((ROOT / "problems" / "kitchen").glob("*.pddl"))[0])


def _problem(folder: Path) -> None:
    _task(KITCHEN, folder / "problem.pddl")


def _plan(folder: Path) -> None:
    from symskill_pddl.cli.work import read_domain_file, read_plan_file, read_problem_file

    there = ROOT / "problems" / "kitchen"
    domain = read_domain_file(KITCHEN)
    problem = read_problem_file(sorted(there.glob("*.pddl"))[0], domain)
    read_plan_file(folder / "plan.txt", domain, problem)


def _names(folder: Path) -> None:
    from symskill_pddl.cli.work import compared, names_beside, read_domain_file, renames

    learned = read_domain_file(KITCHEN)
    names = names_beside(folder / "domain.pddl")
    compared(learned, learned, names, None)
    renames(folder / "renames.json")


def _seed_names(folder: Path) -> None:
    _kept("names.json")(folder)
    (folder / "renames.json").write_text('{"renames": {"open-door": "pull-door", "food": "thing"}}')


# ------------------------------------------------------------------------------------------------------------ recordings


def _seed_demos(folder: Path) -> None:
    from symskill_pddl.demos import load_demos, save_demos
    from symskill_pddl.demos.truth import load_truths

    source = ROOT / "symskill_pddl" / "data" / "kitchen" / "OpenDrawer.hdf5"
    first = load_demos(source)[0]
    save_demos(folder / "demos.hdf5", [first], {n: t for n, t in load_truths(source).items() if n == first.name})


def _demos(folder: Path) -> None:
    from symskill_pddl.demos import load_demos
    from symskill_pddl.demos.truth import load_truths

    load_demos(folder / "demos.hdf5")
    load_truths(folder / "demos.hdf5")


def _no_checksum(folder: Path) -> None:
    """What is changed is read, and not found out by the checksum."""
    import h5py

    path = folder / "demos.hdf5"
    if path.is_file() and not path.is_symlink():
        try:
            with h5py.File(path, "r+") as file:
                file["data"].attrs.pop("checksum", None)
        except (OSError, KeyError, RuntimeError, AttributeError, ValueError, TypeError):
            pass


def _seed_robosuite(folder: Path) -> None:
    shutil.copy(DATA / "robosuite" / "panda_door.hdf5", folder)
    shutil.copy(DATA / "robosuite" / "panda_door_model_1.xml", folder)


def _robosuite(folder: Path) -> None:
    from symskill_pddl.demos import import_robosuite

    import_robosuite(folder / "panda_door.hdf5", remark=quiet)


def _seed_robocasa(folder: Path) -> None:
    (folder / "demo.hdf5").write_bytes(gzip.decompress((DATA / "robocasa" / "demo.hdf5.gz").read_bytes()))


def _robocasa(folder: Path) -> None:
    from symskill_pddl.robocasa.recordings import import_robocasa, is_robocasa

    is_robocasa(folder / "demo.hdf5")
    import_robocasa(folder / "demo.hdf5", remark=quiet)


def _seed_lerobot(folder: Path) -> None:
    shutil.copytree(DATA / "robocasa" / "lerobot", folder / "dataset")
    for path in folder.rglob("*000001*"):
        if path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink()


def _lerobot(folder: Path) -> None:
    from symskill_pddl.robocasa.recordings import import_robocasa, is_robocasa

    is_robocasa(folder / "dataset")
    import_robocasa(folder / "dataset", remark=quiet)


def _seed_model(folder: Path) -> None:
    shutil.copy(DATA / "robosuite" / "panda_door_model_1.xml", folder / "model.xml")


def _model(folder: Path) -> None:
    import numpy as np

    from symskill_pddl.demos.replay import KinematicModel
    from symskill_pddl.reading import read_text

    model = KinematicModel(read_text(folder / "model.xml", "model"))
    model.replay(np.zeros((2, model.state_size)))


# -------------------------------------------------------------------------------------------------------------- libraries


def _seed_library(folder: Path) -> None:
    from symskill_pddl.demos import load_demos
    from symskill_pddl.learning import learn

    demos = load_demos(ROOT / "symskill_pddl" / "data" / "kitchen" / "OpenDrawer.hdf5")[:2]
    learn(demos).save(folder / "library")


def _library(folder: Path) -> None:
    from symskill_pddl.cli import views
    from symskill_pddl.cli.work import open_library
    from symskill_pddl.demos import decode_demos

    library = open_library(folder / "library")
    views.library_json(library)
    list(views.library_tables(library))
    for name, content in library.recordings.items():
        decode_demos(content, name)


def _right_sums(folder: Path) -> None:
    """Files of a library that were changed are listed with their new checksums, so that they are read."""
    index = folder / "library" / "library.json"
    if not index.is_file() or index.is_symlink():
        return
    text = index.read_text("utf-8", "replace")
    for path in folder.rglob("*.*"):
        if path.is_file() and not path.is_symlink() and path.suffix in (".npz", ".hdf5"):
            found = hashlib.sha256(path.read_bytes()).hexdigest()
            text = re.sub(rf'("file": "{re.escape(path.name)}",\s*"sha256": ")[^"]*', rf"\g<1>{found}", text)
    index.write_bytes(text.encode("utf-8", "replace"))


# -------------------------------------------------------------------------------------------------------- runs and results


def _seed_trace(folder: Path) -> None:
    from symskill_pddl.execution.lines import Header, NoteLine, OutcomeLine, PlanLine, RecoveryLine, step_line, tick_line
    from symskill_pddl.execution.monitor import Continue, EffectsHold, Tick, Watch
    from symskill_pddl.execution.trace import TraceWriter
    from symskill_pddl.symbols import Atom, GroundOperator

    at, held = frozenset({Atom("at", ("cup", "tray"))}), frozenset({Atom("held", ("cup",))})
    step = GroundOperator("pick", ("cup", "tray"), at, held, at, frozenset(), frozenset(), 2.5)
    watch = Watch(
        step, 0, (step,), frozenset({"held"}), 0.1, at, frozenset(), frozenset(), 1, 0.5, 10.0, 1.0, 0.5, 2.0, 0.01, 0.05
    )
    with TraceWriter(folder / "trace.jsonl") as trace:
        trace.write(Header(task="Tidy", seed=3, goal=(("held", "cup"),), objects={"cup": "cup", "tray": "tray"}))
        plan = (("pick", ("cup", "tray")),)
        trace.write(PlanLine(time=0.0, reason="start", status="solved", steps=plan, state=(("at", "cup", "tray"),)))
        trace.write(step_line(watch, Continue("begin"), attempt=0, shift=None))
        for i, state in enumerate((at, at, held)):
            tick = Tick(0.1 * i + 0.2, state, 0, 0.1 * i, False, False, 0.1, 0.1, 0.0)
            verdict = EffectsHold("done") if state is held else Continue("on its way")
            trace.write(tick_line(tick, at, verdict, {"skill": 0.1}))
        trace.write(RecoveryLine(time=0.5, name="lift", reason="stuck", result="done"))
        trace.write(NoteLine(time=0.6, text="somebody came by"))
        trace.write(OutcomeLine(time=1.0, success=True, category="success", reason="goal", replans=0, recoveries=1))


def _trace(folder: Path) -> None:
    from symskill_pddl.cli.replay import moments
    from symskill_pddl.cli.work import read_runs, write_report
    from symskill_pddl.errors import SymSkillError
    from symskill_pddl.execution.replay import replay
    from symskill_pddl.execution.trace import read_trace

    path = folder / "trace.jsonl"
    trace = read_trace(path)
    for then in (
        lambda: json.dumps([m.document() for m in moments(trace, replay(trace), every=True)], allow_nan=False),
        lambda: write_report(path, folder / "page.html"),
        lambda: read_runs([path]),
    ):
        try:
            then()
        except SymSkillError:
            continue


def _seed_results(folder: Path) -> None:
    from symskill_pddl.evaluation.results import EpisodeResult, Results, Settings, summarise

    fields: dict[str, Any] = {"category": "success", "reason": "", "time_s": 3.0, "replans": 0, "recoveries": 0}
    episodes = [EpisodeResult.model_validate(_filled(EpisodeResult, {**fields, "seed": i, "success": i > 0})) for i in range(2)]
    settings = Settings.model_validate(
        {"library": "abc", "planner": "auto", "monitor": True, "disturbances": ["close-door@op=2"], "seed": 0, "trials": 2}
    )
    results = Results(settings=settings, tasks=(summarise("Tidy", episodes),))
    (folder / "results.json").write_text(results.dumps())


def _filled(model: Any, fields: dict[str, Any]) -> dict[str, Any]:
    """The fields, and something plain for each other one that is needed."""
    plain = {int: 0, float: 0.0, str: "", bool: False}
    needed = {name: plain.get(f.annotation, ()) for name, f in model.model_fields.items() if f.is_required()}
    return {**needed, **{k: v for k, v in fields.items() if k in model.model_fields}}


def _results(folder: Path) -> None:
    from symskill_pddl.cli.work import write_report

    write_report(folder / "results.json", folder / "page.html")


# ------------------------------------------------------------------------------------------------- words on the command line


def _seed_words(folder: Path) -> None:
    lines = (
        "close-door@op=2",
        "push:30N,0.3s@t=1.5",
        "move:5cm,cheese@p=0.01x2",
        "(food-on-plate cheese plate-1) (door-closed door-1)",
    )
    (folder / "words.txt").write_text(
        "\n".join((*lines, "demos.hdf5:demo_0@2.5s", "openai:model", "http://localhost:8000/v1", "cubeA=cube"))
    )


def _lines(folder: Path) -> Iterator[str]:
    path = folder / "words.txt"
    if path.is_file() and not path.is_symlink():
        yield from path.read_text("utf-8", "replace").split("\n")


def _words(folder: Path) -> None:
    from symskill_pddl.cli.options import pairs
    from symskill_pddl.cli.work import read_domain_file
    from symskill_pddl.errors import SymSkillError
    from symskill_pddl.evaluation.moment import Address
    from symskill_pddl.evaluation.trial import stated_goal
    from symskill_pddl.kitchen.disturbances import parse_disturbance
    from symskill_pddl.learning.vision import endpoint_named

    domain = read_domain_file(KITCHEN)
    calls: tuple[Callable[[str], object], ...] = (
        parse_disturbance,
        lambda text: stated_goal(text, domain, {"cheese": "food", "door-1": "door"}),
        lambda text: pairs([text], "--type", "OBJECT=TYPE"),
        Address.parse,
        lambda text: endpoint_named(text, None, {"OPENAI_API_KEY": text}),
        lambda text: endpoint_named("openai:m", text, {}),
    )
    for line in _lines(folder):
        for call in calls:
            try:
                call(line)
            except SymSkillError:
                continue


def _seed_reply(folder: Path) -> None:
    reply = {"choices": [{"message": {"content": '{"before": "cabinet", "after": "counter"}'}}]}
    (folder / "reply.json").write_text(json.dumps(reply))


def _reply(folder: Path) -> None:
    from symskill_pddl.learning.vision import ask
    from symskill_pddl.learning.vision.endpoints import Question, endpoint_named
    from symskill_pddl.reading import read_bytes

    class Canned(ask.Asker):
        def _exchange(self, _: bytes) -> bytes:
            return content

    content = read_bytes(folder / "reply.json", "reply")
    question = Question("where?", (b"",), {"before": ("cabinet", "counter"), "after": ("cabinet", "counter")})
    for kind in ("openai", "gemini"):
        config = ask.AskConfig(attempts=1)
        try:
            Canned(endpoint_named(f"{kind}:m", "http://localhost", {}), config).ask(question)
        except ask.VisionError:
            continue


def _seed_talk(folder: Path) -> None:
    (folder / "talk.txt").write_text(
        "Number of literals: 12\n0.000: (REACH-DOOR-CLOSED DOOR-1 CABINET-1) [D:1.00; C:0.10]\n; Plan found\n"
    )


def _talk(folder: Path) -> None:
    from symskill_pddl.cli.work import read_domain_file
    from symskill_pddl.pddl.plan import read_plans
    from symskill_pddl.reading import read_text

    objects = {"door-1": "door", "cabinet-1": "cabinet"}
    read_plans(read_text(folder / "talk.txt", "output"), read_domain_file(KITCHEN), objects)


def _seed_settings(folder: Path) -> None:
    (folder / "settings.toml").write_text(
        '[relations]\ngap = 0.5\n[hints]\nleave_out = {objects = ["lamp"]}\n[hints.joints]\nblock = "free"\n'
    )


def _settings(folder: Path) -> None:
    from symskill_pddl.cli.settings import read_settings
    from symskill_pddl.errors import SymSkillError

    path = folder / "settings.toml"
    lines = path.read_text("utf-8", "replace").split("\n") if path.is_file() and not path.is_symlink() else []
    for config, hints, said in ((path, None, ()), (None, path, ()), *((None, None, (line.replace(" ", ""),)) for line in lines)):
        try:
            read_settings(config, hints, said)
        except SymSkillError:
            continue


READERS: dict[str, Reader] = {
    "domain": Reader(_kept("domain.pddl"), _domain),
    "problem": Reader(_kept("problem.pddl"), _problem),
    "plan": Reader(_kept("plan.txt"), _plan),
    "names": Reader(_seed_names, _names),
    "demos": Reader(_seed_demos, _demos, _no_checksum),
    "robosuite": Reader(_seed_robosuite, _robosuite),
    "robocasa": Reader(_seed_robocasa, _robocasa),
    "lerobot": Reader(_seed_lerobot, _lerobot),
    "model": Reader(_seed_model, _model),
    "library": Reader(_seed_library, _library, _right_sums),
    "trace": Reader(_seed_trace, _trace),
    "results": Reader(_seed_results, _results),
    "settings": Reader(_seed_settings, _settings),
    "words": Reader(_seed_words, _words),
    "reply": Reader(_seed_reply, _reply),
    "talk": Reader(_seed_talk, _talk),
}
