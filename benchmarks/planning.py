"""How long planning takes: every installed planner, cold and in a warm session, beside the same engine called directly.

    python benchmarks/planning.py -o docs/benchmarks-planning.md

It also draws docs/benchmarks-planning.svg.

Two domains: a hand-written kitchen of 11 operators in the shape of the paper's table (`data/planning/domain.pddl`) with 2 to 100
things, and the learned kitchen of `domains/` with 2 to 100 foods. A planner that runs out of time is not asked for more things.
"""

from __future__ import annotations

import argparse
import os
import platform
import random
import resource
import statistics
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

from planning_direct import DIRECT  # noqa: E402 - the path has to be there first
from planning_plot import svg  # noqa: E402

from symskill_pddl.pddl import exported, read_domain, read_problem, write_domain, write_problem  # noqa: E402
from symskill_pddl.planning import Auto, Limits, Planner, Status, planners, session  # noqa: E402
from symskill_pddl.planning.text import Answer, Ask, Reader, Text, text_of  # noqa: E402
from symskill_pddl.planning.worker import POOL  # noqa: E402
from symskill_pddl.symbols import Atom, Domain, Plan, Problem  # noqa: E402

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
    cold_cpu_ms: float | None = None
    warm_cpu_ms: float | None = None
    """Processor time, of this process and of the programs it started: other work on the machine changes it little."""


@dataclass(frozen=True)
class Instant(Reader):
    """An engine that knows the plan: what is left of a call is what our protocol adds to an engine."""

    known: Plan = field(default_factory=Plan)
    shorten: bool = field(default=True, init=False)

    @property
    def name(self) -> str:
        return "instant"

    def load(self, text: Text) -> Ask:
        assert text.domain
        plan = text.names.plan(self.known)

        def ask(problem: Problem, _limits: Limits) -> Answer:
            assert text.problem(problem)
            return Answer(Status.SOLVED, plan)

        return ask


@dataclass(frozen=True)
class Overhead:
    """What the protocol adds, medians of this thread's processor time [ms], which other work on the machine changes little."""

    task: str
    size: int
    steps: int
    cold_ms: float
    warm_ms: float


def overhead(domain: Domain, problem: Problem, task: str, size: int) -> Overhead | None:
    """With the plan of `auto`, as short as it is: clearing it of detours is our work too."""
    plan = Auto().solve(domain, problem, Limits(time_s=LIMIT_S)).plan
    if plan is None:
        return None
    engine = Instant(known=plan)
    warm = session(engine, domain, problem.objects)

    def cold() -> object:
        text_of.cache_clear()
        exported.cache_clear()
        return engine.solve(domain, problem)

    def median(call: Callable[[], object]) -> float:
        times = []
        for _ in range(4 * REPEATS):
            start = time.thread_time()
            call()
            times.append(time.thread_time() - start)
        return 1000.0 * statistics.median(times)

    return Overhead(task, size, len(plan), median(cold), median(lambda: warm.solve(problem.init, problem.goal)))


