"""How learning holds up: few demonstrations, things standing about, pose noise, approaches done again; scored against the truth.

    python benchmarks/learning.py [FILES...] [--record] [--draws 5] [-o docs/benchmarks-learning.md]

Learns all tasks together from demonstrations drawn out of the files (the shipped ones), one factor changed at a time, and
compares with the truth that the recorder wrote beside them. `--record` records the kitchen's tasks anew, with their truth.
Skills are left out: they are scored in benchmarks/skills.py.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from symskill_pddl.cli.work import shipped_demos
from symskill_pddl.demos import Demo, Truth, load_demos, load_truths
from symskill_pddl.demos.perturb import with_approaches_again, with_distractors, with_noise
from symskill_pddl.errors import InputError
from symskill_pddl.evaluation.score import Score, score
from symskill_pddl.evaluation.statistics import wilson
from symskill_pddl.files import write_atomic
from symskill_pddl.learning import learn_symbols
from symskill_pddl.report.svg import Chart, Line, charts_svg

Shown = tuple[Demo, Truth]
BOUNDARY_S = 0.15
"""Boundaries nearer than this to the truth count as right."""


@dataclass(frozen=True)
class Setting:
    """Demonstrations per task, and what is done to them."""

    demos: int = 5
    distractors: int = 0
    noise_cm: float = 0.0
    approaches: int = 0


BASE = Setting()
FACTORS: dict[str, tuple[str, tuple[Setting, ...]]] = {
    "demos": ("demonstrations of each task", tuple(replace(BASE, demos=n) for n in (1, 2, 3, 5, 10))),
    "distractors": ("things standing about", tuple(replace(BASE, distractors=n) for n in range(6))),
    "noise_cm": ("pose noise [cm]", tuple(replace(BASE, noise_cm=s) for s in (0.0, 0.5, 1.0, 1.5, 2.0))),
    "approaches": ("repeated approaches", tuple(replace(BASE, approaches=n) for n in (0, 1, 2))),
}
ALL_AT_ONCE = (Setting(5, 3, 0.5, 2), Setting(5, 5, 1.0, 2), Setting(1, 3, 0.5, 2))
COLUMNS = ("movers", "references", f"boundaries within {BOUNDARY_S:g} s", "operators", "tasks")


@dataclass(frozen=True)
class Result:
    """The scores of all draws of one setting."""

    setting: Setting
    scores: tuple[Score, ...]

    def counts(self, what: str) -> tuple[int, int]:
        """How many are right, of how many, over all draws."""
        pairs = {
            "movers": [s.movers for s in self.scores],
            "references": [s.references for s in self.scores],
            COLUMNS[2]: [(round(s.within(BOUNDARY_S) * 2 * s.found), 2 * s.moves) for s in self.scores],
            "operators": [(sum(s.operators.values()), len(s.operators)) for s in self.scores],
            "tasks": [(sum(s.tasks.values()), len(s.tasks)) for s in self.scores],
        }[what]
        return sum(right for right, _ in pairs), sum(of for _, of in pairs)

    def errors(self) -> tuple[float, float]:
        """Median and 95 % quantile of the boundaries' distances from the truth [s]."""
        errors = np.abs([e for s in self.scores for e in s.boundary_errors_s])
        return float(np.median(errors)), float(np.quantile(errors, 0.95))

    def spread(self, what: str) -> tuple[float, float, float]:
        """Mean, least and largest precision or recall of the draws."""
        values = [getattr(s, what) for s in self.scores]
        return float(np.mean(values)), min(values), max(values)


def measured(shown: dict[str, Sequence[Shown]], setting: Setting, draws: int) -> Result:
    """Learn from `draws` draws of demonstrations; predicates are judged on all demonstrations as they were recorded."""
    unseen = [pair for pairs in shown.values() for pair in pairs]
    scores = []
    for draw in range(draws):
        rng = np.random.default_rng([draw, 7])
        chosen: list[Shown] = []
        for task in sorted(shown):
            for i in sorted(rng.permutation(len(shown[task]))[: setting.demos].tolist()):
                chosen.append(changed(*shown[task][i], setting, np.random.default_rng([draw, i, len(chosen)])))
        found = learn_symbols([demo for demo, _ in chosen])
        scores.append(score(found, {demo.where: truth for demo, truth in chosen}, unseen))
    return Result(setting, tuple(scores))


def changed(demo: Demo, truth: Truth, setting: Setting, rng: np.random.Generator) -> Shown:
    """One demonstration, made as hard as the setting says."""
    demo, truth = with_approaches_again(demo, truth, setting.approaches)
    demo, truth = with_distractors(demo, truth, setting.distractors, rng)
    return with_noise(demo, truth, setting.noise_cm / 100.0, rng) if setting.noise_cm else (demo, truth)


def rows(results: Sequence[Result], draws: int) -> Iterator[str]:
    """The table."""
    yield (
        "| demonstrations | standing about | noise [cm] | approaches again | "
        + " | ".join(COLUMNS)
        + (" | boundary error [s], median, 95 % | precision | recall | found nothing, made up |")
    )
    yield "|" + "---|" * (len(COLUMNS) + 8)
    for r in results:
        s = r.setting
        cells = [str(s.demos), str(s.distractors), f"{s.noise_cm:g}", str(s.approaches)]
        for what in COLUMNS:
            right, of = r.counts(what)
            low, high = wilson(right, of)
            cells.append(f"{100 * right / of:.1f} % ({100 * low:.0f}-{100 * high:.0f})")
        cells.append("{:.2f}, {:.2f}".format(*r.errors()))
        cells += ["{:.3f} ({:.3f}-{:.3f})".format(*r.spread(what)) for what in ("precision", "recall")]
        missed = sum(x.moves - x.found for x in r.scores) / draws
        cells.append(f"{missed:.1f}, {sum(x.spurious for x in r.scores) / draws:.1f}")
        yield "| " + " | ".join(cells) + " |"


