"""Readable names, derived from types and geometry alone: unique, and the same for the same data."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise

import numpy as np

from symskill_pddl.demos import Demo
from symskill_pddl.errors import LearningError
from symskill_pddl.learning.hints import Hints, moment
from symskill_pddl.learning.references import Extents
from symskill_pddl.learning.relations import Label, Place, Relations
from symskill_pddl.symbols import Predicate

MIRRORED = 0.3
"""Two ways to turn or slide that differ by less than this [rad or m] but for the side are called alike."""
TURN_IN_PLACE_M = 0.12
"""What the gripper turns this near to its hinge is a knob or a lever; farther away, a door."""


def slug(text: str) -> str:
    """A type's name as part of a PDDL name: lower case, letters, digits and single hyphens, a letter first."""
    plain = re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")
    return plain if plain[:1].isalpha() else f"t-{plain}"


def unique(names: Iterable[str]) -> tuple[str, ...]:
    """The names in order, repeated ones numbered from 2; a number never collides with a name that is there already."""
    names = list(names)
    taken, out = set(names), []
    seen: dict[str, int] = {}
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        chosen = name
        while seen[name] > 1 and (chosen := f"{name}-{seen[name]}") in taken:
            seen[name] += 1
        taken.add(chosen)
        out.append(chosen)
    return tuple(out)


def place_names(relations: Relations, extents: Extents, closed: Mapping[str, int] | None = None) -> tuple[str, ...]:
    """One name per place: `door-closed`, `door-ajar`, `door-open`, `food-in-cabinet`, `food-on-counter`.

    `closed` is, by type, the place that a person calls closed.
    """
    names = [""] * len(relations.places)
    for pair in sorted({p.types for p in relations.places}):
        of_pair = [i for i, p in enumerate(relations.places) if p.types == pair and not p.held]
        for i, place in enumerate(relations.places):
            if place.types == pair and place.held:
                names[i] = f"{slug(pair[0])}-above-{slug(pair[1])}"
        if not of_pair:
            continue
        if relations.places[of_pair[0]].joint is None:
            made = _positions(relations.places, of_pair, extents)
        elif pair[0] in (closed or {}) or all(t in extents for t in pair):
            made = _states(relations, of_pair, (closed or {}).get(pair[0]))
        else:
            made = _coordinates(relations, of_pair)
        for i, name in made.items():
            names[i] = name
    # a hinged type with two reference types: say which
    for i, place in enumerate(relations.places):
        if place.joint is not None and any(
            n == names[i] and p.types != place.types for n, p in zip(names, relations.places, strict=True)
        ):
            names[i] = f"{names[i]}-at-{slug(place.types[1])}"
    return unique(names)


def closed_places(demos: Sequence[Demo], relations: Relations, hints: Hints) -> dict[str, int]:
    """By type, the place that an object of it is at, at the moment that a hint calls closed.

    Raises
    ------
    LearningError
        If it is at no place then.
    """
    found = {}
    for type_, text in sorted(hints.closed.items()):
        where, time = moment(text)
        demo = next(d for d in demos if d.where == where)
        at = min(int(np.searchsorted(demo.times, demo.times[0] + time)), len(demo) - 1)
        margins = {
            i: float(p.shape.classifier(Predicate("place", p.types), *p.types).margin(T))
            for i, p in enumerate(relations.places)
            if p.types[0] == type_ and p.joint is not None
            for ref, t in demo.objects.items()
            for obj, own in demo.objects.items()
            if (own, t) == p.types and obj != ref
            for T in [demo.pose(ref)[at].inverse() @ demo.pose(obj)[at]]
        }
        best = max(margins, key=lambda i: margins[i], default=None)
        if best is None or margins[best] < 0.0:
            raise LearningError(f"hint closed.{type_}: at {text} no {type_} rests in a state that the demonstrations show")
        found[type_] = best
    return found


