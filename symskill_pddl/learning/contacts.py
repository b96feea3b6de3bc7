"""How the gripper acts on things: gripper-in-object predicates, and the label of every episode."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from symskill_pddl.geometry import Array, Pose, karcher_mean, rotation_distance
from symskill_pddl.learning.parts import continues
from symskill_pddl.learning.places import Clustered
from symskill_pddl.learning.relations import Contact, Label, PredicateConfig
from symskill_pddl.learning.report import SHOW_AGAIN, LeftOut
from symskill_pddl.learning.segments import Episode, Rest
from symskill_pddl.learning.shapes import clusters, fit_shape, narrowed

At = tuple[int | None, str | None]
"""A place, if any, and the object that it is at."""


def labelled(
    episodes: Sequence[Episode],
    into: Clustered,
    jointed: Mapping[str, bool],
    config: PredicateConfig,
) -> tuple[tuple[Label, ...], tuple[Contact, ...]]:
    """Episodes that lead somewhere, with their contacts clustered per type (for joints: per start, end and finger command)."""

    def at(r: Rest | None) -> At:
        return into.of_rest.get(r.key, (None, None)) if r is not None else (None, None)

    groups: dict[tuple[object, ...], list[tuple[Episode, int | None, str | None, int | None, str | None]]] = defaultdict(list)
    keys: dict[tuple[str, str], tuple[object, ...]] = {}  # of the group that last had hold of an object
    undone: Episode | None = None  # the episode before, if it led nowhere: the approach to the next one begins where it stopped
    for found in episodes:
        e = found
        if undone is not None and undone.demo is e.demo:
            left = undone.stop if undone.leave is None else min(undone.leave, e.start)
            e = replace(e, begin=min(e.begin, max(left, undone.begin)))
        undone = None
        (start, start_ref), (end, end_ref) = at(e.before), at(e.after)
        if end is None and end_ref is not None:
            into.left_out.append(LeftOut.of(e, "it ends where no other demonstration leaves one", SHOW_AGAIN))
        elif _undone(e, (start, start_ref), (end, end_ref), jointed):
            undone = e
            into.left_out.append(LeftOut.of(e, "it leads back to where it began (a retry or a nudge)"))
        else:
            way = (start if start is not None else -1, end if end is not None else -1) if jointed[e.type] else ()
            key = (e.type, _closed(e), *way)
            if continues(e):
                key = keys.get((e.demo.where, e.obj), key)
            keys[e.demo.where, e.obj] = key
            groups[key].append((e, start, start_ref, end, end_ref))
    contacts: list[Contact] = []
    kept: list[Label] = []
    for key in sorted(groups, key=str):
        members = groups[key]
        labels = clusters(_contact_distances([m[0] for m in members], config), config.contact_gap_m, config.ratio, 0.01)
        for k in range(labels.max() + 1):
            own = [m for m, label in zip(members, labels, strict=True) if label == k]
            if len(own) == 1 and into.odd[own[0][0].demo.where] and len(members) > 1:
                into.left_out.append(LeftOut.of(own[0][0], "the gripper acts on it as in no other demonstration", SHOW_AGAIN))
                continue
            kept += [Label(e, len(contacts), start, start_ref, end, end_ref) for e, start, start_ref, end, end_ref in own]
            contacts.append(_contact_of([m[0] for m in own], jointed, config))
    contacts = [_apart(k, contacts, kept) for k in range(len(contacts))]
    order = {e.demo.where: i for i, e in reversed(list(enumerate(episodes)))}
    return tuple(sorted(kept, key=lambda label: (order[label.episode.demo.where], label.episode.start))), tuple(contacts)


def _undone(e: Episode, start: At, end: At, jointed: Mapping[str, bool]) -> bool:
    """Whether the object rests as it did before."""
    return start[0] is not None and start == end and not continues(e) and (jointed[e.type] or not _carried(e))


def _carried(e: Episode) -> bool:
    """Whether an object that rests in the same relation as before is elsewhere all the same: farther than the hand is wide."""
    return bool(
        e.before is not None
        and e.after is not None
        and np.linalg.norm(e.after.T_world_obj.p - e.before.T_world_obj.p) > e.demo.aperture.max()
    )


def _closed(e: Episode) -> bool:
    """The finger command while the object moves (majority)."""
    return e.held or bool(np.mean(e.demo.gripper_closed[e.start : e.stop]) > 0.5)


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
    held = bool(np.mean([e.held for e in episodes]) > 0.5)
    return Contact(
        type=episodes[0].type,
        shape=fit_shape(poses, len(episodes), config.contact_shape),
        closes=closes,
        held=held,
        articulated=jointed[episodes[0].type],
        demos=frozenset(e.demo.where for e in episodes),
        fingers=_fingers(episodes) if held else None,
    )


def _fingers(episodes: Sequence[Episode]) -> tuple[float, float]:
    """Between which apertures [m] something stops the fingers: from half the narrowest grasp that was shown, to half way from the
    widest one to an open hand, since other things of the type are narrower or wider."""
    widths = [
        float(np.median(e.demo.aperture[span][closed]))
        for e in episodes
        if (closed := e.demo.gripper_closed[(span := slice(e.start, e.stop))]).any()
    ]
    widest = max(float(e.demo.aperture.max()) for e in episodes)
    return round(0.5 * min(widths), 4), round(0.5 * (max(widths) + widest), 4) + 1e-4


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
