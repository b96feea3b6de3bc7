"""Rest poses and contacts into predicates without names, and every episode labelled with them (METHOD sections 3 and 4).

Each label of an episode - where the object rested, how the gripper acted on it, where it came to rest - is a cluster by
construction, so operators can be grouped without a look at thresholds. What is odd is named in `Relations.notes` and left out.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from symskill_pddl.demos import Demo
from symskill_pddl.geometry import Array, Pose, karcher_mean, rotation_distance
from symskill_pddl.learning.articulation import UP, ArticulationConfig, Joint, fit_joint
from symskill_pddl.learning.references import Extents, Placement, ReferenceConfig, place
from symskill_pddl.learning.segments import Episode, Rest, rest
from symskill_pddl.learning.shapes import Shape, ShapeConfig, clusters, fit_shape, free_yaw, narrowed


@dataclass(frozen=True)
class PredicateConfig:
    """When poses count as different, and how wide predicates are."""

    references: ReferenceConfig = field(default_factory=ReferenceConfig)
    articulation: ArticulationConfig = field(default_factory=ArticulationConfig)
    free_shape: ShapeConfig = field(default_factory=ShapeConfig)
    """Rest poses of what moves freely."""
    joint_shape: ShapeConfig = field(default_factory=lambda: ShapeConfig(prior_m=0.006, prior_rad=float(np.radians(2.0))))
    """Rest poses of what is hinged or slides."""
    contact_shape: ShapeConfig = field(
        default_factory=lambda: ShapeConfig(
            floor_m=0.006, floor_rad=float(np.radians(4.0)), prior_m=0.006, prior_rad=float(np.radians(5.0))
        )
    )
    ratio: float = 2.5
    """A gap between clusters is at least this many times the gaps within."""
    free_gap_m: float = 0.12
    """Rests nearer than this are one place; a gap has to be `ratio` times as wide to separate two."""
    vertical_weight: float = 4.0
    """Heights count more than places on a support: two shelves are two predicates, two spots on a counter are one."""
    tilt_m_rad: float = 0.3
    static_gap_m: float = 0.5
    """An object that nobody moved widens a cluster if it rests within this of a member, at its height and tilt."""
    hinge_gap_rad: float = float(np.radians(18.0))
    slide_gap_m: float = 0.04
    contact_gap_m: float = 0.05
    contact_m_rad: float = 0.12
    trim: float = 0.10
    """Fraction of a motion that is left out at both ends of the gripper's relative poses."""
    odd_of: int = 3
    """What a single demonstration shows, of a task with at least this many, is odd."""


@dataclass(frozen=True, eq=False)
class Place:
    """One object-at-reference predicate.

    Attributes
    ----------
    types : (str, str)
        The object's and the reference's type.
    shape : Shape
        Of `T_ref_obj`.
    joint : Joint or None
        If the object is hinged or slides in the reference's frame.
    coordinate : float
        Mean joint coordinate [rad] or [m]; 0 without a joint.
    demos : frozenset of str
        Demonstrations that showed it by moving something there or away.
    margin : float
        How clear the choice of the reference was, at least.
    """

    types: tuple[str, str]
    shape: Shape
    joint: Joint | None
    coordinate: float
    demos: frozenset[str]
    margin: float


@dataclass(frozen=True, eq=False)
class Contact:
    """One gripper-in-object predicate; `closes`: the fingers are commanded closed, `held`: they close on the object."""

    type: str
    shape: Shape
    closes: bool
    held: bool
    articulated: bool
    demos: frozenset[str]


@dataclass(frozen=True, eq=False)
class Label:
    """An episode in terms of predicates: indices into `Relations.places` and `contacts`, with the reference objects."""

    episode: Episode
    contact: int
    start: int | None
    start_ref: str | None
    end: int | None
    end_ref: str | None

    @property
    def ref(self) -> str | None:
        """The object in whose frame the motion is described."""
        return self.end_ref or self.start_ref


@dataclass(frozen=True, eq=False)
class Relations:
    """Predicates without names, and the labelled episodes."""

    places: tuple[Place, ...]
    contacts: tuple[Contact, ...]
    labels: tuple[Label, ...]
    notes: tuple[str, ...]


