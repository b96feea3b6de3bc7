"""What the demonstrations of a task ended with: the paper's goal, specified by abstracting the final state."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence

from symskill_pddl.demos import Demo
from symskill_pddl.learning.naming import parameter_names
from symskill_pddl.learning.segments import Episode
from symskill_pddl.learning.transitions import Truth, state_at
from symskill_pddl.library import Goal
from symskill_pddl.symbols import Atom, Parameter


def learn_goals(
    demos: Sequence[Demo], episodes: Sequence[Episode], truths: Mapping[str, Truth], places: Sequence[str]
) -> tuple[Goal, ...]:
    """Per task, the lifted atoms about moved objects that hold at the end, and not at the start, of most of its
    demonstrations."""
    moved: dict[str, list[str]] = defaultdict(list)
    for e in episodes:
        for obj in (e.obj, *e.passengers):
            if obj not in moved[e.demo.where]:
                moved[e.demo.where].append(obj)
    counts: dict[str, Counter[tuple[Atom, tuple[Parameter, ...]]]] = defaultdict(Counter)
    total = Counter(demo.task for demo in demos)
    for demo in demos:
        truth = truths[demo.where]
        gained = state_at(truth, len(demo) - 1) - state_at(truth, 0)
        atoms = [a for a in gained if a.predicate in places and a.args[0] in moved[demo.where]]
        if not atoms:
            continue
        refs = sorted({a.args[1] for a in atoms} - set(moved[demo.where]))
        names = parameter_names([*(o for o in moved[demo.where] if any(o in a.args for a in atoms)), *refs], demo.objects)
        for atom in atoms:
            parameters = tuple(Parameter(names[o], demo.objects[o]) for o in atom.args)
            counts[demo.task][(atom.substitute(names), parameters)] += 1
    goals = []
    for task in sorted(counts):
        usual = [key for key, n in counts[task].items() if 2 * n >= total[task]]
        if not usual:
            continue
        usual.sort()
        parameters = tuple(dict.fromkeys([*(ps[0] for _, ps in usual), *(p for _, ps in usual for p in ps)]))
        goals.append(Goal(task, parameters, frozenset(atom for atom, _ in usual)))
    return tuple(goals)
