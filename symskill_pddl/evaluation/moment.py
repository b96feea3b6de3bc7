"""A moment of a recording as a planning problem: for who has demonstrations and no simulator."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from symskill_pddl.abstraction import abstract_recording, one_place_along
from symskill_pddl.demos import Demo, load_demos
from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.evaluation.goals import goal_atoms
from symskill_pddl.evaluation.trial import stated_goal
from symskill_pddl.execution.recovery import Assumption, nearest_symbols
from symskill_pddl.library import Library
from symskill_pddl.symbols import GRIPPER_OPEN, Atom, Domain, Problem, State

FORM = "FILE:demo_0@2.5s"
_END = ("end", "END")


@dataclass(frozen=True)
class Address:
    """A moment: a file, a demonstration in it (empty: the only one), and seconds since its beginning (None: its end)."""

    file: Path
    demo: str
    at_s: float | None

    @classmethod
    def parse(cls, text: str) -> Address:
        """From ``FILE:demo_0@2.5s``; without a time the beginning is meant, with ``@END`` the end.

        Raises
        ------
        InputError
            If there is no file name, or the time is none.
        """
        rest, at, time = text.rpartition("@")
        if not at or "/" in time:
            rest, time = text, "0"
        # a path of Windows has a colon, too
        file, colon, demo = rest.rpartition(":")
        if not colon or "/" in demo or "\\" in demo or len(file) <= 1:
            file, demo = rest, ""
        if not file:
            raise InputError(f"'{text}' names no file; a moment is {FORM}")
        return cls(Path(file), demo, at_time(time, text))


@dataclass(frozen=True)
class Moment:
    """A problem, and what a person should know of it."""

    problem: Problem
    domain: Domain
    assumed: tuple[Assumption, ...]
    notes: tuple[str, ...]


def at_time(text: str, whole: str) -> float | None:
    """A time like ``2.5s`` or ``2.5``; None for ``END``.

    Raises
    ------
    InputError
        If it is none.
    """
    if text in _END:
        return None
    found = re.fullmatch(r"(\d+(?:\.\d*)?|\.\d+)\s*s?", text.strip(), re.ASCII)
    if found is None or len(text) > 30:
        raise InputError(f"'{whole}': '{text}' is no time in seconds, such as 2.5s, nor END; a moment is {FORM}")
    return float(found[1])


def find_demo(address: Address, demos: Sequence[Demo] | None = None) -> Demo:
    """The demonstration that an address means.

    Raises
    ------
    InputError
        If the file has no such demonstration, or several and none is named.
    """
    if demos is None:
        folder = address.file.parent
        if not address.file.exists() and folder.is_dir():
            near = get_close_matches(address.file.name, [f.name for f in folder.iterdir() if f.is_file()], n=1)
            if near:
                raise InputError(f"'{address.file}' does not exist; is '{folder / near[0]}' meant?")
        demos = load_demos(address.file)
    names = [demo.name for demo in demos]
    if not address.demo and len(demos) > 1:
        raise InputError(
            f"'{address.file}' has {len(demos)} demonstrations, name one, as {address.file}:{names[0]}@0s: {alternatives(names)}"
        )
    if address.demo and address.demo not in names:
        near = get_close_matches(address.demo, names, n=1, cutoff=0.5)
        meant = f"is '{near[0]}' meant? It has" if near else "it has"
        raise InputError(f"'{address.file}' has no demonstration '{address.demo}'; {meant}: {alternatives(names)}")
    return next(demo for demo in demos if not address.demo or demo.name == address.demo)


def sample_at(demo: Demo, at_s: float | None) -> int:
    """The sample that is nearest to a time since the beginning; the last one for None.

    Raises
    ------
    InputError
        If the recording is shorter.
    """
    times = demo.times - demo.times[0]
    if at_s is None:
        return len(demo) - 1
    if at_s > times[-1] + 0.5 * float(np.median(np.diff(times))):
        raise InputError(
            f"'{demo.where}' lasts {times[-1]:g} s, there is no moment {at_s:g}s; the last is {times[-1]:g}s, or END"
        )
    return int(np.abs(times - at_s).argmin())


def state_at(library: Library, demo: Demo, index: int) -> State:
    """The atoms that hold at a sample, seen as they come along."""
    truth = one_place_along(abstract_recording(demo, library.classifiers, library.gripper), library.classifiers)
    return frozenset(atom for atom, holds in truth.items() if holds[index])


def problem_at(library: Library, domain: Domain, demo: Demo, index: int, goal: str | None, goal_index: int | None) -> Moment:
    """The problem of a moment: its objects and atoms, and a goal.

    Parameters
    ----------
    library : Library
    domain : Domain
        The library's.
    demo : Demo
    index : int
        The sample.
    goal : str, optional
        ``(atom object ...) ...``
    goal_index : int, optional
        The sample whose relations of objects are the goal. With neither, the goal is the learned one of the demonstration's task.

    Raises
    ------
    InputError
        If the library knows none of the objects, or the goal does not fit it, or there is none.
    """
    known = {t.name for t in library.types}
    objects = {name: kind for name, kind in demo.objects.items() if kind in known}
    strange = [f"{name} ({kind})" for name, kind in demo.objects.items() if kind not in known]
    if not objects:
        raise InputError(
            f"'{demo.where}': the library knows no type of its objects: {alternatives(strange)}; it knows {alternatives(known)}"
        )
    notes = [f"left out, as the library knows no such type: {', '.join(strange)}"] if strange else []
    scene = demo.scene(index)
    if unseen := sorted(scene.unseen & objects.keys()):
        notes.append(f"not seen at that moment, taken to be where last seen: {', '.join(unseen)}")
    init = state_at(library, demo, index)
    if goal is not None:
        atoms = stated_goal(goal, domain, objects)
    elif goal_index is not None:
        atoms = _shown(library, demo, goal_index, init)
    else:
        atoms = goal_atoms(library, [(demo.task, _moved(demo))], objects)
    nearest = nearest_symbols(scene, init, library.classifiers, objects).values()
    # what is only assumed may not fulfil the goal
    assumed = tuple(best for options in nearest if (best := next((a for a in options if a.atom not in atoms), None)) is not None)
    init |= {a.atom for a in assumed}
    if atoms <= init:
        notes.append("the goal holds already")
    name = re.sub(r"[^a-z0-9]+", "-", f"{demo.source}-{demo.name}-{index}".lower()).strip("-")
    return Moment(Problem(name, domain.name, tuple(objects.items()), init, atoms), domain, assumed, tuple(notes))


def _moved(demo: Demo) -> list[str]:
    """The objects, what moved farthest between beginning and end first."""
    far = np.linalg.norm(demo.T_world_objects.p[-1] - demo.T_world_objects.p[0], axis=1)
    return [list(demo.objects)[i] for i in np.argsort(-far, kind="stable")]


def _shown(library: Library, demo: Demo, index: int, init: State) -> State:
    """What a moment shows as a goal: relations of objects; where they show nothing new, what the hand holds."""
    state = state_at(library, demo, index)
    pairs = frozenset(a for a in state if len(a.args) == 2)
    goal = pairs if pairs - init else pairs | frozenset(a for a in state - init if len(a.args) == 1 and a != Atom(GRIPPER_OPEN))
    if not goal:
        at = demo.times[index] - demo.times[0]
        raise InputError(f"'{demo.where}' shows no relation that the library knows at {at:g}s; state the goal with --goal")
    return goal
