"""What `kitchen.py` measures: a table of suites, made of what the kitchen offers and the package has recordings of."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import reduce
from math import ceil

from symskill_pddl.evaluation.ablations import without
from symskill_pddl.evaluation.suite import Suite, presets
from symskill_pddl.kitchen import TASKS
from symskill_pddl.kitchen.arena import ARENA
from symskill_pddl.kitchen.disturbances import ANY, KINDS

SHOWN = 5
"""Demonstrations of each task, where nothing else is said."""


@dataclass(frozen=True)
class Figure:
    """A part of the page: what is claimed, and the entries that bear it out."""

    title: str
    target: str


ATOMIC = Figure("Atomic tasks", "mean at least 0.95, none below 0.85; lower without the monitor")
STORE = Figure("Two tasks together, never demonstrated", "at least 0.90 each")
LONG = Figure("Long tasks, never demonstrated", "12 operators: at least 0.85; 24 operators: at least 0.70")
PLAY = Figure("Goals in the play scene, learned from play", "no figure was set")
ALONE = Figure("Each disturbance alone, once in an episode", "at least 0.90 each")
MIXED = Figure("All disturbances mixed, one every ten seconds", "at least 0.80; lower without the monitor")
MECHANISMS = Figure("Three mechanisms, each switched off in turn", "lower without the mechanism")
FEWER = Figure("Fewer and more demonstrations", "one of each task: mean at least 0.80")
FIGURES = (ATOMIC, STORE, LONG, PLAY, ALONE, MIXED, MECHANISMS, FEWER)


@dataclass(frozen=True)
class Entry:
    """One evaluation.

    Attributes
    ----------
    figure : Figure
    name : str
        Of its results file.
    what : str
        In the table, after the task.
    tasks : tuple of str
    trials : int
        Of each task, at scale 1; with `spread`, of all tasks together.
    shown : int
        Demonstrations of each task that it learns from; 0 for a library learned from play.
    disturbances, against
        What goes wrong, and the mechanisms it is compared without.
    off : tuple of str
        Mechanisms that are off in all of it, so that they do not make up for another one.
    """

    figure: Figure
    name: str
    tasks: tuple[str, ...]
    trials: int
    what: str = ""
    shown: int = SHOWN
    disturbances: tuple[str, ...] = ()
    against: tuple[str, ...] = ()
    off: tuple[str, ...] = ()
    spread: bool = False

    def suite(self, scale: float, seed: int) -> Suite:
        """At this scale; at least one trial of every task."""
        trials = ceil(scale * self.trials / (len(self.tasks) if self.spread else 1))
        suite = Suite(self.tasks, trials, seed, disturbances=self.disturbances)
        return reduce(without, self.off, suite)

    def command(self, scale: float, seed: int) -> str:
        """What gives the same episodes."""
        suite = self.suite(scale, seed)
        library = f"library-{self.shown}" if self.shown else "library-play"
        parts = [f"symskill evaluate {library} --tasks {','.join(suite.tasks)} --trials {suite.trials} --seed {seed}"]
        parts += [f"--disturb {spec}" for spec in suite.disturbances] + [f"--no-{m}" for m in self.off]
        parts += [f"--against {m}" for m in self.against]
        return " ".join([*parts, f"-o {self.name}.json"])


def entries(recorded: Collection[str]) -> tuple[list[Entry], list[str]]:
    """What can be measured with recordings of these tasks; and in words what cannot.

    A task can be measured if the kitchen has it and each task whose goal it is made of is recorded; one of the play scene, if
    the play is.
    """
    found, missing = [], []
    for entry in _wished():
        lacking = {task: _lacking(task, recorded) for task in entry.tasks}
        for task in entry.tasks:
            if lacking[task] and f"{task}: {lacking[task]}" not in missing:
                missing.append(f"{task}: {lacking[task]}")
        tasks = tuple(task for task in entry.tasks if not lacking[task])
        if tasks:
            found.append(Entry(**{**vars(entry), "tasks": tasks}))
    return found, missing


def _lacking(task: str, recorded: Collection[str]) -> str:
    if task not in TASKS:
        return "the kitchen has no such task"
    spec = TASKS[task]
    needed = [name for name, _ in spec.goal_of] or (["Play"] if spec.kind == "play goal" else [task])
    gone = [name for name in needed if name not in recorded]
    return f"no recording of {', '.join(gone)} is shipped" if gone else ""


def _wished() -> list[Entry]:
    named = presets(ARENA)
    atomic = named["atomic"].tasks
    made = [Entry(ATOMIC, "atomic", atomic, 50, against=("monitor",))]
    made.append(Entry(STORE, "store", ("StoreCheese", "PutCheeseAway"), 50))
    made.append(Entry(LONG, "operators-12", ("MakeBreakfast",), 50))
    made.append(Entry(LONG, "operators-24", ("CookDinner",), 30))
    if named["play"].tasks:
        made.append(Entry(PLAY, "play", named["play"].tasks, 30, shown=0))
    for name in KINDS:
        preset = named[name] if name != ANY else named["mixed"]
        figure = ALONE if name != ANY else MIXED
        what = name if name != ANY else "any, all tasks"
        shown = 0 if preset.tasks and TASKS[preset.tasks[0]].kind == "play goal" else SHOWN
        if preset.tasks:
            made.append(
                Entry(figure, f"with-{name}", preset.tasks, 30, what, shown, preset.disturbances, ("monitor",), spread=True)
            )
    made.append(Entry(MIXED, "atomic-mixed", atomic, 10, "any, atomic tasks", SHOWN, named["mixed"].disturbances, ("monitor",)))
    # a lid or a door that is shut again takes another plan; a plate that is moved is followed by the field alone; what stands in
    # the way is flowed around. For the last two the monitor is off: it would make up for what is missing
    by = {"off": ("monitor",)}
    made += [
        Entry(MECHANISMS, "lid", ("PlayCookAndCover",), 30, "lid put back", 0, ("put-lid-back@op=2",), ("replanning",)),
        Entry(MECHANISMS, "door", ("StoreCheese",), 30, "door shut", SHOWN, ("close-door@op=4",), ("replanning",)),
        Entry(MECHANISMS, "plate", ("PnPStoveToCounter",), 30, "plate moved", SHOWN, ("move-plate@op=1",), ("tracking",), **by),
        Entry(MECHANISMS, "thing", ("PnPCounterToCab",), 30, "food shifted", SHOWN, ("shift@t=1",), ("tracking",), **by),
        Entry(MECHANISMS, "obstacle", ("PnPCounterToCab",), 30, "obstacle", SHOWN, ("obstacle@t=3",), ("obstacles",), **by),
        Entry(MECHANISMS, "obstacle-watched", ("PnPCounterToCab",), 30, "obstacle", SHOWN, ("obstacle@t=3",), ("obstacles",)),
    ]
    made += [Entry(FEWER, f"shown-{shown}", atomic, 20, f"{shown} shown", shown) for shown in (1, 3, 10)]
    return made
