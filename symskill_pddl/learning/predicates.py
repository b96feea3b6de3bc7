"""Rest poses and contacts into predicates without names, and every episode labelled with them.

Each label of an episode - where the object rested, how the gripper acted on it, where it came to rest - is a cluster by
construction, so operators can be grouped without a look at thresholds. What is left out is named in `Relations.left_out`.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from symskill_pddl.demos import Demo
from symskill_pddl.errors import LearningError
from symskill_pddl.geometry import Pose
from symskill_pddl.learning.articulation import Joint, agreed_joint, fit_joint
from symskill_pddl.learning.contacts import labelled
from symskill_pddl.learning.parts import continues
from symskill_pddl.learning.places import Clustered, cluster_pair
from symskill_pddl.learning.references import Extents, Placement, place
from symskill_pddl.learning.relations import Label, Place, PredicateConfig, Relations
from symskill_pddl.learning.segments import Episode, RestKey, rest
from symskill_pddl.learning.shapes import narrowed
from symskill_pddl.symbols import Predicate


def learn_relations(
    demos: Sequence[Demo],
    episodes: Sequence[Episode],
    extents: Extents,
    config: PredicateConfig | None = None,
    answers: Mapping[RestKey, str] | None = None,
) -> Relations:
    """Predicates from the rests and contacts of all episodes.

    `answers` holds, by `Rest.key`, the reference that another selector named.
    """
    config = config or PredicateConfig()
    shown = Counter(demo.task for demo in demos)
    into = Clustered({demo.where: shown[demo.task] >= config.odd_of for demo in demos})
    jointed: dict[str, bool] = {}
    for type_ in sorted({t for e in episodes for t in (e.type, e.moved_type)}):
        own = [e for e in episodes if type_ in (e.type, e.moved_type)]
        found, joints = _placements(demos, own, type_, extents, config, answers)
        jointed[type_] = bool(joints)
        for pair, held in sorted({(p.types, p.rest.held and p.types not in joints) for p in found}):
            rests = [p for p in found if (p.types, p.rest.held and p.types not in joints) == (pair, held)]
            apart = _ends(rests, own, type_) if pair in joints else []
            cluster_pair(rests, joints.get(pair), apart, into, config)
    kept, contacts = labelled(episodes, into, jointed, config)
    tight = tuple(_left_behind(i, place, kept) for i, place in enumerate(into.places))
    references = {rest: ref for rest, (_, ref) in into.of_rest.items()}
    return Relations(tight, contacts, kept, tuple(into.left_out), references)


def _left_behind(index: int, place: Place, labels: Sequence[Label]) -> Place:
    """A place of what moves freely, narrowed so that an object that was lifted from there by a little is not there any more."""
    if place.joint is not None:
        return place
    shape = place.shape
    for label in labels:
        if label.start == index and label.start_ref is not None:
            e = label.episode
            T = e.demo.pose(label.start_ref)[e.start : e.stop].inverse() @ e.demo.pose(e.obj)[e.start : e.stop]
            test = shape.classifier(Predicate("place", place.types), *place.types)
            farthest = int(np.argmin(test.margin(T)))
            shape = narrowed(shape, T[farthest], share=0.5, least=0.0)
    return replace(place, shape=shape)


def precedences(relations: Relations) -> tuple[float, ...]:
    """Per place, of all rests that it holds at, the fraction that belongs to another one.

    Of two places that hold at once the one that is less often wrong counts.
    """
    own, foreign = Counter[int](), Counter[int]()
    tests = [p.shape.classifier(Predicate("place", p.types), *p.types) for p in relations.places]
    for label in relations.labels:
        e = label.episode
        for r, place_, ref in ((e.before, label.start, label.start_ref), (e.after, label.end, label.end_ref)):
            if r is None or place_ is None:
                continue
            at, types = (r.start + r.stop) // 2, e.demo.objects
            for k, test in enumerate(tests):
                parents = [o for o, t in types.items() if t == test.parent and o != r.obj and types[r.obj] == test.child]
                held = [o for o in parents if test.holds(e.demo.pose(o)[at].inverse() @ r.T_world_obj)]
                if k == place_ and ref in held:
                    own[k] += 1
                elif held:
                    foreign[k] += 1
    return tuple(round(foreign[k] / max(own[k] + foreign[k], 1), 3) for k in range(len(tests)))


def _placements(
    demos: Sequence[Demo],
    episodes: Sequence[Episode],
    type_: str,
    extents: Extents,
    config: PredicateConfig,
    answers: Mapping[RestKey, str] | None,
) -> tuple[tuple[Placement, ...], dict[tuple[str, str], Joint]]:
    rests = [(e.demo, r) for e in episodes for r in e.rests(type_)]
    moved = {(e.demo.where, o) for e in episodes for o in (e.obj, *e.passengers)}
    for demo in demos:
        still = int(np.searchsorted(demo.times, demo.times[0] + 2.0))
        rests += [
            (demo, rest(demo, o, 0, still, static=True))
            for o, t in demo.objects.items()
            if t == type_ and (demo.where, o) not in moved
        ]
    alone = [fit_joint([way], config.articulation) is not None for e in episodes if (way := _own_way(e, type_)) is not None]
    hint = config.joints.get(type_)
    followed = [e.follows for e in episodes if e.follows is not None and type_ == e.type and e.body is None]
    free = bool(followed) and float(np.median(followed)) > 0.5
    if hint != "free" and (hint is not None or (np.mean(alone) >= 0.8 and not free)):
        found = place(rests, True, extents, config.references, answers)
        joints = _joints(episodes, found, type_, config)
        kinds = {{"hinge": "revolute", "slide": "prismatic"}[joint.kind] for joint in joints.values()}
        if hint is not None and kinds != {hint}:
            told = f"{sum(alone)} of {len(alone)} of its motions are those of a joint" if not kinds else f"it is {kinds.pop()}"
            raise LearningError(f"hint joints.{type_}: {hint}, but the recordings say that {told}")
        if joints:
            return found, joints
    found = place([(d, r) for d, r in rests if not r.held], False, extents, config.references, answers)
    return (*found, *_lifted(episodes, found, type_)), {}


def _own_way(e: Episode, type_: str) -> Pose | None:
    """How what is of this type moved by itself; a latch that a door is pulled by only held still."""
    return None if continues(e) and e.body is not None and type_ == e.type else e.way(type_)


def _lifted(episodes: Sequence[Episode], found: Sequence[Placement], type_: str) -> Iterator[Placement]:
    """Where what a recording leaves in the hand has been lifted to, relative to what it was taken from."""
    taken_from = {p.rest.key: p for p in found}
    for e in episodes:
        below = taken_from.get(e.before.key) if e.before is not None else None
        if e.type == type_ and below is not None and e.after is not None and e.after.held:
            at = (e.after.start + e.after.stop) // 2
            T_ref_obj = e.demo.pose(below.ref)[at].inverse() @ e.after.T_world_obj
            lifted_m = float(e.after.T_world_obj.p[2] - below.rest.T_world_obj.p[2])
            yield replace(below, rest=e.after, T_ref_obj=T_ref_obj, lifted_m=lifted_m)


def _joints(
    episodes: Sequence[Episode], found: Sequence[Placement], type_: str, config: PredicateConfig
) -> dict[tuple[str, str], Joint]:
    refs = {p.rest.key: p for p in found}
    motions: dict[tuple[str, str], list[Pose]] = defaultdict(list)
    for e in episodes:
        at = next((refs[r.key] for r in reversed(e.rests(type_)) if r.key in refs), None)
        if at is not None:
            span = np.linspace(e.start, e.stop - 1, 25).astype(int)
            motions[at.types].append(e.demo.pose(at.ref)[span].inverse() @ e.demo.pose(at.rest.obj)[span])
    fitted = {pair: agreed_joint(ways, config.articulation) for pair, ways in sorted(motions.items())}
    return {pair: joint for pair, joint in fitted.items() if joint is not None}


def _ends(found: Sequence[Placement], episodes: Sequence[Episode], type_: str) -> list[tuple[int, int]]:
    """Where each motion began and ended, as rows of the rests that are not static."""
    row = {p.rest.key: i for i, p in enumerate(p for p in found if not p.rest.static)}
    ways = [[row[r.key] for r in e.rests(type_) if r.key in row] for e in episodes]
    return [(way[0], way[-1]) for way in ways if len(way) == 2]
