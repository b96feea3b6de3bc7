"""Groups of transitions into operators: effects, strict and refined preconditions, maintain conditions."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symskill_pddl.abstraction import Classifier
from symskill_pddl.demos import Demo
from symskill_pddl.learning.lifting import Lifted, lift
from symskill_pddl.learning.naming import operator_name, operator_names, slug
from symskill_pddl.learning.references import Extents
from symskill_pddl.learning.relations import Relations
from symskill_pddl.learning.report import SHOW_AGAIN, LeftOut
from symskill_pddl.learning.scale import RelationConfig
from symskill_pddl.learning.transitions import Transition
from symskill_pddl.library import Evidence, LearnedOperator
from symskill_pddl.scene import GRIPPER
from symskill_pddl.symbols import GRIPPER_OPEN, Absent, Atom, Operator, Parameter, State


@dataclass(frozen=True, eq=False)
class OperatorGroup:
    """A learned operator and the transitions that it stands for."""

    learned: LearnedOperator
    transitions: tuple[Transition, ...]
    bindings: tuple[dict[str, str], ...]


@dataclass(frozen=True, eq=False)
class Vocabulary:
    """The learned predicates: their geometry, their names, and what was seen of them.

    Attributes
    ----------
    places, contacts : tuple of str
        Names of `relations.places` and `relations.contacts`.
    single : frozenset of str
        Predicates of which a reference never has more than one object (`transitions.never_shared`).
    half_m : float
        Half size [m] of objects whose extents are not known.
    """

    relations: Relations
    classifiers: Sequence[Classifier]
    places: Sequence[str]
    contacts: Sequence[str]
    extents: Extents
    single: frozenset[str] = frozenset()
    half_m: float = 0.03

    def contact(self, t: Transition) -> str:
        """How the hand acts on what it moves."""
        return self.contacts[t.label.contact]

    @property
    def loose(self) -> frozenset[str]:
        """Places of what moves freely."""
        return frozenset(name for name, p in zip(self.places, self.relations.places, strict=True) if p.joint is None)

    @property
    def lifted(self) -> frozenset[str]:
        """Places in the hand, above something."""
        return frozenset(name for name, p in zip(self.places, self.relations.places, strict=True) if p.held)

    def name(self, t: Transition) -> tuple[str, str]:
        """Name and kind of the operator that a transition shows."""
        return operator_name(t.label, t.moves, self.relations, self.places)


def learn_operators(
    found: Sequence[Transition], demos: Sequence[Demo], words: Vocabulary, config: RelationConfig | None = None
) -> tuple[tuple[OperatorGroup, ...], tuple[LeftOut, ...]]:
    """One operator per group of transitions with the same lifted effects, and what was left out."""
    config = config or RelationConfig()
    shown = Counter(demo.task for demo in demos)
    groups: dict[tuple[str, ...], list[Transition]] = defaultdict(list)
    for t in found:
        groups[_effect_of(t, words)].append(t)
    left_out, kept = [], []
    for _, group in sorted(groups.items(), key=lambda item: item[0]):
        if len({t.demo.where for t in group}) == 1 and shown[group[0].demo.task] >= config.odd_of:
            reason = f"{words.name(group[0])[0]}: only one of {shown[group[0].demo.task]} demonstrations of its task shows it"
            left_out += [LeftOut.of(t.label.episode, reason, SHOW_AGAIN) for t in group]
        else:
            left = [t for t in group if t.left]
            left_out += [
                LeftOut.of(t.label.episode, "its end: the recording ends before the hand has left, others show it")
                for t in group
                if left and not t.left
            ]
            kept.append(left or group)
    names = operator_names([(g[0].label, g[0].moves) for g in kept], words.relations, words.places, words.contacts)
    states = [(t, s) for t in found for s in (t.before, t.after)]
    learned = [_operator(name, g, states, words, config) for name, g in zip(names, kept, strict=True)]
    return tuple(_mutex(learned, words.relations, words.places)), tuple(left_out)


def _effect_of(t: Transition, words: Vocabulary) -> tuple[str, ...]:
    """What transitions of one operator share: what is moved, how, and where from or to."""
    label, e = t.label, t.label.episode
    place, ref = (label.end, label.end_ref) if t.moves else (label.start, label.start_ref)
    return (
        e.moved_type if t.moves else e.type,
        "1" if t.moves else "0",
        words.contact(t),
        words.places[place] if place is not None else "",
        t.demo.objects[ref] if ref is not None else "",
    )


def _operator(
    name: str,
    group: Sequence[Transition],
    states: Sequence[tuple[Transition, State]],
    words: Vocabulary,
    config: RelationConfig,
) -> OperatorGroup:
    notes: list[str] = []
    lifted = lift(group)
    label = group[0].label
    goal = Atom(words.contact(group[0]), (lifted.parameters[0].name,))
    if group[0].moves and label.end is not None:
        goal = Atom(words.places[label.end], tuple(p.name for p in lifted.parameters[:2]))
    add, delete = _effects(lifted, group, words, notes)
    if goal not in add:
        # it holds after every transition, but held before some: the hand began near by, or two ways to touch a thing overlap
        add |= {goal}
        notes.append(f"added effect: {goal}, which held before the beginning too in some demonstrations")
    own = lifted.args | {v for atom in add | delete for v in atom.variables}
    positive = _positive(lifted, goal, own, group, words, notes)
    if not all(t.left for t in group) and not (label.episode.after is not None and label.episode.after.held):
        left = Atom(words.contact(group[0]), (lifted.parameters[group[0].args.index(label.episode.obj)].name,))
        notes.append(f"no retreat: the recordings end before the hand has left, so that {left} ends is not seen and no effect")
    absent, told = _negatives(group, lifted, positive, states, words, config)
    notes += told
    variables = own | {v for atom in positive for v in atom.variables}
    during = frozenset(
        atom for atom in lifted.during if set(atom.variables) <= variables and not _coincidence(atom, own, lifted, group, words)
    )
    durations = [t.duration_s for t in group]
    operator = Operator(
        name=name,
        parameters=tuple(p for p in lifted.parameters if p.name in variables),
        pre=frozenset(positive),
        add=add,
        delete=delete,
        maintain=during,
        absent=absent,
        cost=max(round(float(np.mean(durations)), 1), 0.1),
    )
    learned = LearnedOperator(
        operator=operator,
        strict_pre=lifted.pre,
        skill=name,
        kind=words.name(group[0])[1],
        evidence=_evidence(group, lifted, [p.name for p in operator.parameters]),
        duration_s=(float(np.mean(durations)), float(np.max(durations))),
        notes=tuple(notes),
    )
    return OperatorGroup(learned, tuple(group), lifted.bindings)


def _evidence(group: Sequence[Transition], lifted: Lifted, variables: Sequence[str]) -> tuple[Evidence, ...]:
    return tuple(
        Evidence(
            t.demo.where,
            round(float(t.demo.times[t.begin]), 4),
            round(float(t.demo.times[t.end]), 4),
            tuple((v, binding[v]) for v in variables if v in binding),
        )
        for t, binding in zip(group, lifted.bindings, strict=True)
    )


def _effects(
    lifted: Lifted, group: Sequence[Transition], words: Vocabulary, notes: list[str]
) -> tuple[frozenset[Atom], frozenset[Atom]]:
    """The intersections, less what cannot be an effect: a second contact, what the next operator brings about, and coincidences
    where a single transition is all there is."""
    moved = lifted.parameters[0].name
    riders = {
        v
        for binding, t in zip(lifted.bindings, group, strict=True)
        for v, o in binding.items()
        if o in t.label.episode.passengers
    }
    kept: dict[str, set[Atom]] = {"adds": set(), "deletes": set()}
    for what, atoms in (("adds", lifted.add), ("deletes", lifted.delete)):
        for atom in sorted(atoms):
            foreign = atom.predicate in words.contacts and atom.predicate != words.contact(group[0])
            about = not atom.args or moved in atom.args or bool(riders & set(atom.args))
            unbound = what == "adds" and not set(atom.variables) <= lifted.args | {v for a in lifted.pre for v in a.variables}
            early = what == "adds" and not group[0].moves and atom.predicate in words.lifted
            if foreign or unbound or early or (len(group) == 1 and not about):
                reason = "one contact at a time" if foreign else "lifting brings it about" if early else "a coincidence"
                notes.append(f"dropped effect: {what} {atom}: {reason}")
            else:
                kept[what].add(atom)
    # the fingers are told to close: where a recording begins with them half open, this is not seen as a change
    fingers = Atom(GRIPPER_OPEN)
    closes = not group[0].moves and all(t.demo.gripper_closed[t.end] and fingers not in t.after for t in group)
    if closes and fingers not in kept["deletes"]:
        kept["deletes"].add(fingers)
        notes.append(f"added effect: not {fingers}, the fingers close in all its demonstrations")
    return frozenset(kept["adds"]), frozenset(kept["deletes"])


def _positive(
    lifted: Lifted, goal: Atom, own: frozenset[str], group: Sequence[Transition], words: Vocabulary, notes: list[str]
) -> set[Atom]:
    """What held before every transition, less what is no precondition; a hand that closes on a thing was open before."""
    kept = set()
    dropped: dict[str, list[Atom]] = {}
    for atom in sorted(lifted.pre):
        reason = "it is the effect" if atom == goal else _coincidence(atom, own, lifted, group, words)
        if reason:
            dropped.setdefault(reason, []).append(atom)
        else:
            kept.add(atom)
    notes += [f"dropped precondition {' '.join(map(str, atoms))}: {reason}" for reason, atoms in dropped.items()]
    fingers = Atom(GRIPPER_OPEN)
    if not group[0].moves and words.relations.contacts[group[0].label.contact].held and fingers not in kept:
        kept.add(fingers)
        notes.append(f"added precondition: {fingers}, one hand holds one thing")
    return kept


def _coincidence(atom: Atom, own: frozenset[str], lifted: Lifted, group: Sequence[Transition], words: Vocabulary) -> str | None:
    """Why a positive precondition is none, or None if it may be one: a door that is open enables something, food that lies about
    does not."""
    if not atom.args:
        return None
    if not own & set(atom.args):
        return "about nothing that the operator is about"
    if atom.predicate in words.contacts and atom.predicate != words.contact(group[0]):
        return "one contact at a time"
    types = {p.name: p.type for p in lifted.parameters}
    occupant = next((v for v in atom.args[:1] if v not in own), None)
    if occupant is not None and (types[occupant] == lifted.parameters[0].type or atom.predicate in words.loose):
        return f"that another {types[occupant]} lies there enables nothing"
    return None


def _negatives(
    group: Sequence[Transition],
    lifted: Lifted,
    positive: set[Atom],
    states: Sequence[tuple[Transition, State]],
    words: Vocabulary,
    config: RelationConfig,
) -> tuple[frozenset[Absent], list[str]]:
    """Relations of other objects to the operator's own that hold elsewhere in the data but never where it begins, and a note on
    each."""
    found, notes = set(), []
    elsewhere = [s for t, s in states if not any(t is own for own in group)]
    arguments = lifted.parameters[: lifted.n_args]
    for c in words.classifiers:
        if c.child == GRIPPER:
            continue
        siblings = {d.predicate.name for d in words.classifiers if (d.child, d.parent) == (c.child, c.parent)}
        for position, parameter in enumerate(arguments):
            if parameter.type != c.parent:
                continue
            if c.child == arguments[0].type and position > 0 and _room(c, words):
                continue  # others of the moved kind may be there too: there is room
            if any(a.predicate in siblings and a.args[1] == parameter.name for a in positive):
                continue  # where it has to be is a precondition already
            witnesses = _witnesses(group, c.child)
            if len(witnesses) < config.absent_from or any(_related(t, t.before, c, t.args[position]) for t in witnesses):
                continue
            if any(_related_any(s, c) for s in elsewhere):
                variable = "?other" if c.child == arguments[0].type else f"?any-{slug(c.child)}"
                atom = Atom(c.predicate.name, (variable, parameter.name))
                found.add(Absent(atom, (Parameter(variable, c.child),), atom.predicate in words.single))
                notes.append(f"added precondition: no {c.child} with {atom}, as in all its demonstrations")
    return frozenset(found), notes


def _witnesses(group: Sequence[Transition], type_: str) -> list[Transition]:
    """Transitions whose scene holds another object of the type, so that its absence there means something."""
    return [t for t in group if any(has == type_ and o not in t.args for o, has in t.demo.objects.items())]


def _related(t: Transition, state: State, c: Classifier, obj: str) -> bool:
    """Whether some object other than the transition's arguments stands in the relation to `obj`."""
    return any(a.predicate == c.predicate.name and a.args[1] == obj and a.args[0] not in t.args for a in state)


