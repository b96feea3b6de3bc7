"""What an object rests at: the reference of each resting place (the default selector).

Every other object of the scene, but the object's own parts, is a candidate. A candidate scores

- ``dispersion``: how much tighter the rest poses of one group are in its frame than in the worst candidate's, weighted by
  ``(n - 1) / (n + 1)``, so that one demonstration leaves the decision to the priors;
- ``contact``: 1 if the object lies inside the candidate's box or directly on it, decaying with the gap; half of that beside it.
  What is hinged or slides touches its reference on any side. Without known extents the distance of the origins takes the place
  of the gap;
- ``proximity``: ``1 / (1 + d / 0.3 m)`` with d the distance of the origins; halved in weight;
- minus a half if the candidate has the object's own type;
- for what is hinged or slides, all rests of one object in one demonstration are scored together, and one of them that is oriented
  as the candidate speaks for it.

A type is chosen for a group of rests by majority of the first guesses and the sum of scores; within it the object with the best
score. Where another selector was asked (`vision`), its answer leads the scores of that rest.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from symskill_pddl.demos import Demo
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.learning.segments import Rest, RestKey

Extents = Mapping[str, tuple[float, float, float]]


@dataclass(frozen=True)
class ReferenceConfig:
    """Weights and lengths of the score."""

    gap_m: float = 0.03
    """Decay length of the gap between what is loose and what it may lie on: trackers and boxes are off by that much."""
    side_gap_m: float = 0.15
    """Decay length of the gap for what is hinged or slides."""
    near_m: float = 0.3
    """Decay length of proximity: the size of furniture."""
    proximity_weight: float = 0.5
    """Of proximity, against 1 for contact: it decides where contact does not."""
    same_type_penalty: float = 0.5
    """Things are rarely put relative to things of their own type; a stack of them still wins by contact."""
    alignment_weight: float = 0.25
    """Of what is hinged or slides: weight of lying as its reference does in one of its rests."""
    aligned_rad: float = float(np.radians(10.0))
    """Decay angle of that."""
    minority: int = 1
    """Groups of at most this many guesses join a larger group if its type scores nearly as well."""
    nearly: float = 0.35
    """A smaller lead of the odd guess over the larger group's type counts as nearly as well."""
    hinged_minority: float = 0.25
    """Of what is hinged or slides, groups of less than this fraction of the guesses join a larger group in any case: all of a
    type hang on one type."""
    answer_weight: float = 3.0
    """What another selector's answer adds to the score of the object that it names: more than all else together."""
    hinted: Mapping[str, str] = field(default_factory=dict)
    """By type of object, the type of its reference, where a person has said so."""


@dataclass(frozen=True, eq=False)
class Placement:
    """A rest with its reference: `T_ref_obj` in the frame of the object `ref`.

    `margin` is the lead of the chosen type over the next one in the mean score of its group; `lifted_m` of what is in the hand,
    how high above where it rested.
    """

    demo: Demo
    rest: Rest
    ref: str
    T_ref_obj: Pose
    margin: float
    lifted_m: float = 0.0

    @property
    def types(self) -> tuple[str, str]:
        """Types of the object and of its reference."""
        return self.demo.objects[self.rest.obj], self.demo.objects[self.ref]