def learn_relations(
    demos: Sequence[Demo], episodes: Sequence[Episode], extents: Extents, config: PredicateConfig | None = None
) -> Relations:
    """Predicates from the rests and contacts of all episodes."""
    config = config or PredicateConfig()
    shown = Counter(demo.task for demo in demos)
    odd = {demo.where: shown[demo.task] >= config.odd_of for demo in demos}
    places: list[Place] = []
    notes: list[str] = []
    of_rest: dict[int, tuple[int | None, str]] = {}  # id of a Rest -> (place or None when odd, reference object)
    jointed: dict[str, bool] = {}
    for type_ in sorted({t for e in episodes for t in (e.type, e.moved_type)}):
        own = [e for e in episodes if type_ in (e.type, e.moved_type)]
        found, joints = _placements(demos, own, type_, extents, config)
        jointed[type_] = bool(joints)
        for pair in sorted({p.types for p in found}):
            rests = [p for p in found if p.types == pair]
            apart = _ends(rests, own, type_) if pair in joints else []
            _cluster_pair(rests, joints.get(pair), apart, odd, places, of_rest, notes, config)
    kept, contacts = _labelled(episodes, of_rest, jointed, odd, notes, config)
    return Relations(tuple(places), contacts, kept, tuple(notes))


def _placements(
    demos: Sequence[Demo], episodes: Sequence[Episode], type_: str, extents: Extents, config: PredicateConfig
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
    alone = [fit_joint([way], config.articulation) is not None for e in episodes if (way := e.way(type_)) is not None]
    if np.mean(alone) >= 0.8:
        found = place(rests, True, extents, config.references)
        joints = _joints(episodes, found, type_, config)
        if joints:
            return found, joints
    return place(rests, False, extents, config.references), {}


def _joints(
    episodes: Sequence[Episode], found: Sequence[Placement], type_: str, config: PredicateConfig
) -> dict[tuple[str, str], Joint]:
    refs = {id(p.rest): p for p in found}
    motions: dict[tuple[str, str], list[Pose]] = defaultdict(list)
    for e in episodes:
        at = next((refs[id(r)] for r in reversed(e.rests(type_)) if id(r) in refs), None)
        if at is not None:
            span = np.linspace(e.start, e.stop - 1, 25).astype(int)
            motions[at.types].append(e.demo.pose(at.ref)[span].inverse() @ e.demo.pose(at.rest.obj)[span])
    fitted = {pair: fit_joint(ways, config.articulation) for pair, ways in sorted(motions.items())}
    return {pair: joint for pair, joint in fitted.items() if joint is not None}


def _ends(found: Sequence[Placement], episodes: Sequence[Episode], type_: str) -> list[tuple[int, int]]:
    """Where each motion began and ended, as rows of the rests that are not static."""
    row = {id(p.rest): i for i, p in enumerate(p for p in found if not p.rest.static)}
    ways = [[row[id(r)] for r in e.rests(type_) if id(r) in row] for e in episodes]
    return [(way[0], way[-1]) for way in ways if len(way) == 2]


def _cluster_pair(
    found: Sequence[Placement],
    joint: Joint | None,
    apart: Sequence[tuple[int, int]],
    odd: Mapping[str, bool],
    places: list[Place],
    of_rest: dict[int, tuple[int | None, str]],
    notes: list[str],
    config: PredicateConfig,
) -> None:
    """Clusters of one (object type, reference type); appends to `places`, `of_rest` and `notes`."""
    moved = [p for p in found if not p.rest.static]
    static = [p for p in found if p.rest.static]
    if not moved:
        return
    distances = _rest_distances(moved, joint, config)
    gap, floor = _gap(joint, config)
    labels = clusters(distances, gap, config.ratio, floor, apart)
    core = [[p for p, label in zip(moved, labels, strict=True) if label == k] for k in range(labels.max() + 1)]
    alone = [len(members) == 1 and odd[members[0].demo.where] and len(core) > 1 for members in core]
    groups: list[tuple[int, list[Placement]]] = []
    for members, is_alone in zip(core, alone, strict=True):
        if is_alone:
            only = members[0]
            notes.append(
                f"{only.demo.where}: {only.rest.obj} rests at {only.ref} at {only.demo.times[only.rest.start]:.1f} s "
                "where no other demonstration leaves one; left out"
            )
            of_rest[id(only.rest)] = (None, only.ref)
        else:
            groups.append((len(places) + len(groups), list(members)))
    for p in static:
        _adopt(p, groups, joint, config)
    for index, members in groups:
        for p in members:
            of_rest[id(p.rest)] = (index, p.ref)
        places.append(_place_of(members, joint, config))


def _adopt(p: Placement, groups: Sequence[tuple[int, list[Placement]]], joint: Joint | None, config: PredicateConfig) -> None:
    """An untouched object widens the nearest cluster, if it is near enough; it never founds one."""
    best: tuple[float, list[Placement]] | None = None
    for _, members in groups:
        d = _rest_distances([p, *members], joint, config)[0, 1:]
        if joint is None:
            flat = _rest_distances([p, *members], joint, config, lateral=0.0)[0, 1:]
            d = np.where(flat < config.free_gap_m / 2, d * config.free_gap_m / config.static_gap_m, np.inf)
        nearest = float(d.min())
        if best is None or nearest < best[0]:
            best = (nearest, members)
    if best is not None and best[0] < _gap(joint, config)[0]:
        best[1].append(p)


def _gap(joint: Joint | None, config: PredicateConfig) -> tuple[float, float]:
    """Smallest gap between clusters, and the spread within them that goes without saying."""
    if joint is None:
        return config.free_gap_m, config.free_gap_m
    return (config.hinge_gap_rad, float(np.radians(2.0))) if joint.kind == "hinge" else (config.slide_gap_m, 0.005)


def _rest_distances(found: Sequence[Placement], joint: Joint | None, config: PredicateConfig, lateral: float = 1.0) -> Array:
    """Distance matrix (n, n): joint coordinates, or metres with heights and tilts weighted."""
    if joint is not None:
        s = np.array([float(joint.coordinate(p.T_ref_obj)) for p in found])
        d = np.abs(s[:, None] - s[None, :])
        return np.minimum(d, 2 * np.pi - d) if joint.kind == "hinge" else d
    up = np.stack([_up_in_ref(p) for p in found])
    p = np.stack([f.T_ref_obj.p for f in found])
    height = np.sum(p * up, axis=-1)
    flat = p - height[:, None] * up
    lean = np.stack([f.rest.T_world_obj.inverse().rotate(UP) for f in found])
    tilt = np.arccos(np.clip(lean @ lean.T, -1.0, 1.0))
    across = lateral * np.linalg.norm(flat[:, None] - flat[None], axis=-1)
    rise = config.vertical_weight * np.abs(height[:, None] - height[None])
    return np.asarray(np.sqrt(across**2 + rise**2 + (config.tilt_m_rad * tilt) ** 2))


def _up_in_ref(p: Placement) -> Array:
    return p.T_ref_obj.rotate(p.rest.T_world_obj.inverse().rotate(UP))


def _place_of(members: Sequence[Placement], joint: Joint | None, config: PredicateConfig) -> Place:
    poses = Pose.stack([p.T_ref_obj for p in members])
    moved = [p for p in members if not p.rest.static]
    if joint is None:
        up = np.mean([p.rest.T_world_obj.inverse().rotate(UP) for p in members], axis=0)
        axis = free_yaw(poses, up / np.linalg.norm(up), config.free_shape)
        above = np.mean([_up_in_ref(p) for p in members], axis=0)
        shape = fit_shape(poses, len(members), config.free_shape, axis, above / np.linalg.norm(above))
        coordinate = 0.0
    else:
        shape = fit_shape(poses, len(members), config.joint_shape)
        coordinate = float(joint.coordinate(shape.T_mean))
    demos = frozenset(p.demo.where for p in moved)
    return Place(members[0].types, shape, joint, coordinate, demos, min(p.margin for p in moved))


def _labelled(
    episodes: Sequence[Episode],
    of_rest: Mapping[int, tuple[int | None, str]],
    jointed: Mapping[str, bool],
    odd: Mapping[str, bool],
    notes: list[str],
    config: PredicateConfig,
) -> tuple[tuple[Label, ...], tuple[Contact, ...]]:
    """Episodes that lead somewhere, with their contacts clustered per type (for joints: per start, end and finger command)."""

    def at(r: Rest | None) -> tuple[int | None, str | None]:
        return of_rest.get(id(r), (None, None)) if r is not None else (None, None)

    groups: dict[tuple[object, ...], list[tuple[Episode, int | None, str | None, int | None, str | None]]] = defaultdict(list)
    undone: Episode | None = None  # the episode before, if it led nowhere: the approach to the next one begins where it stopped
    for found in episodes:
        e = found
        if undone is not None and undone.demo is e.demo:
            e = replace(e, begin=min(e.begin, max(undone.stop, undone.begin)))
        undone = None
        (start, start_ref), (end, end_ref) = at(e.before), at(e.after)
        if end is None and end_ref is not None:
            notes.append(f"{e}: ends where nothing else rests; left out")
        elif start is not None and (start, start_ref) == (end, end_ref):
            undone = e
            notes.append(f"{e}: leads back to where it began (a retry or a nudge); left out")
        else:
            way = (start if start is not None else -1, end if end is not None else -1) if jointed[e.type] else ()
            groups[(e.type, _closed(e), *way)].append((e, start, start_ref, end, end_ref))
    contacts: list[Contact] = []
    kept: list[Label] = []
    for key in sorted(groups, key=str):
        members = groups[key]
        labels = clusters(_contact_distances([m[0] for m in members], config), config.contact_gap_m, config.ratio, 0.01)
        for k in range(labels.max() + 1):
            own = [m for m, label in zip(members, labels, strict=True) if label == k]
            if len(own) == 1 and odd[own[0][0].demo.where] and len(members) > 1:
                notes.append(f"{own[0][0]}: the gripper acts on it as in no other demonstration; left out")
                continue
            kept += [Label(e, len(contacts), start, start_ref, end, end_ref) for e, start, start_ref, end, end_ref in own]
            contacts.append(_contact_of([m[0] for m in own], jointed, config))
    contacts = [_apart(k, contacts, kept) for k in range(len(contacts))]
    order = {e.demo.where: i for i, e in reversed(list(enumerate(episodes)))}
    return tuple(sorted(kept, key=lambda label: (order[label.episode.demo.where], label.episode.start))), tuple(contacts)


def _closed(e: Episode) -> bool:
    """The finger command while the object moves (majority)."""
    return bool(np.mean(e.demo.gripper_closed[e.start : e.stop]) > 0.5)


def _acting(e: Episode, config: PredicateConfig, samples: int = 25) -> Pose:
    """`T_obj_ee` over the trimmed motion, evenly thinned."""
    cut = int(config.trim * (e.stop - e.start))
    span = np.unique(np.linspace(e.start + cut, max(e.stop - 1 - cut, e.start + cut), samples).astype(int))
    return e.demo.pose(e.obj)[span].inverse() @ e.demo.T_world_ee[span]


def _contact_distances(episodes: Sequence[Episode], config: PredicateConfig) -> Array:
    acting = [_acting(e, config) for e in episodes]
    means = Pose.stack([Pose(T.p.mean(axis=0), karcher_mean(T.q)) for T in acting])
    dp = np.linalg.norm(means.p[:, None] - means.p[None], axis=-1)
    dr = rotation_distance(means[:, None], means[None, :])
    return np.asarray(np.hypot(dp, config.contact_m_rad * dr))


def _contact_of(episodes: Sequence[Episode], jointed: Mapping[str, bool], config: PredicateConfig) -> Contact:
    acting = [_acting(e, config) for e in episodes]
    poses = Pose(np.concatenate([T.p for T in acting]), np.concatenate([T.q for T in acting]))
    closes = bool(np.mean([_closed(e) for e in episodes]) > 0.5)
    # held: the hand is around the object when the fingers close, that is it does not come any nearer afterwards
    held = closes and bool(np.mean([_closes_on(e) for e in episodes]) > 0.5)
    return Contact(
        type=episodes[0].type,
        shape=fit_shape(poses, len(episodes), config.contact_shape),
        closes=closes,
        held=held,
        articulated=jointed[episodes[0].type],
        demos=frozenset(e.demo.where for e in episodes),
    )


def _apart(index: int, contacts: Sequence[Contact], labels: Sequence[Label]) -> Contact:
    """A contact, narrowed as far as its own observations allow, so that what is no such contact lies outside.

    That is the middle of every other way to act on the same type, and where the hand was when it set out for this one.
    """
    contact = contacts[index]
    shape = contact.shape
    for rival in contacts:
        if rival is not contact and rival.type == contact.type:
            shape = narrowed(shape, rival.shape.T_mean)
    for label in labels:
        if label.contact == index:
            e = label.episode
            shape = narrowed(shape, e.demo.pose(e.obj)[e.begin].inverse() @ e.demo.T_world_ee[e.begin])
    return replace(contact, shape=shape)


def _closes_on(e: Episode) -> bool:
    closing = closing_sample(e)
    if closing is None:
        return False
    pair = [closing, max(closing, e.start)]
    T_obj_ee = e.demo.pose(e.obj)[pair].inverse() @ e.demo.T_world_ee[pair]
    return bool(np.linalg.norm(T_obj_ee.p[1] - T_obj_ee.p[0]) < 0.01)


def closing_sample(e: Episode) -> int | None:
    """The last sample at which the fingers are told to close before the motion, or as it begins; None if they are not.

    Fingers that close on an object push it a little, so the command may come a moment after the object's first movement.
    """
    soon = int(np.searchsorted(e.demo.times, e.demo.times[e.start] + 0.5))
    command = e.demo.gripper_closed[e.begin : min(soon, e.stop - 1) + 1].astype(np.int8)
    switches = np.flatnonzero(np.diff(command) > 0)
    return e.begin + int(switches[-1]) + 1 if len(switches) and command[-1] else None


__all__ = ["Contact", "Label", "Place", "PredicateConfig", "Relations", "closing_sample", "learn_relations"]
