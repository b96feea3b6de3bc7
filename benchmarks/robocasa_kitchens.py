"""Success rates in RoboCasa's kitchens beside those of the paper; may be stopped and called again.

    .venv-robocasa/bin/python benchmarks/robocasa_kitchens.py [--trials 20] [--seed 1000] [--only TASK ...] [-o FILE]

Learns a library from the demonstrations in benchmarks/data/robocasa (`symskill record TASK --world robocasa` makes them, in other
kitchens), runs every task with the monitor and without, a few seeds of each at a time, and writes the page anew after each round.
"""

from __future__ import annotations

import argparse
import sys
import textwrap
from collections import Counter
from hashlib import sha256
from pathlib import Path

from symskill_pddl.cli.work import checksum_of
from symskill_pddl.demos import load_demos
from symskill_pddl.evaluation.results import EpisodeResult
from symskill_pddl.evaluation.resumable import evaluate
from symskill_pddl.evaluation.spread import Processes
from symskill_pddl.evaluation.statistics import mcnemar, median, wilson
from symskill_pddl.evaluation.suite import Suite
from symskill_pddl.files import RESULTS, Output, Replace, write_atomic
from symskill_pddl.learning import learn
from symskill_pddl.library import Library
from symskill_pddl.robocasa.tasks import TASKS

DEMOS = Path(__file__).parent / "data" / "robocasa"
PAPER = {
    "OpenSingleDoor": (100, 100), "CloseSingleDoor": (100, 80), "PnPCounterToCab": (80, 70), "PnPCabToCounter": (100, 40),
    "PnPStoveToCounter": (70, 30), "PnPCounterToStove": (20, 0), "OpenDrawer": (100, 100), "CloseDrawer": (70, 50),
    "TurnOnStove": (100, 100), "TurnOffStove": (80, 30), "TurnOnSinkFaucet": (100, 100), "TurnOffSinkFaucet": (100, 90),
}  # fmt: skip
"""Percent of 10 trials each, with its monitor and without (Table I there)."""
ROUND = 5
"""Seeds of every task in one round."""
SEEN = Path(__file__).parent / "data" / "failures"
"""What people who looked at the failures of a run with a seed wrote of them."""
Found = dict[tuple[str, bool], list[EpisodeResult]]
"""By task and whether the monitor was on."""


def library(folder: Path) -> Path:
    """The library of all demonstrations; learned once for one set of them."""
    files = sorted(DEMOS.glob("*.hdf5"))
    digest = sha256(b"".join(file.read_bytes() for file in files)).hexdigest()
    path, stamp = folder / "library", folder / "learned-from.txt"
    if not (stamp.is_file() and stamp.read_text() == digest):
        print(f"learning from {len(files)} files", file=sys.stderr, flush=True)
        learn([demo for file in files for demo in load_demos(file)]).save(path)
        stamp.write_text(digest)
    return path


def page(found: Found, missing: list[str], call: str, library_is_of: str, looked_at: str = "") -> str:
    """The whole page; `looked_at` is what somebody who looked at the failures wrote of them."""
    about = f"""
        Written by `{call}`. {library_is_of} Success is what RoboCasa's own `_check_success()` says when the run is over. Episodes
        are in RoboCasa's target kitchens (layouts 1 to 10), demonstrations in its training kitchens (11 to 60). Intervals are
        Wilson's at 95 %; p is of McNemar's exact test on the same episodes with the monitor and without; times are the robot's
        clock, the median of the successful episodes [s]; new plans are means per episode with the monitor."""
    different = """
        What is different from the paper: the assets are primitive shapes of our own ([robocasa.md](robocasa.md)); the
        demonstrations are scripted, not teleoperated; the kitchens vary freely where the paper kept one variant of
        each fixture, in training and in the trials, but are drawn again where this robot, which does not drive, could
        not do the task: food or dish out of reach, no room beside the door or on the counter, handles that are no
        bars (robocasa.md lists all of it); the base stands where RoboCasa puts it. Demonstrations that failed, or in
        which food tumbled, were dropped."""
    lines = ["# Results in RoboCasa", "", *_wrapped(about), "", *_wrapped(different), ""]
    lines += ["| task | paper | paper, no monitor | with monitor | % | 95 % | no monitor | % | p | time | new plans |"]
    lines += ["|---|---|---|---|---|---|---|---|---|---|---|"]
    rates: dict[bool, list[float]] = {True: [], False: []}
    for task in TASKS:
        on, off = found.get((task, True), []), found.get((task, False), [])
        if not on:
            continue
        if task in PAPER:
            for flag, episodes in ((True, on), (False, off)):
                if episodes:
                    rates[flag].append(100.0 * sum(e.success for e in episodes) / len(episodes))
        paper = [f"{v} %" for v in PAPER[task]] if task in PAPER else ["-", "-"]
        plans = f"{sum(e.replans for e in on) / len(on):.1f}"
        lines.append(f"| {' | '.join([task, *paper, *_rate(on), *_rate(off)[:2], _p(on, off), _time(on), plans])} |")
    atomic = [[e for (task, m), es in found.items() if task in PAPER and m is flag for e in es] for flag in (True, False)]
    together = " | ".join(["**the paper's tasks**", "-", "-", *_rate(atomic[0]), *_rate(atomic[1])[:2], "-", "-", "-"])
    means = [f"{sum(rates[flag]) / len(rates[flag]):.1f}" if rates[flag] else "-" for flag in (True, False)]
    lines.append(f"| {together} |")
    lines.append(
        f"| **mean** | 85 % | 65 % | {len(rates[True])} tasks | {means[0]} | | {len(rates[False])} tasks | {means[1]} | | | |"
    )
    lines += ["", "## Failures", ""]
    for (task, monitor), episodes in sorted(found.items()):
        reasons = Counter(e.category if e.category else e.reason for e in episodes if not e.success)
        if reasons:
            how = "with" if monitor else "without"
            which = ", ".join(str(e.seed) for e in episodes if not e.success)
            lines.append(f"- {task}, {how} monitor: {', '.join(f'{n} {r}' for r, n in reasons.most_common())} (seeds {which})")
    if looked_at:
        lines += ["", "### What they were, looked at", "", looked_at.rstrip()]
    if missing:
        lines += [
            "",
            "## Not measured",
            "",
            *(f"- {task}: nobody has recorded what its goal is learned from" for task in missing),
        ]
    return "\n".join(lines) + "\n"


