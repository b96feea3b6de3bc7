"""From a library's learned goals (lifted atoms) to the ground atoms of one episode."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.library import Goal, Library
from symskill_pddl.symbols import Atom, Domain, State, Type


def goal_atoms(library: Library, goals: Sequence[tuple[str, Sequence[str]]], objects: Mapping[str, str]) -> State:
    """The goal of an episode: the learned goals of demonstrated tasks together, bound to the episode's objects.

    Parameters
    ----------
    library : Library
        Its `goals` are what the demonstrations of each task ended with.
    goals : sequence of (str, sequence of str)
        The demonstrated tasks that make up the episode's task, one for an atomic task, each with the objects that it is about.
    objects : mapping of str to str
        Type of every object of the episode.

    Raises
    ------
    InputError
        The library has no goal for a task, or a variable of a goal has no object or several.
    """
    learned = {goal.task: goal for goal in library.goals}
    atoms: set[Atom] = set()
    for task, focus in goals:
        if task not in learned:
            raise InputError(
                f"the library has learned no goal for task '{task}', state one with --goal; it has: {alternatives(learned)}"
            )
        atoms |= bind_goal(learned[task], objects, focus, library.types)
    return frozenset(atoms)


def resting_atoms(library: Library, goals: Sequence[tuple[str, str]], objects: Mapping[str, str]) -> State:
    """The goal that things rest where they are said to: for each (thing, place) the learned relation of their types.

    Raises
    ------
    InputError
        The library has no relation of the two types, or several.
    """
    atoms: set[Atom] = set()
    for thing, where in goals:
        found = [c.predicate.name for c in library.classifiers if (c.child, c.parent) == (objects.get(thing), objects.get(where))]
        if len(found) != 1:
            what = f"several ({alternatives(found)})" if found else "none"
            raise InputError(
                f"'{thing}' at '{where}' needs one learned relation of their types, the library has {what}; use --goal"
            )
        atoms.add(Atom(found[0], (thing, where)))
    return frozenset(atoms)


def bind_goal(goal: Goal, objects: Mapping[str, str], focus: Sequence[str], types: Iterable[Type]) -> State:
    """Bind each variable of a lifted goal to an object: what the task is about first, else the only object of the type.

    Raises
    ------
    InputError
        No object fits a variable, or several do and none of them is in focus.
    """
    is_a = Domain("goal", tuple(types), (), ()).is_a
    binding: dict[str, str] = {}
    for parameter in goal.parameters:
        free = [o for o in objects if o not in binding.values() and is_a(objects[o], parameter.type)]
        chosen = [o for o in focus if o in free][:1] or free
        if len(chosen) != 1:
            what = f"no {parameter.type}" if not chosen else f"several objects of type {parameter.type} ({alternatives(chosen)})"
            raise InputError(
                f"goal of task '{goal.task}': the episode has {what} for {parameter.name}; state the goal with --goal"
            )
        binding[parameter.name] = chosen[0]
    return frozenset(atom.substitute(binding) for atom in goal.atoms)