def _related_any(state: State, c: Classifier) -> bool:
    return any(a.predicate == c.predicate.name for a in state)


def _room(c: Classifier, words: Vocabulary) -> bool:
    """Whether two such objects fit into the region that the predicate covers, or beside each other on what they rest at."""
    half = max(words.extents.get(c.child, (words.half_m,) * 3)[:2])
    covered = float(np.sqrt(np.linalg.eigvalsh(c.cov_p)[-1])) * c.enter_p
    return covered > 2.0 * half or max(words.extents.get(c.parent, (0.0, 0.0, 0.0))[:2]) >= 2.0 * half


def _mutex(groups: Sequence[OperatorGroup], relations: Relations, places: Sequence[str]) -> list[OperatorGroup]:
    """Complete what the data did not show: an object comes to one place of a reference, so it is at no other place of it.

    A pick deletes where the object was. Only where some pick of the same contact does not (it began at no known place) can the
    object still count as being there when it is put down; then the place operator deletes the other places of its reference type.
    """
    result = []
    blind = {
        g.transitions[0].label.contact for g in groups if not g.transitions[0].moves and g.transitions[0].label.start is None
    }
    for g in groups:
        label, op = g.transitions[0].label, g.learned.operator
        if not g.transitions[0].moves or label.contact not in blind or label.end is None:
            result.append(g)
            continue
        own = relations.places[label.end]
        args = tuple(p.name for p in op.parameters[:2])
        more = {
            Atom(places[i], args) for i, p in enumerate(relations.places) if p.types == own.types and i != label.end
        } - op.delete
        notes = tuple(f"added effect: not {atom}, an object is at one place of a reference" for atom in sorted(more))
        operator = Operator(op.name, op.parameters, op.pre, op.add, op.delete | more, op.maintain, op.absent, op.cost)
        old = g.learned
        learned = LearnedOperator(
            operator, old.strict_pre, old.skill, old.kind, old.evidence, old.duration_s, (*old.notes, *notes)
        )
        result.append(OperatorGroup(learned, g.transitions, g.bindings))
    return result
