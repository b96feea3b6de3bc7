"""Two transitions per episode: the pick (premotion, up to lift-off) and the place (motion, up to exit)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.abstraction import Classifier, GripperRule, abstract_recording
from symskill_pddl.demos import Demo
from symskill_pddl.learning.relations import Label, Relations
from symskill_pddl.learning.report import LeftOut
from symskill_pddl.symbols import GRIPPER_OPEN, Atom, State

FINGERS_LATE_S = 2.0
"""Fingers that open within this time after a retreat belong to it: a fist, for instance, is often undone only when it is
clear."""

Truth = Mapping[Atom, NDArray[np.bool_]]


@dataclass(frozen=True, eq=False)
class Transition:
    """One operator seen once: samples [begin, end] of a demonstration.

    Attributes
    ----------
    moves : bool
        False for the premotion, True for the motion.
    label : Label
    begin, end : int
        Samples of s0 and s1.
    before, after : State
        s0 and s1.
    during : State
        What holds at every sample of [begin, end).
    args : tuple of str
        Moved object, then the reference; then the part that the hand acts on, if that is not the moved object.
    left : bool
        False if the recording ends before the hand has left what it moved.
    """

    moves: bool
    label: Label
    begin: int
    end: int
    before: State
    after: State
    during: State
    args: tuple[str, ...]
    left: bool = True

    @property
    def demo(self) -> Demo:
        return self.label.episode.demo

    @property
    def duration_s(self) -> float:
        return float(self.demo.times[self.end] - self.demo.times[self.begin])


def gripper_rule(demos: Sequence[Demo]) -> GripperRule:
    """`gripper-open` for this hand: three quarters of its widest opening, down to 60 %."""
    widest = max(float(np.quantile(d.aperture, 0.98)) for d in demos)
    return GripperRule(round(0.75 * widest, 4), round(0.60 * widest, 4)) if widest > 0.005 else GripperRule()


def truth_of(demo: Demo, classifiers: Sequence[Classifier], gripper: GripperRule) -> Truth:
    """The truth (n,) of every atom that ever holds in a demonstration."""
    return abstract_recording(
        demo.objects,
        demo.T_world_ee,
        demo.aperture,
        demo.gripper_closed,
        demo.T_world_objects,
        classifiers,
        gripper=gripper,
        seen=demo.seen,
    )


def exclusive(truth: Truth, classifiers: Sequence[Classifier]) -> Truth:
    """The same with every object at one place at a time: where several hold, the narrowest counts.

    What lies on a plate lies, for a wide and flat predicate, on the counter too, if only a few millimetres too high; an operator
    that puts it on the plate is not one that puts it on the counter.
    """
    size = {
        c.predicate.name: float(np.sqrt(np.linalg.det(c.cov_p)) * c.enter_p**3)
        for c in classifiers
        if len(c.predicate.types) == 2
    }
    result, taken = dict(truth), dict[str, NDArray[np.bool_]]()
    for atom in sorted((a for a in truth if a.predicate in size), key=lambda a: (size[a.predicate], a)):
        before = taken.get(atom.args[0], np.zeros_like(truth[atom]))
        result[atom] = truth[atom] & ~before
        taken[atom.args[0]] = before | truth[atom]
    return result


def never_shared(truths: Iterable[Truth]) -> frozenset[str]:
    """The predicates of two arguments of which no sample shows two atoms with the same second argument: one lid on a pan."""
    seen, shared = set[str](), set[str]()
    for truth in truths:
        taken: dict[tuple[str, str], NDArray[np.bool_]] = {}
        for atom, holds in truth.items():
            if len(atom.args) != 2:
                continue
            seen.add(atom.predicate)
            place = atom.predicate, atom.args[1]
            if place in taken and (taken[place] & holds).any():
                shared.add(atom.predicate)
            taken[place] = taken[place] | holds if place in taken else holds
    return frozenset(seen - shared)


def state_at(truth: Truth, i: int) -> State:
    """The atoms that hold at sample `i`."""
    return frozenset(atom for atom, value in truth.items() if value[i])


def transitions(
    relations: Relations, truths: Mapping[str, Truth], places: Sequence[str], contacts: Sequence[str]
) -> tuple[tuple[Transition, ...], tuple[LeftOut, ...]]:
    """Every transition that shows what its labels say, and a note on each that does not."""
    found: list[Transition] = []
    left_out: list[LeftOut] = []
    free_since: dict[str, int] = {}
    for label in relations.labels:
        e = label.episode
        truth = truths[e.demo.where]
        holds = Atom(contacts[label.contact], (e.obj,))
        start = None if label.start is None or label.start_ref is None else Atom(places[label.start], (e.obj, label.start_ref))
        end = None if label.end is None or label.end_ref is None else Atom(places[label.end], (e.moved, label.end_ref))
        never = np.zeros(len(e.demo), dtype=bool)
        closes = relations.contacts[label.contact].closes
        lift = _first(
            truth.get(holds, never)
            & ~(truth.get(start, never) if start is not None else never)
            & (~truth[Atom(GRIPPER_OPEN)] if closes and Atom(GRIPPER_OPEN) in truth else ~never),
            e.start,
            e.stop,
        )
        begin = max(e.begin, free_since.get(e.demo.where, 0))
        if lift is None:
            left_out.append(LeftOut.of(e, f"{holds} without {start or 'its start'} never shows during the motion"))
            continue
        pick = _transition(truth, False, label, begin, lift, tuple(filter(None, (e.obj, label.start_ref))))
        if start is None or start in pick.before:
            found.append(pick)
        else:
            left_out.append(LeftOut.of(e, f"its approach: {start} does not hold when the hand sets out"))
        if end is None:
            if e.after is None:
                reason = "its end: the recording ends with it in the hand, a pick only"
                left_out.append(LeftOut.of(e, reason, "record on until it is put down"))
            continue
        leaves = ~truth[holds]
        opens = truth.get(Atom(GRIPPER_OPEN), never)
        until = _fingers_until(label, relations.labels)
        if closes and (leaves & opens)[e.stop : until].any():
            leaves = leaves & opens
        exit_ = _first(leaves, e.stop, len(e.demo))
        part = e.obj if e.body is not None else None
        args = tuple(filter(None, (e.moved, label.end_ref, part)))
        last = len(e.demo) - 1
        place = _transition(truth, True, label, lift, last if exit_ is None else exit_, args)
        if exit_ is None:  # what it has brought about shows; how the hand leaves does not
            place = replace(place, left=False)
        free_since[e.demo.where] = place.end
        if end in place.after:
            found.append(place)
        else:
            left_out.append(LeftOut.of(e, f"its end: {end} does not hold when the gripper has left"))
    return tuple(found), tuple(left_out)


def _fingers_until(label: Label, labels: Sequence[Label]) -> int:
    """Up to which sample a change of the fingers still belongs to this episode: a while after its retreat, not into the next
    motion."""
    e = label.episode
    late = int(np.searchsorted(e.demo.times, e.demo.times[min(e.end, len(e.demo) - 1)] + FINGERS_LATE_S))
    following = [other.episode.start for other in labels if other.episode.demo is e.demo and other.episode.start >= e.stop]
    return min([late, len(e.demo), *following])


def _first(mask: NDArray[np.bool_], start: int, stop: int) -> int | None:
    inside = mask[start:stop]
    return start + int(np.argmax(inside)) if inside.any() else None


def _transition(truth: Truth, moves: bool, label: Label, begin: int, end: int, args: tuple[str, ...]) -> Transition:
    span = slice(begin, max(end, begin + 1))
    during = frozenset(atom for atom, value in truth.items() if value[span].all())
    return Transition(moves, label, begin, end, state_at(truth, begin), state_at(truth, end), during, args)
