"""Success rates in the kitchen, with and without the monitor, undisturbed and with the door shut on the robot.

    python benchmarks/kitchen.py [--trials 20] [--seed 1000] [--jobs 2] [-o docs/results.md]

Learns from the shipped demonstrations, runs every suite of `SUITES` with the same seeds, and writes one table. `--json FOLDER`
keeps the results file of each suite, with every episode in it.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from symskill_pddl.cli.work import checksum, learn_from, shipped_demos
from symskill_pddl.evaluation.results import Results, TaskResult, save_results
from symskill_pddl.evaluation.suite import PRESETS, Suite, run_suite
from symskill_pddl.library import Library

ATOMIC = PRESETS["atomic"].tasks
COMPOSED = PRESETS["composed"].tasks


@dataclass(frozen=True)
class Entry:
    """One suite: what it is called in the table, and what it runs."""

    name: str
    tasks: tuple[str, ...]
    monitor: bool = True
    disturbances: tuple[str, ...] = ()

    def command(self, trials: int, seed: int) -> str:
        """The command that gives the same episodes."""
        parts = ["symskill evaluate library --tasks", ",".join(self.tasks), f"--trials {trials} --seed {seed}"]
        parts += [f"--disturb {spec}" for spec in self.disturbances]
        parts += [] if self.monitor else ["--no-monitor"]
        return " ".join([*parts, f"-o {self.name}.json"])


SHUT = PRESETS["disturbed"].disturbances
SUITES = (
    Entry("atomic", ATOMIC),
    Entry("composed", COMPOSED),
    Entry("composed-unmonitored", COMPOSED, monitor=False),
    Entry("disturbed", COMPOSED, disturbances=SHUT),
    Entry("disturbed-unmonitored", COMPOSED, monitor=False, disturbances=SHUT),
)


def rows(entry: Entry, tasks: tuple[TaskResult, ...]) -> Iterator[str]:
    """A line of the table for every task."""
    for t in tasks:
        failures = ", ".join(f"{n} {name}" for name, n in t.failures.items()) or "-"
        time = "-" if t.median_time_s is None else f"{t.median_time_s:.0f}"
        what = f"{t.task}{', door shut on the robot' if entry.disturbances else ''}"
        low, high = t.interval
        yield (
            f"| {what} | {'yes' if entry.monitor else 'no'} | {t.successes} of {t.trials} | {low:.2f}-{high:.2f} | {time} "
            f"| {t.mean_replans:.1f} | {failures} |"
        )


def page(found: list[tuple[Entry, Results]], trials: int, seed: int) -> str:
    """The page of all suites."""
    lines = [
        "# Results in the kitchen",
        "",
        f"Written by `python benchmarks/kitchen.py --trials {trials} --seed {seed}`: learned from the shipped demonstrations",
        f"(ten of each atomic task, recorded with seeds 0-9; none of StoreCheese), then {trials} episodes of every task,",
        f"seeds {seed} to {seed + trials - 1}. Success is the judge's word, who alone sees the simulator's state. The interval",
        "is Wilson's at 95 %; the time is the robot's clock, the median of the successful episodes [s]; new plans are those made",
        "after the first, on average.",
        "",
        "| task | monitor | successes | interval | time | new plans | failures |",
        "|---|---|---|---|---|---|---|",
    ]
    for entry, results in found:
        lines += rows(entry, results.tasks)
    lines += ["", "Each suite by itself, after `symskill learn symskill_pddl/data/kitchen/*.hdf5 -o library`:", ""]
    lines += [f"    {entry.command(trials, seed)}" for entry, _ in found]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Learn, run, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("-o", "--output", type=Path, default=Path("docs/results.md"))
    parser.add_argument("--json", type=Path, default=None, help="folder for the suites' results files")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / "library"
        learn_from(shipped_demos(), library)
        found = []
        for entry in SUITES:
            suite = Suite(entry.tasks, args.trials, args.seed, monitor=entry.monitor, disturbances=entry.disturbances)
            results = run_suite(Library.load, library, suite, checksum=checksum(library), jobs=args.jobs)
            found.append((entry, results))
            print(*rows(entry, results.tasks), sep="\n", flush=True)
            if args.json is not None:
                args.json.mkdir(parents=True, exist_ok=True)
                save_results(args.json / f"{entry.name}.json", results)
    args.output.write_text(page(found, args.trials, args.seed), encoding="utf-8")


if __name__ == "__main__":
    main()