@dataclass(frozen=True, eq=False)
class Candidates:
    """What a rest may be at: `names` (k,) in the scene's order, their poses, and `T_ref_obj` (k,)."""

    names: tuple[str, ...]
    types: tuple[str, ...]
    T_world_ref: Pose
    T_ref_obj: Pose

    @classmethod
    def of(cls, demo: Demo, rest: Rest) -> Candidates:
        """Every other object of the scene, but the parts that hang on this one."""
        rows = [i for i, name in enumerate(demo.objects) if name != rest.obj and name not in rest.parts]
        names = tuple(list(demo.objects)[i] for i in rows)
        T_world_ref = demo.T_world_objects[(rest.start + rest.stop) // 2, rows]
        return cls(names, tuple(demo.objects[n] for n in names), T_world_ref, T_world_ref.inverse() @ rest.T_world_obj)

    def of_type(self, type_: str, scores: Array) -> int | None:
        """The row of this type that scores best; of equal ones the first by name."""
        rows = [i for i, t in enumerate(self.types) if t == type_]
        return min(rows, key=lambda i: (-scores[i], self.names[i]), default=None)


def place(
    rests: Sequence[tuple[Demo, Rest]],
    hinged: bool,
    extents: Extents,
    config: ReferenceConfig | None = None,
    answers: Mapping[RestKey, str] | None = None,
) -> tuple[Placement, ...]:
    """References for the rests of objects of one type, in the order given. `hinged`: the type turns about an axis or slides.

    Rests in scenes that hold no other object are left out. `answers` holds, by `Rest.key`, the object that another selector
    named.
    """
    config, answers = config or ReferenceConfig(), answers or {}
    found = [Candidates.of(demo, rest) for demo, rest in rests]
    table = [_prior_scores(demo, rest, c, hinged, extents, config) for (demo, rest), c in zip(rests, found, strict=True)]
    if hinged:
        table = _over_all_rests(rests, found, table, config)
    for (demo, rest), candidates, scores in zip(rests, found, table, strict=True):
        scores[[t == config.hinted.get(demo.objects[rest.obj]) for t in candidates.types]] += config.answer_weight
        if rest.key in answers:
            scores[candidates.names.index(answers[rest.key])] += config.answer_weight
    groups: dict[str, list[int]] = defaultdict(list)
    for i, (candidates, scores) in enumerate(zip(found, table, strict=True)):
        if len(scores):
            best = min(range(len(scores)), key=lambda k: (-scores[k], candidates.names[k]))
            groups[candidates.types[best]].append(i)
    guesses = [(demo.where, rest.obj, 0 if hinged else i) for i, (demo, rest) in enumerate(rests)]
    groups = _absorbed(groups, guesses, found, table, hinged, config)
    chosen: dict[int, Placement] = {}
    for members in groups.values():
        totals = _type_scores(members, found, table)
        ranked = sorted(totals, key=lambda t: (-totals[t], t))
        margin = totals[ranked[0]] - totals[ranked[1]] if len(ranked) > 1 else float("inf")
        for i in members:
            row = found[i].of_type(ranked[0], table[i])
            if row is not None:
                chosen[i] = Placement(*rests[i], found[i].names[row], found[i].T_ref_obj[row], margin)
    return tuple(chosen[i] for i in sorted(chosen))


def _over_all_rests(
    rests: Sequence[tuple[Demo, Rest]], found: Sequence[Candidates], table: Sequence[Array], config: ReferenceConfig
) -> list[Array]:
    """Mean scores over all rests of one object in one demonstration, plus what its alignment says.

    What is hinged or slides hangs on one thing, open or closed, and most often lies in one of its rests as that thing does.
    """
    owned: dict[tuple[str, str], list[int]] = defaultdict(list)
    for i, (demo, rest) in enumerate(rests):
        owned[demo.where, rest.obj].append(i)
    result = list(table)
    for own in owned.values():
        turned = [np.linalg.norm(found[i].T_ref_obj.rotvec(), axis=-1) for i in own]
        nearest = np.min(turned, axis=0)
        scores = np.mean([table[i] for i in own], axis=0) + config.alignment_weight * np.exp(-nearest / config.aligned_rad)
        for i in own:
            result[i] = scores.copy()
    return result


def _prior_scores(demo: Demo, rest: Rest, found: Candidates, hinged: bool, extents: Extents, config: ReferenceConfig) -> Array:
    """Contact, proximity and type of each candidate (k,)."""
    own = demo.objects[rest.obj]
    contact = np.array(
        [
            _contact(found.T_ref_obj[k], found.T_world_ref[k], extents.get(own), extents.get(t), hinged, config)
            for k, t in enumerate(found.types)
        ]
    )
    proximity = 1.0 / (1.0 + np.linalg.norm(found.T_ref_obj.p, axis=-1) / config.near_m)
    same = np.array([t == own for t in found.types])
    return np.asarray(contact + config.proximity_weight * proximity - config.same_type_penalty * same)


def _contact(
    T_ref_obj: Pose,
    T_world_ref: Pose,
    own: tuple[float, float, float] | None,
    other: tuple[float, float, float] | None,
    hinged: bool,
    config: ReferenceConfig,
) -> float:
    T_world_obj = T_world_ref @ T_ref_obj
    across = T_world_obj.p - T_world_ref.p
    if other is None:
        above = 1.0 if across[2] > 0.0 or hinged else 0.7
        return 0.8 * above * float(np.exp(-np.linalg.norm(across) / config.near_m))
    outside = np.maximum(np.abs(T_ref_obj.p) - np.array(other), 0.0)  # (3,) in the reference's axes
    if not outside.any():
        return 1.0
    half_height = float(np.abs(T_world_obj.rotation_matrix()[2]) @ np.array(own)) if own is not None else 0.03
    gap = T_world_ref.rotate(outside * np.sign(T_ref_obj.p))
    level, rise = float(np.linalg.norm(gap[:2])), float(gap[2])
    if hinged:
        return float(np.exp(-np.hypot(level, rise) / config.side_gap_m))
    if level < 0.01 and rise > 0.0:
        return float(np.exp(-max(rise - half_height, 0.0) / config.gap_m))
    return 0.5 * float(np.exp(-np.hypot(level, max(abs(rise) - half_height, 0.0)) / config.gap_m))


def _type_scores(members: Sequence[int], found: Sequence[Candidates], table: Sequence[Array]) -> dict[str, float]:
    """Mean prior of each type that every member's scene holds, plus its dispersion term."""
    common = set.intersection(*(set(found[i].types) for i in members))
    priors, spreads = {}, {}
    for type_ in sorted(common):
        rows = [(i, row) for i in members if (row := found[i].of_type(type_, table[i])) is not None]
        priors[type_] = float(np.mean([table[i][row] for i, row in rows]))
        p = np.array([found[i].T_ref_obj.p[row] for i, row in rows])
        spreads[type_] = float(np.sqrt(p.var(axis=0).sum()))
    worst, n = max(spreads.values()), len(members)
    weight = (n - 1) / (n + 1) if worst > 1e-9 else 0.0
    return {t: priors[t] + weight * (1.0 - spreads[t] / max(worst, 1e-9)) for t in priors}


def _absorbed(
    groups: Mapping[str, list[int]],
    guesses: Sequence[tuple[str, str, int]],
    found: Sequence[Candidates],
    table: Sequence[Array],
    hinged: bool,
    config: ReferenceConfig,
) -> dict[str, list[int]]:
    """Tiny groups join the large group whose type explains them nearly as well: one odd guess is not another resting place."""
    # rests that were scored together are one guess
    size = {t: len({guesses[i] for i in m}) for t, m in groups.items()}
    few = max(config.minority, config.hinged_minority * sum(size.values())) if hinged else config.minority
    large = {t: list(m) for t, m in groups.items() if size[t] > few or sum(size.values()) <= 3 or size[t] == max(size.values())}
    result = {t: list(m) for t, m in large.items()}
    for type_, members in sorted(groups.items()):
        if type_ in large:
            continue
        for i in members:
            own = float(table[i].max())
            fits = {}
            for t in large:
                row = found[i].of_type(t, table[i])
                if row is not None and (hinged or own - table[i][row] <= config.nearly):
                    fits[t] = float(table[i][row])
            target = max(sorted(fits), key=lambda t: fits[t]) if fits else type_
            result.setdefault(target, []).append(i)
    return {t: sorted(m) for t, m in sorted(result.items())}