def figure(by_setting: dict[Setting, Result]) -> str:
    """A chart for every factor."""
    charts = []
    for name, (label, settings) in FACTORS.items():
        results = [by_setting[s] for s in settings]
        lines = []
        for what in COLUMNS[1:]:
            pairs = [r.counts(what) for r in results]
            lines.append(Line(what, tuple(a / b for a, b in pairs), tuple(wilson(a, b) for a, b in pairs)))
        for what in ("precision", "recall"):
            spreads = [r.spread(what) for r in results]
            lines.append(Line(f"predicates: {what}", tuple(m for m, _, _ in spreads), tuple((a, b) for _, a, b in spreads)))
        ticks = tuple(f"{getattr(s, name):g}" for s in settings)
        fixed = "" if name == "demos" else f", {BASE.demos} demonstrations"
        charts.append(Chart(f"{label}{fixed}", label, ticks, tuple(lines), low=0.5))
    return charts_svg(charts)


def page(results: Sequence[Result], tasks: Sequence[str], draws: int, command: str, picture: str) -> str:
    """The document."""
    lines = [
        "# How learning holds up",
        "",
        f"Written by `{command}`: {len(tasks)} tasks learned together",
        f"({', '.join(tasks)}),",
        f"{draws} draws of demonstrations for every setting, one factor changed at a time, then several at once. The truth comes",
        "from the simulator: contacts say what the hand moved and what things rest on, poses say when; learning sees neither. In",
        "brackets: Wilson's 95 % interval over all draws (which share demonstrations), for precision and recall the least and",
        "the largest of the draws.",
        "",
        "- **movers, references**: of all moves the object that the hand moved; of all resting places what the object rested at.",
        f"- **boundaries**: of all starts and stops of moves, those that learning finds within {BOUNDARY_S:g} s.",
        "- **operators, tasks**: of the operators that a person would write, those learned as one operator with the right add",
        "  and delete effects; of the tasks, those all of whose operators are.",
        "- **precision, recall**: over every sample of every recorded demonstration, what the learned predicates say of what the",
        "  judges say (open, shut, lying on or in).",
        "- **found nothing, made up**: moves without an episode, episodes without a move, per draw.",
        "- **noise**: every object's tracker is off by a constant of this standard deviation per axis (and 1.1 degrees per",
        "  centimetre), drawn for each demonstration, and by 5 % of it from sample to sample.",
        "- **standing about**: things of the scene's types and of others, put on what things lie on, nowhere in the way.",
        "- **approaches again**: the hand goes back the way it came for 1.2 s and comes again.",
        "",
        f"![learning curves]({picture})",
        "",
    ]
    return "\n".join([*lines, *rows(results, draws)]) + "\n"


def recorded(tasks: Sequence[str], n: int) -> dict[str, Sequence[Shown]]:
    """Demonstrations of the kitchen, made now."""
    from symskill_pddl.kitchen.record import record_with_truth

    shown: dict[str, Sequence[Shown]] = {}
    for task in tasks:
        demos, truths = record_with_truth(task, n, 0)
        shown[task] = [(replace(demo, source=task), truths[demo.name]) for demo in demos]
        print(f"recorded {task}", flush=True)
    return shown


def loaded(files: Sequence[Path]) -> dict[str, Sequence[Shown]]:
    """Demonstrations with the truth that lies beside them."""
    shown: dict[str, Sequence[Shown]] = {}
    for file in files:
        truths = load_truths(file)
        if not truths:
            raise InputError(f"'{file}' holds no truth to compare with; use --record, or record it with 'symskill record'")
        shown[file.stem] = [(demo, truths[demo.name]) for demo in load_demos(file)]
    return shown


def main() -> None:
    """Learn, compare, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--record", action="store_true", help="record the kitchen's atomic tasks anew, ten times each")
    parser.add_argument("--draws", type=int, default=5)
    parser.add_argument("-o", "--output", type=Path, default=Path("docs/benchmarks-learning.md"))
    args = parser.parse_args()
    if args.record:
        from symskill_pddl.evaluation.suite import of_kind
        from symskill_pddl.kitchen.arena import ARENA

        shown = recorded(of_kind(ARENA, "atomic"), 10)
    else:
        # one unsegmented recording of play is no task of which demonstrations could be drawn
        shown = {task: pairs for task, pairs in loaded(args.files or shipped_demos()).items() if len(pairs) > 1}
    settings = dict.fromkeys([*(s for _, many in FACTORS.values() for s in many), *ALL_AT_ONCE])
    results = {}
    for setting in settings:
        begun = time.perf_counter()
        results[setting] = measured(shown, setting, args.draws)
        print(f"{setting}: operators {results[setting].counts('operators')}, {time.perf_counter() - begun:.0f} s", flush=True)
    picture = args.output.with_suffix(".svg")
    command = "python benchmarks/learning.py" + (" --record" if args.record else "") + f" --draws {args.draws}"
    write_atomic(picture, figure(results).encode())
    write_atomic(args.output, page(list(results.values()), sorted(shown), args.draws, command, picture.name).encode())


if __name__ == "__main__":
    main()