def _states(relations: Relations, members: Sequence[int], closed: int | None) -> dict[int, str]:
    """Joint positions in words, by their distance from the closed one, or from the reference's own orientation (or origin).

    Positions that are equally far, as of doors that open to the left and to the right, are called alike.
    """
    places = relations.places
    child = slug(places[members[0]].types[0])

    def opening(i: int) -> float:
        p = places[i]
        if closed is not None:
            return abs(p.coordinate - places[closed].coordinate)
        return abs(p.coordinate) if p.joint is not None and p.joint.kind == "hinge" else float(np.linalg.norm(p.shape.T_mean.p))

    ranked = sorted(members, key=lambda i: (opening(i), i))
    least, between, most = ("unturned", "half-turned", "turned") if _turns(relations, members) else ("closed", "ajar", "open")
    if len(ranked) == 1:
        joint = places[ranked[0]].joint
        shut = ranked[0] == closed or joint is None or joint.kind == "slide" or opening(ranked[0]) < np.radians(20.0)
        return {ranked[0]: f"{child}-{least if shut else most}"}
    levels = [0]
    for a, b in pairwise(ranked):
        mirrored = places[a].coordinate * places[b].coordinate < 0.0 and opening(b) - opening(a) < MIRRORED
        levels.append(levels[-1] + (not mirrored))
    words = [least, *[between if k == 1 else f"{between}-{k}" for k in range(1, levels[-1])], most]
    return {i: f"{child}-{words[level] if levels[-1] else most}" for i, level in zip(ranked, levels, strict=True)}


def _coordinates(relations: Relations, members: Sequence[int]) -> dict[int, str]:
    """Joint positions as angles or lengths from the one that motions begin at most often: nothing says which one is closed."""
    places, begins = relations.places, Counter(label.start for label in relations.labels)
    first = min(members, key=lambda i: (-begins[i], -len(places[i].demos), i))
    names = {}
    for i in members:
        away, joint = abs(places[i].coordinate - places[first].coordinate), places[i].joint
        hinge = joint is not None and joint.kind == "hinge"
        names[i] = f"{slug(places[i].types[0])}-at-" + (f"{np.degrees(away):.0f}deg" if hinge else f"{100 * away:.0f}cm")
    return names


def _turns(relations: Relations, members: Sequence[int]) -> bool:
    """Whether the gripper acts near the hinge's axis."""
    arms = []
    for label in relations.labels:
        at = label.end if label.end in members else label.start
        if at is None or at not in members:
            continue
        place = relations.places[at]
        if place.joint is None or place.joint.kind != "hinge":
            return False
        grip = place.shape.T_mean.apply(relations.contacts[label.contact].shape.T_mean.p) - place.joint.point
        arms.append(float(np.linalg.norm(grip - place.joint.axis * (grip @ place.joint.axis))))
    return bool(arms) and float(np.median(arms)) < TURN_IN_PLACE_M


def _positions(places: Sequence[Place], members: Sequence[int], extents: Extents) -> dict[int, str]:
    """Free rests: in, on or at, and low or high where the heights tell several apart."""
    names = {}
    ranked = sorted(members, key=lambda i: (round(float(places[i].shape.T_mean.p[2]), 3), *places[i].shape.T_mean.p.tolist()))
    for rank, i in enumerate(ranked):
        child, ref = places[i].types
        name = f"{slug(child)}-{_preposition(places[i], extents)}-{slug(ref)}"
        if len(ranked) == 2 and np.ptp([places[k].shape.T_mean.p[2] for k in ranked]) > 0.03:
            name += ("-low", "-high")[rank]
        elif len(ranked) > 1:
            name += f"-{rank + 1}"
        names[i] = name
    return names


def _preposition(place: Place, extents: Extents) -> str:
    half = extents.get(place.types[1])
    if half is None:
        return "at"
    p = place.shape.T_mean.p
    if np.all(np.abs(p) <= np.array(half)):
        return "in"
    return "on" if p[2] > half[2] and np.all(np.abs(p[:2]) <= np.array(half[:2])) else "at"


