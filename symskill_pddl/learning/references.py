"""What an object rests at: the reference of each resting place (METHOD section 3, the default selector).

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
score.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from symskill_pddl.demos import Demo
from symskill_pddl.geometry import Pose, rotation_distance
from symskill_pddl.learning.segments import Rest

Extents = Mapping[str, tuple[float, float, float]]


@dataclass(frozen=True)
class ReferenceConfig:
    """Weights and lengths of the score."""

    gap_m: float = 0.03
    side_gap_m: float = 0.15
    """Decay length of the gap for what is hinged or slides."""
    near_m: float = 0.3
    proximity_weight: float = 0.5
    same_type_penalty: float = 0.5
    alignment_weight: float = 0.25
    aligned_rad: float = float(np.radians(10.0))
    """Of what is hinged or slides: weight of lying as its reference does in one of its rests, and decay angle."""
    minority: int = 1
    """Groups of at most this many guesses join a larger group if its type scores nearly as well."""
    nearly: float = 0.35


@dataclass(frozen=True, eq=False)
class Placement:
    """A rest with its reference: `T_ref_obj` in the frame of the object `ref`.

    `margin` is the lead of the chosen type over the next one in the mean score of its group.
    """

    demo: Demo
    rest: Rest
    ref: str
    T_ref_obj: Pose
    margin: float

    @property
    def types(self) -> tuple[str, str]:
        """Types of the object and of its reference."""
        return self.demo.objects[self.rest.obj], self.demo.objects[self.ref]


def place(
    rests: Sequence[tuple[Demo, Rest]], hinged: bool, extents: Extents, config: ReferenceConfig | None = None
) -> tuple[Placement, ...]:
    """References for the rests of objects of one type, in the order given. `hinged`: the type turns about an axis or slides.

    Rests in scenes that hold no other object are left out.
    """
    config = config or ReferenceConfig()
    table = [_prior_scores(demo, rest, hinged, extents, config) for demo, rest in rests]
    if hinged:
        table = _over_all_rests(rests, table, config)
    groups: dict[str, list[int]] = defaultdict(list)
    for i, scores in enumerate(table):
        if scores:
            best = max(sorted(scores), key=lambda name: scores[name])
            groups[rests[i][0].objects[best]].append(i)
    guesses = [(demo.where, rest.obj, 0 if hinged else i) for i, (demo, rest) in enumerate(rests)]
    groups = _absorbed(groups, guesses, rests, table, config)
    chosen: dict[int, Placement] = {}
    for members in groups.values():
        totals = _type_scores(members, rests, table)
        ranked = sorted(totals, key=lambda t: (-totals[t], t))
        margin = totals[ranked[0]] - totals[ranked[1]] if len(ranked) > 1 else float("inf")
        for i in members:
            demo, rest = rests[i]
            ref = _best_of_type(demo, table[i], ranked[0])
            if ref is not None:
                T = _pose_of(demo, ref, rest).inverse() @ rest.T_world_obj
                chosen[i] = Placement(demo, rest, ref, T, margin)
    return tuple(chosen[i] for i in sorted(chosen))


def _over_all_rests(
    rests: Sequence[tuple[Demo, Rest]], table: Sequence[Mapping[str, float]], config: ReferenceConfig
) -> list[dict[str, float]]:
    """Mean scores over all rests of one object in one demonstration, plus what its alignment says.

    What is hinged or slides hangs on one thing, open or closed, and most often lies in one of its rests as that thing does.
    """
    owners = [(demo.where, rest.obj) for demo, rest in rests]
    result: dict[tuple[str, str], dict[str, float]] = {}
    for owner in dict.fromkeys(owners):
        own = [i for i, o in enumerate(owners) if o == owner]
        result[owner] = {}
        for name in table[own[0]]:
            turned = min(float(rotation_distance(_pose_of(rests[i][0], name, rests[i][1]), rests[i][1].T_world_obj)) for i in own)
            prior = float(np.mean([table[i][name] for i in own]))
            result[owner][name] = prior + config.alignment_weight * float(np.exp(-turned / config.aligned_rad))
    return [result[o] for o in owners]


def _pose_of(demo: Demo, obj: str, rest: Rest) -> Pose:
    return demo.pose(obj)[(rest.start + rest.stop) // 2]


def _prior_scores(demo: Demo, rest: Rest, hinged: bool, extents: Extents, config: ReferenceConfig) -> dict[str, float]:
    own = demo.objects[rest.obj]
    scores = {}
    for name, type_ in demo.objects.items():
        if name == rest.obj or name in rest.parts:
            continue
        T_ref_obj = _pose_of(demo, name, rest).inverse() @ rest.T_world_obj
        contact = _contact(
            T_ref_obj, _pose_of(demo, name, rest), rest.T_world_obj, extents.get(own), extents.get(type_), hinged, config
        )
        proximity = 1.0 / (1.0 + float(np.linalg.norm(T_ref_obj.p)) / config.near_m)
        scores[name] = contact + config.proximity_weight * proximity - (config.same_type_penalty if type_ == own else 0.0)
    return scores


def _contact(
    T_ref_obj: Pose,
    T_world_ref: Pose,
    T_world_obj: Pose,
    own: tuple[float, float, float] | None,
    other: tuple[float, float, float] | None,
    hinged: bool,
    config: ReferenceConfig,
) -> float:
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


def _best_of_type(demo: Demo, scores: Mapping[str, float], type_: str) -> str | None:
    of_type = [name for name in sorted(scores) if demo.objects[name] == type_]
    return max(of_type, key=lambda name: scores[name], default=None)


def _type_scores(
    members: Sequence[int], rests: Sequence[tuple[Demo, Rest]], table: Sequence[Mapping[str, float]]
) -> dict[str, float]:
    """Mean prior of each type that every member's scene holds, plus its dispersion term."""
    common = set.intersection(*({rests[i][0].objects[name] for name in table[i]} for i in members))
    priors, spreads = {}, {}
    for type_ in sorted(common):
        refs = [_best_of_type(rests[i][0], table[i], type_) for i in members]
        pairs = [(i, ref) for i, ref in zip(members, refs, strict=True) if ref is not None]
        priors[type_] = float(np.mean([table[i][ref] for i, ref in pairs]))
        p = np.array([(_pose_of(rests[i][0], ref, rests[i][1]).inverse() @ rests[i][1].T_world_obj).p for i, ref in pairs])
        spreads[type_] = float(np.sqrt(p.var(axis=0).sum()))
    worst, n = max(spreads.values()), len(members)
    weight = (n - 1) / (n + 1) if worst > 1e-9 else 0.0
    return {t: priors[t] + weight * (1.0 - spreads[t] / max(worst, 1e-9)) for t in priors}


def _absorbed(
    groups: Mapping[str, list[int]],
    guesses: Sequence[tuple[str, str, int]],
    rests: Sequence[tuple[Demo, Rest]],
    table: Sequence[Mapping[str, float]],
    config: ReferenceConfig,
) -> dict[str, list[int]]:
    """Tiny groups join the large group whose type explains them nearly as well: one odd guess is not another resting place."""
    # rests that were scored together are one guess
    size = {t: len({guesses[i] for i in m}) for t, m in groups.items()}
    large = {t: list(m) for t, m in groups.items() if size[t] > config.minority or sum(size.values()) <= 3}
    result = {t: list(m) for t, m in large.items()}
    for type_, members in sorted(groups.items()):
        if type_ in large:
            continue
        for i in members:
            own = max(table[i].values())
            fits = {}
            for t in large:
                ref = _best_of_type(rests[i][0], table[i], t)
                if ref is not None and own - table[i][ref] <= config.nearly:
                    fits[t] = table[i][ref]
            target = max(sorted(fits), key=lambda t: fits[t]) if fits else type_
            result.setdefault(target, []).append(i)
    return {t: sorted(m) for t, m in sorted(result.items())}
