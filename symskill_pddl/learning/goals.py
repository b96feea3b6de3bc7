"""What the demonstrations of a task ended with: the paper's goal, specified by abstracting the final state."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence

from symskill_pddl.demos import Demo
from symskill_pddl.errors import LearningError
from symskill_pddl.learning.naming import parameter_names
from symskill_pddl.learning.segments import Episode
from symskill_pddl.learning.transitions import Truth, state_at
from symskill_pddl.library import Goal
from symskill_pddl.symbols import Atom, Parameter

Ending = tuple[Atom, tuple[Parameter, ...]]
"""A lifted atom with its parameters."""


def learn_goals(
    demos: Sequence[Demo], episodes: Sequence[Episode], truths: Mapping[str, Truth], goal_predicates: Sequence[str]
) -> tuple[tuple[Goal, ...], tuple[str, ...]]:
    """Per task, the lifted atoms about moved objects that most demonstrations bring about: they hold at the end and not at the
    start of more than half of those that show objects of the atom's types. Also a line for each task
    whose demonstrations end in too many ways for a goal. `goal_predicates` are the places of objects, and what it is to hold one.

    Raises
    ------
    LearningError
        If half of the demonstrations of a task bring an object to one thing, and the other half to another.
    """
    goals, told = [], []
    for task in sorted({demo.task for demo in demos}):
        own = [demo for demo in demos if demo.task == task]
        counts = Counter(ending for demo in own for ending in _endings(demo, episodes, truths[demo.where], goal_predicates))
        shown = {ending: sum({p.type for p in ending[1]} <= set(demo.objects.values()) for demo in own) for ending in counts}
        usual = sorted(ending for ending, n in counts.items() if 2 * n > shown[ending])
        if not usual:
            _check_halves(task, sorted(ending for ending, n in counts.items() if 2 * n == shown[ending]), shown)
            if counts:
                told.append(f"task '{task}' gets no goal: no more than half of its {len(own)} demonstrations end alike")
            continue
        parameters = tuple(dict.fromkeys([*(ps[0] for _, ps in usual), *(p for _, ps in usual for p in ps)]))
        goals.append(Goal(task, parameters, frozenset(atom for atom, _ in usual)))
    return tuple(goals), tuple(told)


def _endings(demo: Demo, episodes: Sequence[Episode], truth: Truth, goal_predicates: Sequence[str]) -> set[Ending]:
    """What a demonstration brings about."""
    moved = list(dict.fromkeys(obj for e in episodes if e.demo is demo for obj in (e.obj, *e.passengers)))
    gained = state_at(truth, len(demo) - 1) - state_at(truth, 0)
    atoms = [a for a in gained if a.predicate in goal_predicates and a.args[0] in moved]
    refs = sorted({a.args[-1] for a in atoms} - set(moved))
    names = parameter_names([*(o for o in moved if any(o in a.args for a in atoms)), *refs], demo.objects)
    return {(a.substitute(names), tuple(Parameter(names[o], demo.objects[o]) for o in a.args)) for a in atoms}


def _check_halves(task: str, halves: Sequence[Ending], shown: Mapping[Ending, int]) -> None:
    by_object: dict[Parameter, list[Ending]] = defaultdict(list)
    for ending in halves:
        by_object[ending[1][0]].append(ending)
    for rivals in by_object.values():
        if len({parameters[-1].type for _, parameters in rivals}) > 1:
            told = " and ".join(f"{shown[r] // 2} of {shown[r]} with {r[0]}" for r in rivals)
            raise LearningError(
                f"the demonstrations of task '{task}' contradict each other: they end {told}; "
                "give different tasks different names, or leave one of them out"
            )