def _wrapped(text: str) -> list[str]:
    return textwrap.wrap(" ".join(text.split()), 128)


def _rate(episodes: list[EpisodeResult]) -> list[str]:
    if not episodes:
        return ["-", "-", "-"]
    k, n = sum(e.success for e in episodes), len(episodes)
    low, high = wilson(k, n)
    return [f"{k} of {n}", f"{100 * k / n:.0f}", f"{100 * low:.0f}-{100 * high:.0f}"]


def _p(on: list[EpisodeResult], off: list[EpisodeResult]) -> str:
    other = {e.seed: e.success for e in off}
    pairs = [(e.success, other[e.seed]) for e in on if e.seed in other]
    return f"{mcnemar(sum(a and not b for a, b in pairs), sum(b and not a for a, b in pairs)):.2g}" if pairs else "-"


def _time(episodes: list[EpisodeResult]) -> str:
    value = median([e.time_s for e in episodes if e.success])
    return "-" if value is None else f"{value:.0f}"


def main() -> None:
    """Learn, run, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=20, help="of every task")
    parser.add_argument("--seed", type=int, default=1000, help="of the first episode of every task")
    parser.add_argument("--only", nargs="+", metavar="TASK", choices=list(TASKS))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--folder", type=Path, default=Path("symskill-out/robocasa"))
    parser.add_argument("-o", "--output", type=Path, default=Path("docs/results-robocasa.md"))
    args = parser.parse_args()
    if args.trials < 1:
        parser.error(f"--trials has to be at least 1, got {args.trials}")
    args.folder.mkdir(parents=True, exist_ok=True)
    recorded = {file.stem for file in DEMOS.glob("*.hdf5")}
    chosen = [task for task in TASKS if args.only is None or task in args.only]
    ready = [task for task in chosen if {name for name, _ in TASKS[task].goals} <= recorded]
    path = library(args.folder)
    known = checksum_of(path)
    shown = Counter(demo.task for file in sorted(DEMOS.glob("*.hdf5")) for demo in load_demos(file))
    of = f"One library, learned from {min(shown.values())} to {max(shown.values())} demonstrations of each task."
    call = f"python benchmarks/robocasa_kitchens.py --trials {args.trials} --seed {args.seed}"
    notes = SEEN / f"robocasa-{args.seed}.md"
    seen = notes.read_text(encoding="utf-8") if notes.is_file() else ""
    found: Found = {}
    for first in range(0, args.trials, ROUND):
        for monitor in (True, False):
            for task in ready:
                suite = Suite((task,), min(ROUND, args.trials - first), args.seed + first, monitor=monitor, world="robocasa")
                name = f"{task}-{suite.seed}{'' if monitor else '.no-monitor'}"
                failed = args.folder / "failed" / name
                failed.mkdir(parents=True, exist_ok=True)
                print(name, file=sys.stderr, flush=True)
                results = evaluate(
                    Library.load,
                    path,
                    suite,
                    Output(args.folder / f"{name}.json", RESULTS, Replace.ANYTHING),
                    checksum=known,
                    pool=Processes(args.jobs),
                    failed=failed,
                    keep=True,
                )
                found.setdefault((task, monitor), []).extend(results.tasks[0].episodes)
                write_atomic(args.output, page(found, sorted(set(chosen) - set(ready)), call, of, seen).encode())


if __name__ == "__main__":
    main()
