"""The page that `kitchen.py` writes."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from kitchen_suites import ATOMIC, FEWER, FIGURES, SHOWN, Entry, Figure

from symskill_pddl.evaluation.paired import compare
from symskill_pddl.evaluation.results import EpisodeResult, Results, TaskResult
from symskill_pddl.evaluation.statistics import wilson


@dataclass
class Measured:
    """An entry's results, and those without a mechanism."""

    entry: Entry
    results: Results
    without: dict[str, Results] = field(default_factory=dict)


def page(
    measured: Sequence[Measured], missing: Sequence[str], unfinished: Sequence[Entry], call: str, scale: float, seed: int
) -> str:
    """The whole page."""
    about = f"""
        Written by `{call}`. Libraries are learned from the shipped demonstrations, the first {SHOWN} of each atomic task where
        nothing else is said; episodes are drawn from the seeds {seed} and up. Success is the judge's word, who alone sees the
        simulator's state. Intervals are at 95 %: Wilson's of a rate, Newcombe's of a difference of paired rates; p is of
        McNemar's exact test. Times are the robot's clock, the median of the successful episodes [s]; new plans and recoveries
        are means per episode; troubles are what went wrong in steps, recovered from or not ([execution.md](execution.md)
        has the names)."""
    lines = ["# Results in the kitchen", "", *textwrap.wrap(" ".join(about.split()), 128)]
    if scale != 1.0:
        lines += ["", f"**At {scale:g} of the full number of episodes.**"]
    for figure in FIGURES:
        here = [m for m in measured if m.entry.figure == figure]
        if here or any(e.figure == figure for e in unfinished):
            lines += ["", f"## {figure.title}", "", f"Wanted: {figure.target}.", ""]
            lines += _fewer(here, measured) if figure == FEWER else _section(figure, here)
            lines += [f"Not finished: {e.name}." for e in unfinished if e.figure == figure]
    lines += _robocasa()
    lines += ["", "## Failures", "", *_failures(measured)]
    seen = SEEN / f"kitchen-{seed}.md"
    if seen.is_file():
        lines += ["", "### What they were, looked at", "", seen.read_text(encoding="utf-8").rstrip()]
    if missing:
        lines += ["", "## Not measured", "", *(f"- {text}" for text in missing)]
    lines += ["", "## Commands", "", "Each evaluation by itself, on the libraries that the benchmark leaves in its folder:", ""]
    lines += [f"    {m.entry.command(scale, seed)}" for m in measured]
    return "\n".join(lines) + "\n"


ROBOCASA = Path(__file__).parent.parent / "docs" / "results-robocasa.md"
"""The page that `robocasa_kitchens.py` writes."""
SEEN = Path(__file__).parent / "data" / "failures"
"""What people who looked at the failures of a run with a seed wrote of them."""
HEAD = (
    "| task | successes | rate | interval | time | new plans | recoveries | troubles | failures |",
    "|---|---|---|---|---|---|---|---|---|",
)


def _robocasa() -> list[str]:
    """The table of the other world, where it has been measured."""
    if not ROBOCASA.is_file():
        return []
    lines = ROBOCASA.read_text(encoding="utf-8").splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("|"))
    table = lines[first : lines.index("", first)]
    about = "Judged by RoboCasa; how, and what is different from the paper, is on [a page of its own](results-robocasa.md)."
    return ["", "## In RoboCasa, beside the paper's figures", "", about, "", *table]


def _section(figure: Figure, here: Sequence[Measured]) -> list[str]:
    lines = list(HEAD) if here else []
    for m in here:
        what = _what(m.entry)
        rows = [_row(t, t.task, what) for t in m.results.tasks]
        lines += [] if m.entry.spread and len(rows) > 1 else rows
        if len(rows) > 1:
            lines.append(_row(_together(m.results.tasks), "**all**", what))
        for mechanism, other in m.without.items():
            name = other.tasks[0].task if len(rows) == 1 else "**all**"
            lines.append(_row(_together(other.tasks), name, _named(what, f"no {mechanism}")))
    differences = [(m, mechanism, other) for m in here for mechanism, other in m.without.items()]
    if differences:
        head = "| what | successes with, without | difference | interval | p | new plans | obstacle touched [s] |"
        lines += ["", head, "|" + "---|" * 7]
    for m, mechanism, other in differences:
        d = compare(m.results, other)[-1]
        rates = f"{d.both + d.only_first}, {d.both + d.only_second} of {d.trials}"
        interval = f"{d.interval[0]:+.2f} to {d.interval[1]:+.2f}"
        one, two = _together(m.results.tasks), _together(other.tasks)
        means = f"{one.mean_replans:.1f}, {two.mean_replans:.1f} | {one.touched_s:.1f}, {two.touched_s:.1f}"
        what = _named(_what(m.entry), mechanism)
        p = f"{d.p_value:.2g}" if d.p_value > 1e-5 else "< 0.00001"
        lines.append(f"| {what} | {rates} | {d.difference:+.2f} | {interval} | {p} | {means} |")
    if differences and figure == ATOMIC:
        lines += ["", "Without the monitor, by task:", "", *HEAD]
        lines += [_row(t, t.task, "no monitor") for _, _, other in differences for t in other.tasks]
    return lines


