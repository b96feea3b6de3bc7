"""How long planning takes: every installed planner, cold and in a warm session, beside the same engine called directly.

    python benchmarks/planning.py -o docs/benchmarks-planning.md

Two domains: a hand-written kitchen of 11 operators in the shape of the paper's table (`data/planning/domain.pddl`) with 2 to 100
things, and the learned kitchen of `domains/` with 2 to 100 foods. A planner that runs out of time is not asked for more things.
"""

from __future__ import annotations

import argparse
import platform
import random
import statistics
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

from planning_direct import DIRECT  # noqa: E402 - the path has to be there first

from symskill_pddl.pddl import read_domain, read_problem, write_domain, write_problem  # noqa: E402
from symskill_pddl.planning import Auto, Limits, Planner, Status, planners, session  # noqa: E402
from symskill_pddl.planning.text import text_of  # noqa: E402
from symskill_pddl.symbols import Atom, Domain, Problem  # noqa: E402

SIZES = (2, 5, 10, 20, 50, 100)
LIMIT_S = 4.0
REPEATS = 7
"""Calls of each kind, of which the median counts; fewer where they take more than a second together."""


def table_problem(domain: Domain, n: int, goal: str) -> Problem:
    """`n` things in drawers and containers, pots with lids on. `g12` needs 12 or 13 steps, `gall` moves every thing."""
    k = max(2, n // 10)
    names = {kind: [f"{kind}{i}" for i in range(k)] for kind in ("drawer", "container", "cookware", "lid")}
    names |= {"thing": [f"thing{i}" for i in range(n)], "cabinet": ["cabinet0"], "gripper": ["gripper0"]}
    place = {t: names["container" if i % 2 else "drawer"][(i // 2) % k] for i, t in enumerate(names["thing"])}

    def at(thing: str, where: str) -> Atom:
        return Atom(f"rel-thing-in-{where.rstrip('0123456789')}", (thing, where))

    lids = list(zip(names["lid"], names["cookware"], strict=True))
    on = [Atom("rel-lid-on-cookware", pair) for pair in lids]
    init = [Atom("gripper-open"), *(at(*pair) for pair in place.items()), *on, *(Atom("cookware-covered", (c,)) for _, c in lids)]
    in_container = next(t for t in names["thing"] if place[t].startswith("container"))
    in_drawer = next(t for t in names["thing"] if place[t].startswith("drawer"))
    wanted: list[Atom] = []
    if goal == "g12":
        other = [t for t in names["thing"] if t not in (in_container, in_drawer)]
        wanted = [
            at(in_container, "cookware0"),
            on[0],
            at(in_drawer, "cookware1"),
            Atom("rel-lid-in-cabinet", ("lid1", "cabinet0")),
        ]
        wanted.append(Atom("gripper-in-thing", (other[0],)) if other else Atom("drawer-open", ("drawer1",)))
    else:
        for i, thing in enumerate(names["thing"]):
            if i % 3 == 0:
                wanted.append(at(thing, names["cookware"][i % k]))
                continue
            pool = names["container" if i % 3 == 1 else "drawer"]
            wanted.append(at(thing, next(p for p in (pool[(i + 1) % k], pool[(i + 2) % k]) if p != place[thing])))
        wanted += on
    objects = tuple((name, kind) for kind in (t.name for t in domain.types) for name in names[kind])
    return Problem(f"{goal}-{n}", domain.name, objects, frozenset(init), frozenset(wanted))


def learned_problem(base: Problem, n: int) -> Problem:
    """The stored problem with `n` foods, the further ones on the counter."""
    kinds = base.object_types
    counter = next(name for name, kind in base.objects if kind == "counter")
    foods = [name for name, kind in base.objects if kind == "food"]
    extra = [f"extra-{i}" for i in range(n - len(foods))]
    init = base.init | {Atom("food-on-counter", (food, counter)) for food in extra}
    gone = set(foods[n:]) if n < len(foods) else set()
    objects = (*((o, kinds[o]) for o in kinds if o not in gone), *((food, "food") for food in extra))
    return replace(base, objects=objects, init=frozenset(a for a in init if not gone & set(a.args)))


@dataclass(frozen=True)
class Row:
    """Medians in milliseconds; None where there is no plan in time, or nothing to call."""

    planner: str
    took: str
    task: str
    size: int
    steps: int | None
    direct_ms: float | None
    cold_ms: float | None
    warm_ms: float | None


def medians_ms(calls: Sequence[Callable[[], bool]]) -> list[float | None]:
    """Of several rounds in which each call has its turn, so that other work on the machine slows all alike."""
    times: list[list[float]] = [[] for _ in calls]
    failed = [False] * len(calls)
    for _ in range(REPEATS):
        for i, call in enumerate(calls):
            if failed[i] or sum(times[i]) > 1.0:
                continue
            start = time.perf_counter()
            failed[i] = not call()
            times[i].append(time.perf_counter() - start)
    return [None if bad else 1000.0 * statistics.median(t) for bad, t in zip(failed, times, strict=True)]


def measure(planner: Planner, domain: Domain, problem: Problem, task: str, size: int) -> Row:
    """Directly, cold (a call of `solve`), and warm: one session, from the states along the plan, as an executor would."""
    limits = Limits(time_s=LIMIT_S)
    result = planner.solve(domain, problem, limits)  # the first call of all pays for imports
    if result.plan is None:
        return Row(planner.name, result.planner, task, size, None, None, None, None)
    states = [problem.init]
    for step in result.plan.ground(domain, problem.object_types):
        states.append(step.apply(states[-1]))
    drawn = iter(random.Random(size).choices(states[:-1], k=REPEATS))
    open_ = session(planner, domain, problem.objects)
    open_.solve(problem.init, problem.goal, limits)
    dialect = "strips" if planner.name == "pyperplan" else "negative"
    texts = write_domain(domain, dialect=dialect), write_problem(problem, domain, dialect=dialect)
    direct = DIRECT.get(planner.name)

    def cold() -> bool:
        text_of.cache_clear()
        return planner.solve(domain, problem, limits).status is Status.SOLVED

    cold_ms, warm_ms, *direct_ms = medians_ms(
        [
            cold,
            lambda: open_.solve(next(drawn), problem.goal, limits).status is Status.SOLVED,
            *([lambda: direct(*texts, LIMIT_S) is not None] if direct else []),
        ]
    )
    return Row(planner.name, result.planner, task, size, len(result.plan), *(direct_ms or [None]), cold_ms, warm_ms)


def rows() -> Iterator[Row]:
    """All measurements, planner by planner."""
    table = read_domain((HERE / "data" / "planning" / "domain.pddl").read_text(), "domain.pddl")
    learned = read_domain((HERE.parent / "domains" / "kitchen" / "domain.pddl").read_text(), "domain.pddl")
    store = read_problem((HERE.parent / "problems" / "kitchen" / "store-cheese.pddl").read_text(), learned, "store-cheese.pddl")
    tasks: dict[str, tuple[Domain, Callable[[int], Problem]]] = {
        "12 steps": (table, lambda n: table_problem(table, n, "g12")),
        "move everything": (table, lambda n: table_problem(table, n, "gall")),
        "learned kitchen": (learned, lambda n: learned_problem(store, n)),
    }
    for planner in (Auto(), *(p for p in planners() if p.name != "builtin-optimal")):
        for task, (domain, make) in tasks.items():
            for size in SIZES:
                row = measure(planner, domain, make(size), task, size)
                yield row
                if row.cold_ms is None:
                    break


def markdown(found: list[Row], seconds: float) -> str:
    """The page."""

    def cell(value: float | None) -> str:
        return "" if value is None else f"{value:.1f}" if value < 100.0 else f"{value:.0f}"

    versions = ", ".join(f"{p.name} {p.version}" for p in planners() if p.name != "builtin-optimal")
    lines = [
        "# Planning times",
        "",
        "Made by `python benchmarks/planning.py -o docs/benchmarks-planning.md`; "
        f"{platform.machine()}, Python {platform.python_version()}, one run of {seconds:.0f} s, other work on the machine.",
        f"Planners: {versions}.",
        "",
        "Milliseconds, medians. *direct*: the engine called as its documentation says, from the same text. *cold*: one call of",
        "`solve`, from our symbols to a plan that our semantics have checked. *warm*: a session that has the domain loaded, from",
        f"states along the plan. A row without times: no plan in {LIMIT_S:g} s; larger sizes are left out then.",
    ]
    for task in dict.fromkeys(row.task for row in found):
        lines += ["", f"## {task}", "", "| planner | things | steps | direct | cold | warm |", "|---|---|---|---|---|---|"]
        for row in (r for r in found if r.task == task):
            name = row.planner if row.planner in ("", row.took) else f"{row.planner} ({row.took})"
            cells = (cell(row.direct_ms), cell(row.cold_ms), cell(row.warm_ms))
            lines.append(f"| {name} | {row.size} | {'' if row.steps is None else row.steps} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description="Planning times of every installed planner.")
    parser.add_argument("-o", "--output", type=Path, help="write a page of Markdown")
    options = parser.parse_args()
    start, found = time.monotonic(), []
    for row in rows():
        found.append(row)
        print(row, flush=True)
    page = markdown(found, time.monotonic() - start)
    print(page)
    if options.output:
        options.output.write_text(page)


if __name__ == "__main__":
    main()
