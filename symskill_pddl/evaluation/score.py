"""How well what was learned agrees with what really happened: episodes, movers, references, predicates, operators.

A move of the truth and a learned episode belong together where they overlap most. A resting place of the truth is an object and,
for what is hinged or slides, a state; the operators that a person would write follow from them: for every kind of move one
operator that gets hold of the thing at its place, and one that brings it to the next.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.abstraction import Classifier, GripperRule, abstract_recording
from symskill_pddl.demos import Demo, Move, Truth
from symskill_pddl.learning.operators import OperatorGroup
from symskill_pddl.learning.segments import Episode
from symskill_pddl.learning.symbolic import Symbolic
from symskill_pddl.scene import GRIPPER
from symskill_pddl.symbols import GRIPPER_OPEN, Atom

Kind = tuple[str, ...]
"""What moves of one kind share: 'pick' or 'place', the type moved, and where from or to in types and states."""


@dataclass(frozen=True)
class Score:
    """Counts and errors over a set of demonstrations.

    Attributes
    ----------
    moves, found, spurious : int
        Moves of the truth, those that an episode covers, and episodes that no move stands behind.
    boundary_errors_s : tuple of float
        Of every found move, start and stop: learned less true [s].
    movers, references : (int, int)
        How many are right, of how many: of every move its object, and of every resting place its reference.
    frames : (int, int, int)
        Samples and relations on which a predicate holds rightly, holds wrongly, and fails to hold.
    operators : dict of Kind to bool
        The operators that a person would write, and whether each was learned as one operator with the right effects.
    tasks : dict of str to bool
        Whether all operators of a task were.
    extra_operators : tuple of str
        Learned operators that are none of them.
    """

    moves: int
    found: int
    spurious: int
    boundary_errors_s: tuple[float, ...]
    movers: tuple[int, int]
    references: tuple[int, int]
    frames: tuple[int, int, int] = (0, 0, 0)
    operators: Mapping[Kind, bool] = field(default_factory=dict)
    tasks: Mapping[str, bool] = field(default_factory=dict)
    extra_operators: tuple[str, ...] = ()

    @property
    def precision(self) -> float:
        """Of the samples on which a predicate holds, the fraction on which it should; 1 if it never holds."""
        right, wrong, _ = self.frames
        return right / (right + wrong) if right + wrong else 1.0

    @property
    def recall(self) -> float:
        """Of the samples on which a relation holds, the fraction on which its predicate does; 1 if there is none."""
        right, _, missed = self.frames
        return right / (right + missed) if right + missed else 1.0

    def within(self, seconds: float) -> float:
        """Fraction of boundaries at most this far off."""
        errors = np.abs(self.boundary_errors_s)
        return float(np.mean(errors <= seconds + 1e-9)) if len(errors) else 0.0


def score(found: Symbolic, truths: Mapping[str, Truth], unseen: Sequence[tuple[Demo, Truth]] = ()) -> Score:
    """Compare what was learned with the truth by demonstration (`Demo.where`).

    Parameters
    ----------
    found : Symbolic
    truths : dict of str to Truth
        Of every demonstration that was learned from.
    unseen : sequence of (Demo, Truth)
        Demonstrations that predicates are judged on instead of those.
    """
    episodes: dict[str, list[Episode]] = defaultdict(list)
    for e in found.episodes:
        episodes[e.demo.where].append(e)
    labels = {(x.episode.demo.where, x.episode.obj, x.episode.stop): (x.start_ref, x.end_ref) for x in found.relations.labels}
    errors: list[float] = []
    movers = matched = moves = rests = at_right = 0
    for demo in found.demos:
        own = episodes[demo.where]
        for move in truths[demo.where].moves:
            moves += 1
            true_rests = [place for place in (move.before, move.after) if place is not None]
            rests += len(true_rests)
            covering = _covering(move, own)
            if covering is None:
                continue
            matched += 1
            own.remove(covering)
            movers += move.obj in (covering.obj, covering.moved)
            begins, ends = demo.times[covering.start], demo.times[min(covering.stop, len(demo) - 1)]
            errors += [float(begins) - move.start_s, float(ends) - move.stop_s]
            refs = labels.get((demo.where, covering.obj, covering.stop), (None, None))
            at_right += sum(true is not None and ref == true for ref, true in zip(refs, (move.before, move.after), strict=True))
    operators, extra = _operators(found, truths)
    return Score(
        moves=moves,
        found=matched,
        spurious=sum(len(own) for own in episodes.values()),
        boundary_errors_s=tuple(errors),
        movers=(movers, moves),
        references=(at_right, rests),
        frames=predicate_frames(found.classifiers, found.gripper, unseen or [(d, truths[d.where]) for d in found.demos]),
        operators=operators,
        tasks={
            task: all(operators[kind] for d in found.demos if d.task == task for kind in _kinds_of(d, truths[d.where]))
            for task in dict.fromkeys(d.task for d in found.demos)
        },
        extra_operators=extra,
    )


def _covering(move: Move, episodes: Sequence[Episode]) -> Episode | None:
    """The episode that shares most time with a move, at least half of the shorter of the two."""

    def shared(e: Episode) -> float:
        start, stop = float(e.demo.times[e.start]), float(e.demo.times[e.stop - 1])
        overlap = min(stop, move.stop_s) - max(start, move.start_s)
        return overlap / max(min(stop - start, move.stop_s - move.start_s), 1e-3)

    best = max(episodes, key=shared, default=None)
    return best if best is not None and shared(best) >= 0.5 else None


# ------------------------------------------------------------------------------------------------------------- predicates


def predicate_frames(
    classifiers: Sequence[Classifier], gripper: GripperRule, judged: Sequence[tuple[Demo, Truth]]
) -> tuple[int, int, int]:
    """Samples on which predicates hold rightly, hold wrongly, and fail to hold, over all relations that were learned.

    ``at`` is what all predicates of a pair of types say together; a state (``open``) is what that one of them says which agrees
    with it best.
    """
    totals: dict[tuple[str, str, str], NDArray[np.int64]] = defaultdict(lambda: np.zeros(3, dtype=np.int64))
    per_predicate: dict[tuple[str, str, str], dict[str, NDArray[np.int64]]] = defaultdict(dict)
    for demo, truth in judged:
        learned = abstract_recording(demo, classifiers, gripper)
        for (kind, obj, ref), true in truth.relations.items():
            if obj not in demo.objects or ref not in demo.objects:
                continue
            types = demo.objects[obj], demo.objects[ref]
            names = [c.predicate.name for c in classifiers if (c.child, c.parent) == types and c.child != GRIPPER]
            if not names:
                continue
            values = {n: learned.get(Atom(n, (obj, ref)), np.zeros(len(demo), dtype=bool)) for n in names}
            key = (kind, *types)
            if kind == "at":
                totals[key] += _confusion(np.any(list(values.values()), axis=0), true)
            else:
                for name, value in values.items():
                    own = per_predicate[key].setdefault(name, np.zeros(3, dtype=np.int64))
                    own += _confusion(value, true)
    for key, options in sorted(per_predicate.items()):
        totals[key] += max((options[n] for n in sorted(options)), key=_f1)
    right, wrong, missed = np.sum(list(totals.values()), axis=0).tolist() if totals else (0, 0, 0)
    return int(right), int(wrong), int(missed)


def _confusion(value: NDArray[np.bool_], true: NDArray[np.bool_]) -> NDArray[np.int64]:
    return np.array([np.sum(value & true), np.sum(value & ~true), np.sum(~value & true)], dtype=np.int64)


def _f1(confusion: NDArray[np.int64]) -> float:
    right, wrong, missed = (float(x) for x in confusion)
    return 2.0 * right / max(2 * right + wrong + missed, 1)


# -------------------------------------------------------------------------------------------------------------- operators


def _kinds(demo: Demo, move: Move) -> Iterator[Kind]:
    """The operators that a person would write for a move; what is hinged is taken and moved in its own way from each state to
    each."""
    type_ = demo.objects[move.obj]
    way = (move.state_before, move.state_after) if move.state_before or move.state_after else ()
    if move.before is not None:
        yield ("pick", type_, demo.objects[move.before], *way)
    if move.after is not None:
        yield ("place", type_, demo.objects[move.after], *way)


def _kinds_of(demo: Demo, truth: Truth) -> list[Kind]:
    return [kind for move in truth.moves for kind in _kinds(demo, move)]


def _operators(found: Symbolic, truths: Mapping[str, Truth]) -> tuple[dict[Kind, bool], tuple[str, ...]]:
    """Which of the operators that the truth asks for were learned, and which learned ones nothing asks for."""
    shows: dict[str, list[Kind | None]] = {}
    for group in found.groups:
        shows[group.learned.operator.name] = [_shown(t.demo, t.moves, t.label.episode, truths) for t in group.transitions]
    wanted = sorted({kind for demo in found.demos for kind in _kinds_of(demo, truths[demo.where])})
    seen = Counter(kind for demo in found.demos for kind in _kinds_of(demo, truths[demo.where]))
    recovered, used = {}, set()
    for kind in wanted:
        good = [
            group
            for group in found.groups
            if 2 * shows[group.learned.operator.name].count(kind) > seen[kind]
            and 5 * shows[group.learned.operator.name].count(kind) >= 4 * len(group.transitions)
            and _right_effects(group, kind, found.classifiers)
        ]
        recovered[kind] = bool(good)
        used |= {group.learned.operator.name for group in good}
    return recovered, tuple(name for name in shows if name not in used)


def _shown(demo: Demo, moves: bool, e: Episode, truths: Mapping[str, Truth]) -> Kind | None:
    """What a transition shows in truth: the operator of the move that its episode covers."""
    own = [m for m in truths[demo.where].moves if _covering(m, [e]) is e]
    if not own or own[0].obj not in (e.obj, e.moved):
        return None
    what = "place" if moves else "pick"
    return next((kind for kind in _kinds(demo, own[0]) if kind[0] == what), None)


def _right_effects(group: OperatorGroup, kind: Kind, classifiers: Sequence[Classifier]) -> bool:
    """Whether an operator adds and deletes what its kind says: hold of the thing, and its place at what it rests at."""
    op, (what, type_, ref, *_) = group.learned.operator, kind
    contacts = {c.predicate.name for c in classifiers if c.child == GRIPPER}
    places = {c.predicate.name for c in classifiers if (c.child, c.parent) == (type_, ref)}
    adds, deletes = ({a.predicate for a in atoms if a.predicate != GRIPPER_OPEN} for atoms in (op.add, op.delete))
    gained, lost = (contacts, places) if what == "pick" else (places, contacts)
    return len(adds & gained) == 1 and adds <= gained and len(deletes & lost) >= 1 and deletes <= lost