def _fewer(here: Sequence[Measured], measured: Sequence[Measured]) -> list[str]:
    five = [m for m in measured if m.entry.figure == ATOMIC]
    lines = [
        "| demonstrations of each task | successes | mean rate | interval | least task | troubles | failures |",
        "|" + "---|" * 7,
    ]
    for m in sorted([*five, *here], key=lambda m: m.entry.shown):
        total, least = _together(m.results.tasks), min(m.results.tasks, key=lambda t: t.successes / t.trials)
        worst = f"{least.task}, {least.successes} of {least.trials}"
        lines.append(f"| {m.entry.shown} | {_rate(total)} | {worst} | {_counts(total.troubles)} | {_counts(total.failures)} |")
    return lines


@dataclass(frozen=True)
class Total:
    """Several tasks as one."""

    trials: int
    successes: int
    interval: tuple[float, float]
    failures: Mapping[str, int]
    troubles: Mapping[str, int]
    mean_replans: float
    mean_recoveries: float
    touched_s: float
    median_time_s: float | None = None


def _together(tasks: Sequence[TaskResult]) -> Total:
    n, good = sum(t.trials for t in tasks), sum(t.successes for t in tasks)
    failures, troubles = Counter[str](), Counter[str]()
    for t in tasks:
        failures.update(t.failures)
        troubles.update(t.troubles)
    means = [
        sum(getattr(t, name) * t.trials for t in tasks) / n for name in ("mean_replans", "mean_recoveries", "mean_touched_s")
    ]
    times = tasks[0].median_time_s if len(tasks) == 1 else None
    return Total(n, good, wilson(good, n), failures, troubles, *means, times)


def _row(t: TaskResult | Total, name: str, what: str) -> str:
    time = "-" if t.median_time_s is None else f"{t.median_time_s:.0f}"
    means = f"{t.mean_replans:.1f} | {t.mean_recoveries:.1f}"
    return f"| {_named(name, what)} | {_rate(t)} | {time} | {means} | {_counts(t.troubles)} | {_counts(t.failures)} |"


def _rate(t: TaskResult | Total) -> str:
    low, high = t.interval
    return f"{t.successes} of {t.trials} | {t.successes / t.trials:.2f} | {low:.2f}-{high:.2f}"


def _what(entry: Entry) -> str:
    """The condition of an entry."""
    return _named(entry.what, *(f"no {mechanism}" for mechanism in entry.off))


def _named(*words: str) -> str:
    return ", ".join(filter(None, words))


def _counts(counts: Mapping[str, int]) -> str:
    return ", ".join(f"{counts[name]} {name}" for name in sorted(counts) if counts[name]) or "-"


def _failures(measured: Sequence[Measured]) -> list[str]:
    """Every failed episode, without those of comparisons, and where its decisions are."""
    lines = [
        "Not counting the runs without a mechanism. The traces lie in the benchmark's folder,",
        "`failed/EVALUATION/TASK-SEED.jsonl`; `symskill replay TRACE` steps through one.",
        "",
    ]
    rows = [(m.entry, t.task, e) for m in measured for t in m.results.tasks for e in t.episodes if not e.success]
    if not rows:
        return [*lines, "None."]
    lines += ["| evaluation | task | seed | cause | reason |", "|---|---|---|---|---|"]
    return [*lines, *(f"| {entry.name} | {task} | {e.seed} | {e.cause} | {_short(e)} |" for entry, task, e in rows)]


def _short(episode: EpisodeResult, most: int = 160) -> str:
    text = f"{episode.category}: {episode.reason}".replace("|", "/").replace("\n", " ")
    return text if len(text) <= most else f"{text[: most - 3]}..."
