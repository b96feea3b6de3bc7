"""Two transitions per episode: the pick (premotion, up to lift-off) and the place (motion, up to exit)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.abstraction import GripperRule
from symskill_pddl.demos import Demo
from symskill_pddl.learning.parts import continues
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
    """`gripper-open` for this hand: as far apart as hands that are told to open were seen to be, but for a tenth.

    Some recordings begin with a hand that is half open. Three quarters of the widest opening are enough in any case, a quarter
    never is.
    """
    widest = max(float(np.quantile(d.aperture, 0.98)) for d in demos)
    told = [float(d.aperture[0]) for d in demos if not d.gripper_closed[0]]
    above = round(float(np.clip(0.9 * min(told, default=widest), 0.25 * widest, 0.75 * widest)), 4)
    return GripperRule(above, round(0.8 * above, 4)) if widest > 0.0 else GripperRule()


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
    """Every transition that shows what its labels say, and what was left out because it does not."""
    found: list[Transition] = []
    left_out: list[LeftOut] = []
    free_since: dict[str, int] = {}
    for label in relations.labels:
        e = label.episode
        seen = _Seen(label, truths[e.demo.where], relations, places, contacts)
        lift = e.start if e.before is None or continues(e) else seen.lift()
        if lift is None:
            left_out.append(LeftOut.of(e, f"{seen.holds} without {seen.start or 'its start'} never shows during the motion"))
            continue
        if e.before is not None and not continues(e):
            pick = seen.pick(max(e.begin, free_since.get(e.demo.where, 0)), lift)
            if seen.start is None or seen.start in pick.before:
                found.append(pick)
            else:
                left_out.append(LeftOut.of(e, f"its approach: {seen.start} does not hold when the hand sets out"))
        if seen.end is None:
            if e.after is None:
                reason = "its end: the recording ends with it in the hand, a pick only"
                left_out.append(LeftOut.of(e, reason, "record on until it is put down"))
            continue
        place = seen.place(lift)
        free_since[e.demo.where] = place.end
        if seen.end in place.after:
            found.append(place)
        else:
            left_out.append(LeftOut.of(e, f"its end: {seen.end} does not hold when the gripper has left"))
    return tuple(found), tuple(left_out)


@dataclass(frozen=True, eq=False)
class _Seen:
    """One labelled episode in the atoms of its recording."""

    label: Label
    truth: Truth
    relations: Relations
    places: Sequence[str]
    contacts: Sequence[str]

    @property
    def holds(self) -> Atom:
        return Atom(self.contacts[self.label.contact], (self.label.episode.obj,))

    @property
    def start(self) -> Atom | None:
        at, ref = self.label.start, self.label.start_ref
        return None if at is None or ref is None else Atom(self.places[at], (self.label.episode.obj, ref))

    @property
    def end(self) -> Atom | None:
        at, ref = self.label.end, self.label.end_ref
        return None if at is None or ref is None else Atom(self.places[at], (self.label.episode.moved, ref))

    @property
    def closes(self) -> bool:
        return self.relations.contacts[self.label.contact].closes

    def along(self, atom: Atom | None) -> NDArray[np.bool_]:
        """The truth (n,) of an atom, which may never hold."""
        found = self.truth.get(atom) if atom is not None else None
        return found if found is not None else np.zeros(len(self.label.episode.demo), dtype=bool)

    def lift(self) -> int | None:
        """The first sample at which the object has left its place with the hand."""
        e, ready = self.label.episode, self.along(self.holds) & ~self.along(self.start)
        if self.closes:
            ready = ready & ~self.along(Atom(GRIPPER_OPEN))
        return _first(ready, e.start, e.stop)

    def pick(self, begin: int, lift: int) -> Transition:
        """From when the hand sets out, or the object has come to rest: in the first moments of a recording things may fall."""
        begin = begin if self.start is None else _first(self.along(self.start), begin, self.label.episode.start) or begin
        args = tuple(filter(None, (self.label.episode.obj, self.label.start_ref)))
        return self._transition(False, begin, lift, args)

    def place(self, lift: int) -> Transition:
        """Up to where the hand has left; what is not put down ends with the recording."""
        e = self.label.episode
        held = e.after is not None and e.after.held
        last = (e.after.stop if e.after is not None and held else len(e.demo)) - 1
        leaves, until = ~self.along(self.holds), _fingers_until(self.label, self.relations.labels)
        released = leaves & self.along(Atom(GRIPPER_OPEN))
        if self.closes and released[e.stop : until].any():
            leaves = released
        exit_ = None if held else _first(leaves, e.stop, last + 1)
        args = tuple(filter(None, (e.moved, self.label.end_ref, e.obj if e.body is not None else None)))
        if exit_ is None:  # what it has brought about shows; how the hand leaves does not
            return replace(self._transition(True, lift, last, args), left=False)
        let_go = _first(~self.along(self.holds), e.stop, last + 1)
        return self._transition(True, lift, max(exit_, e.leave or 0), args, let_go)

    def _transition(self, moves: bool, begin: int, end: int, args: tuple[str, ...], until: int | None = None) -> Transition:
        """`until`: up to where what it maintains has to hold, if not to its end."""
        span = slice(begin, max(end if until is None else until, begin + 1))
        during = frozenset(atom for atom, value in self.truth.items() if value[span].all())
        return Transition(moves, self.label, begin, end, state_at(self.truth, begin), state_at(self.truth, end), during, args)


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
