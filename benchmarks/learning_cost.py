"""What learning costs, all stages, by number of demonstrations: ``python benchmarks/learning_cost.py [30 120 480] [-o FILE]``.

Beyond the shipped demonstrations there are copies of them with every object shifted by half a millimetre: nothing is equal.
"""

from __future__ import annotations

import argparse
import resource
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from symskill_pddl.cli.work import JOBS, shipped_demos
from symskill_pddl.demos import Demo, load_demos
from symskill_pddl.files import write_atomic
from symskill_pddl.geometry import Pose
from symskill_pddl.learning import learn_reported


@dataclass(frozen=True)
class Cost:
    """Seconds of one run: on the clock, and of the processor in this process and in those that fit skills."""

    demos: int
    samples: int
    operators: int
    wall_s: float
    symbols_cpu_s: float
    fits_cpu_s: float


def many(n: int) -> list[Demo]:
    """`n` demonstrations, of all tasks in turn."""
    files = [load_demos(file) for file in shipped_demos()]
    shipped = [demo for turn in zip(*files, strict=False) for demo in turn]
    found = []
    for k in range(n):
        demo, copy = shipped[k % len(shipped)], k // len(shipped)
        if copy:
            T = demo.T_world_objects
            shift = np.random.default_rng(k).normal(0.0, 0.0005, (1, T.shape[1], 3))
            demo = replace(demo, name=f"{demo.name}{copy:02d}", T_world_objects=Pose(T.p + shift, T.q))
        found.append(demo)
    return found


def measured(n: int) -> Cost:
    """Learn from `n` demonstrations."""

    def cpu(who: int) -> float:
        return resource.getrusage(who).ru_utime

    demos = many(n)
    begun, own, others = time.perf_counter(), cpu(resource.RUSAGE_SELF), cpu(resource.RUSAGE_CHILDREN)
    library, _ = learn_reported(demos, jobs=JOBS)
    return Cost(
        n,
        sum(map(len, demos)),
        len(library.operators),
        time.perf_counter() - begun,
        cpu(resource.RUSAGE_SELF) - own,
        cpu(resource.RUSAGE_CHILDREN) - others,
    )


def rows(costs: Sequence[Cost]) -> Iterator[str]:
    """The table."""
    columns = (
        "demonstrations",
        "minutes recorded",
        "operators",
        "symbols, CPU [s]",
        "skills, CPU [s]",
        "CPU for each [s]",
        "clock [s]",
    )
    yield f"| {' | '.join(columns)} |"
    yield "|" + "---|" * len(columns)
    for c in costs:
        total = c.symbols_cpu_s + c.fits_cpu_s
        yield (
            f"| {c.demos} | {c.samples / 1200:.0f} | {c.operators} | {c.symbols_cpu_s:.1f} | {c.fits_cpu_s:.1f} "
            f"| {total / c.demos:.2f} | {c.wall_s:.0f} |"
        )


def main() -> None:
    """Learn, and write what it took."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("numbers", nargs="*", type=int, default=[30, 120, 480])
    parser.add_argument("-o", "--output", type=Path, default=Path("docs/benchmarks-learning-cost.md"))
    args = parser.parse_args()
    costs = []
    for n in args.numbers:
        costs.append(measured(n))
        print(costs[-1], flush=True)
    head = [
        "# What learning costs",
        "",
        f"Written by `python benchmarks/learning_cost.py {' '.join(map(str, args.numbers))}`: all stages, {JOBS} processes that",
        "fit skills. CPU seconds count the work; the clock also counts what else the machine did at the time.",
        "",
    ]
    write_atomic(args.output, "\n".join([*head, *rows(costs), ""]).encode())


if __name__ == "__main__":
    main()