def contact_names(relations: Relations, places: Sequence[str]) -> tuple[str, ...]:
    """One name per contact: `gripper-holds-food`, `gripper-at-door`.

    Several ways to act on one hinged type are told apart by where they lead (`gripper-at-door-to-close`), or else by
    where they begin (`gripper-holds-door-from-open`).
    """
    bases = [f"gripper-{'holds' if c.held else 'at'}-{slug(c.type)}" for c in relations.contacts]
    names = list(bases)
    for base in sorted(set(bases)):
        rivals = [k for k, b in enumerate(bases) if b == base]
        if len(rivals) > 1 and relations.contacts[rivals[0]].articulated:
            ways = [_way(relations, k, places) for k in rivals]
            ends, starts = [f"to-{_verb(end)}" for _, end in ways], [f"from-{start}" for start, _ in ways]
            if len(set(ends)) == len(ends):
                words = ends
            elif len(set(starts)) == len(starts):
                words = starts
            else:
                words = [f"{start}-{end}" for start, end in zip(starts, ends, strict=True)]
            for k, word in zip(rivals, words, strict=True):
                names[k] = f"{base}-{word}"
    return unique(names)


def _way(relations: Relations, contact: int, places: Sequence[str]) -> tuple[str, str]:
    """In words, where a contact's episodes begin and lead: the same for all of them if the type is hinged."""
    label = next(label for label in relations.labels if label.contact == contact)
    type_ = relations.contacts[contact].type
    start = _state(places[label.start], type_) if label.start is not None else "elsewhere"
    return start, _state(places[label.end], type_) if label.end is not None else "away"


def _state(place: str, type_: str) -> str:
    """What a place's name says beyond the object's type: `closed`, `in-cabinet`."""
    return place.removeprefix(f"{slug(type_)}-")


def _verb(state: str) -> str:
    return {"closed": "close", "turned": "turn", "unturned": "turn-back", "half-turned": "half-turn"}.get(state, state)


def operator_name(label: Label, moves: bool, relations: Relations, places: Sequence[str]) -> tuple[str, str]:
    """Name and kind of an operator: 'pick' or 'reach' before the motion, 'place' or 'move' for it (`moves`)."""
    contact = relations.contacts[label.contact]
    type_ = slug(contact.type)
    if not moves:
        state = None if label.start is None else _state(places[label.start], contact.type)
        if contact.articulated:
            return f"reach-{type_}" + (f"-{state}" if state else ""), "reach"
        if contact.held:
            return f"pick-{type_}" + (f"-from-{_without_preposition(state)}" if state else ""), "pick"
        return f"reach-{type_}" + (f"-{state}" if state else ""), "reach"
    type_ = slug(label.episode.moved_type)
    if label.end is not None and relations.places[label.end].held:
        return f"lift-{type_}", "move"
    state = _state(places[label.end], label.episode.moved_type) if label.end is not None else "away"
    if contact.articulated or label.episode.body is not None:
        verb = _verb(state)
        if verb in ("open", "close", "turn"):
            return f"{verb}-{type_}", "move"
        return (f"turn-{type_}-back" if verb == "turn-back" else f"move-{type_}-{state}"), "move"
    return (f"place-{type_}-{state}", "place") if contact.held else (f"push-{type_}-{state}", "move")


def operator_names(
    labels: Sequence[tuple[Label, bool]], relations: Relations, places: Sequence[str], contacts: Sequence[str]
) -> tuple[str, ...]:
    """Unique names of operators, given by a label and whether it `moves`; equal ones are told apart by their contact first."""
    names = [operator_name(label, moves, relations, places)[0] for label, moves in labels]
    clear = []
    for name, (label, _) in zip(names, labels, strict=True):
        contact = relations.contacts[label.contact]
        words = (
            contacts[label.contact].removeprefix("gripper-holds-").removeprefix("gripper-at-").removeprefix(slug(contact.type))
        )
        clear.append(name + words if names.count(name) > 1 else name)
    return unique(clear)


def _without_preposition(state: str) -> str:
    return re.sub(r"^(in|on|at)-", "", state)


def parameter_names(objects: Sequence[str], types: Mapping[str, str]) -> dict[str, str]:
    """A variable for each object by its type: ``?food``, ``?food-2`` for the second of a type."""
    names = unique(f"?{slug(types[o])}" for o in objects)
    return dict(zip(objects, names, strict=True))