def processor_s() -> float:
    """Processor time of this process, of its children that have ended, and of the engines' processes for their answers [s]."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(u.ru_utime + u.ru_stime for u in used) + POOL.processor_s


Times = tuple[float | None, float | None]
"""Medians by the clock and by the processor [ms]."""


def medians_ms(calls: Sequence[Callable[[], bool]]) -> list[Times]:
    """Of several rounds in which each call has its turn, so that other work on the machine slows all alike."""
    times: list[list[tuple[float, float]]] = [[] for _ in calls]
    failed = [False] * len(calls)
    for _ in range(REPEATS):
        for i, call in enumerate(calls):
            if failed[i] or sum(wall for wall, _ in times[i]) > 1.0:
                continue
            start, used = time.perf_counter(), processor_s()
            failed[i] = not call()
            times[i].append((time.perf_counter() - start, processor_s() - used))
    found: list[Times] = []
    for bad, measured in zip(failed, times, strict=True):
        wall, used = (1000.0 * statistics.median(column) for column in zip(*measured, strict=True))
        found.append((None, None) if bad else (wall, used))
    return found


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
    engine = DIRECT.get(planner.name)

    def cold() -> bool:
        text_of.cache_clear()
        exported.cache_clear()
        return planner.solve(domain, problem, limits).status is Status.SOLVED

    (cold_ms, cold_cpu), (warm_ms, warm_cpu), *direct_ms = medians_ms(
        [
            cold,
            lambda: open_.solve(next(drawn), problem.goal, limits).status is Status.SOLVED,
            *([lambda: engine(*texts, LIMIT_S) is not None] if engine else []),
        ]
    )
    direct = direct_ms[0][0] if direct_ms else None
    return Row(planner.name, result.planner, task, size, len(result.plan), direct, cold_ms, warm_ms, cold_cpu, warm_cpu)


Tasks = dict[str, tuple[Domain, Callable[[int], Problem]]]


def all_tasks() -> Tasks:
    """Domain and problems of each size, by name."""
    table = read_domain((HERE / "data" / "planning" / "domain.pddl").read_text(), "domain.pddl")
    learned = read_domain((HERE.parent / "domains" / "kitchen" / "domain.pddl").read_text(), "domain.pddl")
    store = read_problem((HERE.parent / "problems" / "kitchen" / "store-cheese.pddl").read_text(), learned, "store-cheese.pddl")
    return {
        "12 steps": (table, lambda n: table_problem(table, n, "g12")),
        "move everything": (table, lambda n: table_problem(table, n, "gall")),
        "learned kitchen": (learned, lambda n: learned_problem(store, n)),
    }


def rows(tasks: Tasks) -> Iterator[Row]:
    """All measurements, planner by planner."""
    for planner in (p for p in planners() if p.name != "builtin-optimal"):
        for task, (domain, make) in tasks.items():
            for size in SIZES:
                row = measure(planner, domain, make(size), task, size)
                yield row
                if row.cold_ms is None:
                    break


def cell(value: float | None) -> str:
    """A number of milliseconds."""
    return "" if value is None else f"{value:.1f}" if value < 100.0 else f"{value:.0f}"


def figures(found: Sequence[Row], added: Sequence[Overhead]) -> list[str]:
    """The figures that planning is held to, and what was measured."""

    def best(kind: str, size: int, task: str) -> str:
        timed = [(value, r.planner) for r in found if (r.size, r.task) == (size, task) and (value := getattr(r, kind))]
        if not timed:
            return "no plan"
        value, planner = min(timed)
        row = next(r for r in found if (r.planner, r.size, r.task) == (planner, size, task))
        return f"{cell(value)} by {planner} ({cell(getattr(row, kind.replace('_ms', '_cpu_ms')))})"

    lines = [
        "| best engine, ms (processor) | at most | " + " | ".join(names := list(dict.fromkeys(r.task for r in found))) + " |"
    ]
    lines.append("|---|---|" + "---|" * len(names))
    for what, kind, size, most in (
        ("cold, 20 things", "cold_ms", 20, 20),
        ("warm, 20 things", "warm_ms", 20, 5),
        ("warm, 100 things", "warm_ms", 100, 50),
    ):
        lines.append(f"| {what} | {most} | " + " | ".join(best(kind, size, name) for name in names) + " |")
    lines += ["", "| what the protocol adds, ms | steps | cold | warm |", "|---|---|---|---|"]
    lines += [f"| {o.task}, {o.size} things | {o.steps} | {o.cold_ms:.2f} | {o.warm_ms:.2f} |" for o in added]
    return lines


def markdown(found: Sequence[Row], seconds: float, added: Sequence[Overhead] = (), plot: str = "") -> str:
    """The page."""
    versions = ", ".join(f"{p.name} {p.version}" for p in planners() if p.name != "builtin-optimal")
    load = " ".join(f"{value:.1f}" for value in os.getloadavg())
    lines = [
        "# Planning times",
        "",
        "Made by `python benchmarks/planning.py -o docs/benchmarks-planning.md`; "
        f"{platform.machine()}, {os.cpu_count()} processors, Python {platform.python_version()}, one run of {seconds:.0f} s.",
        f"Load of the machine at the end (1, 5, 15 minutes): {load}; other work slows all rows of a table alike.",
        f"Planners: {versions}.",
        "",
        "Milliseconds, medians. *direct*: the engine called as its documentation says, from the same text. *cold*: one call of",
        "`solve`, from our symbols to a plan that our semantics have checked. *warm*: a session that has the domain loaded, from",
        f"states along the plan. A row without times: no plan in {LIMIT_S:g} s; larger sizes are left out then. What the",
        "protocol adds is the same call with an engine that knows the plan already, in processor time of its thread: names,",
        "text, reading the plan, running it by our semantics, and clearing it of detours.",
        "",
        *figures(found, added),
        "",
        *([f"![times over things]({plot})"] if plot else []),
    ]
    for task in dict.fromkeys(row.task for row in found):
        lines += ["", f"## {task}", "", "| planner | things | steps | direct | cold | warm |", "|---|---|---|---|---|---|"]
        for row in (r for r in found if r.task == task):
            name = row.planner if row.planner in ("", row.took) else f"{row.planner} ({row.took})"
            cells = (cell(row.direct_ms), cell(row.cold_ms), cell(row.warm_ms))
            lines.append(f"| {name} | {row.size} | {'' if row.steps is None else row.steps} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def drawn(found: Sequence[Row]) -> str:
    """The plot."""
    panels: dict[str, dict[str, tuple[list[tuple[float, float]], list[tuple[float, float]]]]] = {}
    for row in found:
        cold, warm = panels.setdefault(row.task, {}).setdefault(row.planner, ([], []))
        if row.cold_ms is not None and row.warm_ms is not None:
            cold.append((row.size, row.cold_ms))
            warm.append((row.size, row.warm_ms))
    return svg(panels)


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description="Planning times of every installed planner.")
    parser.add_argument("-o", "--output", type=Path, help="write a page of Markdown, and the plot beside it")
    options = parser.parse_args()
    start, found, tasks = time.monotonic(), [], all_tasks()
    added = [
        row
        for task, (domain, make) in tasks.items()
        for size in (5, 20, 100)
        if (row := overhead(domain, make(size), task, size)) is not None
    ]
    for row in rows(tasks):
        found.append(row)
        print(row, flush=True)
    plot = options.output.with_suffix(".svg") if options.output else None
    page = markdown(found, time.monotonic() - start, added, plot.name if plot else "")
    print(page)
    if options.output and plot:
        options.output.write_text(page)
        plot.write_text(drawn(found))


if __name__ == "__main__":
    main()
