"""Where things rest: clusters of rest poses at one type of reference."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.geometry import Array, Pose
from symskill_pddl.learning.articulation import UP, Joint
from symskill_pddl.learning.references import Placement
from symskill_pddl.learning.relations import Place, PredicateConfig
from symskill_pddl.learning.report import SHOW_AGAIN, LeftOut
from symskill_pddl.learning.segments import RestKey
from symskill_pddl.learning.shapes import clusters, fit_shape, free_yaw, lifted


@dataclass(frozen=True, eq=False)
class _Rests:
    """What distances between rests (n,) are made of: the joint's coordinate, or heights, places across and tilts."""

    joint: Joint | None
    config: PredicateConfig
    coordinate: Array
    height: Array
    across: Array
    lean: Array

    @classmethod
    def of(cls, found: Sequence[Placement], joint: Joint | None, config: PredicateConfig) -> _Rests:
        T_ref_obj, T_world_obj = Pose.stack([p.T_ref_obj for p in found]), Pose.stack([p.rest.T_world_obj for p in found])
        lean = T_world_obj.inverse().rotate(UP)
        up = T_ref_obj.rotate(lean)
        height = np.sum(T_ref_obj.p * up, axis=-1)
        coordinate = joint.coordinate(T_ref_obj) if joint is not None else np.zeros(len(found))
        return cls(joint, config, coordinate, height, T_ref_obj.p - height[:, None] * up, lean)

    def distances(self, i: NDArray[np.intp], j: NDArray[np.intp], lateral: float = 1.0) -> Array:
        """Of rests i (n,) to rests j (m,), as a matrix (n, m): joint coordinates, or metres with heights and tilts weighted."""
        if self.joint is not None:
            d = np.abs(self.coordinate[i][:, None] - self.coordinate[j][None])
            return np.minimum(d, 2 * np.pi - d) if self.joint.kind == "hinge" else d
        tilt = np.arccos(np.clip(self.lean[i] @ self.lean[j].T, -1.0, 1.0))
        across = lateral * np.linalg.norm(self.across[i][:, None] - self.across[j][None], axis=-1)
        rise = self.config.vertical_weight * np.abs(self.height[i][:, None] - self.height[j][None])
        return np.asarray(np.sqrt(across**2 + rise**2 + (self.config.tilt_m_rad * tilt) ** 2))


@dataclass(frozen=True, eq=False)
class Clustered:
    """What clustering has found so far.

    Attributes
    ----------
    odd : dict of str to bool
        By demonstration, whether what it alone shows is left out.
    places : list of Place
    of_rest : dict of RestKey to (int or None, str)
        By rest, its place, None where it was left out, and the object that it is at.
    left_out : list of LeftOut
    """

    odd: Mapping[str, bool]
    places: list[Place] = field(default_factory=list)
    of_rest: dict[RestKey, tuple[int | None, str]] = field(default_factory=dict)
    left_out: list[LeftOut] = field(default_factory=list)


def cluster_pair(
    found: Sequence[Placement],
    joint: Joint | None,
    apart: Sequence[tuple[int, int]],
    into: Clustered,
    config: PredicateConfig,
) -> None:
    """Clusters of one (object type, reference type), added to what was found before."""
    # static ones behind those that a motion began or ended with
    ordered = sorted(found, key=lambda p: p.rest.static)
    n = sum(not p.rest.static for p in found)
    if not n:
        return
    rests, moved = _Rests.of(ordered, joint, config), np.arange(n)
    gap, floor = _gap(joint, config)
    if joint is None and ordered[0].rest.held:  # lifted, more or less high
        labels = np.zeros(n, dtype=np.intp)
    else:
        labels = clusters(rests.distances(moved, moved), gap, config.ratio, floor, apart)
    core = [np.flatnonzero(labels == k).tolist() for k in range(labels.max() + 1)]
    groups: list[list[int]] = []
    for members in core:
        only = ordered[members[0]]
        if len(members) == 1 and into.odd[only.demo.where] and len(core) > 1:
            start_s, stop_s = only.demo.times[[only.rest.start, only.rest.stop - 1]].tolist()
            reason = f"it rests at {only.ref} where no other demonstration leaves one"
            into.left_out.append(LeftOut(only.demo.where, start_s, stop_s, only.rest.obj, reason, SHOW_AGAIN))
            into.of_rest[only.rest.key] = (None, only.ref)
        else:
            groups.append(members)
    for static in range(n, len(ordered)):
        _adopt(static, groups, rests)
    for group in groups:
        for i in group:
            into.of_rest[ordered[i].rest.key] = (len(into.places), ordered[i].ref)
        into.places.append(_place_of([ordered[i] for i in group], joint, config))


def _adopt(static: int, groups: Sequence[list[int]], rests: _Rests) -> None:
    """An untouched object widens the nearest cluster, if it is near enough; it never founds one."""
    config, own = rests.config, np.array([static])
    best: tuple[float, list[int]] | None = None
    for members in groups:
        others = np.array(members)
        d = rests.distances(own, others)[0]
        if rests.joint is None:
            flat = rests.distances(own, others, lateral=0.0)[0]
            d = np.where(flat < config.free_gap_m / 2, d * config.free_gap_m / config.static_gap_m, np.inf)
        nearest = float(d.min())
        if best is None or nearest < best[0]:
            best = (nearest, members)
    if best is not None and best[0] < _gap(rests.joint, config)[0]:
        best[1].append(static)


def _gap(joint: Joint | None, config: PredicateConfig) -> tuple[float, float]:
    """Smallest gap between clusters, and the spread within them that goes without saying."""
    if joint is None:
        return config.free_gap_m, config.free_gap_m
    return (config.hinge_gap_rad, float(np.radians(2.0))) if joint.kind == "hinge" else (config.slide_gap_m, 0.005)


def _up_in_ref(p: Placement) -> Array:
    return p.T_ref_obj.rotate(p.rest.T_world_obj.inverse().rotate(UP))


def _place_of(members: Sequence[Placement], joint: Joint | None, config: PredicateConfig) -> Place:
    poses = Pose.stack([p.T_ref_obj for p in members])
    moved = [p for p in members if not p.rest.static]
    if joint is None:
        up = np.mean([p.rest.T_world_obj.inverse().rotate(UP) for p in members], axis=0)
        axis = config.symmetry.get(members[0].types[0])
        if axis is None:
            axis = free_yaw(poses, up / np.linalg.norm(up), config.free_shape)
        above = np.mean([_up_in_ref(p) for p in members], axis=0)
        # bystanders widen a place and do not make it surer: ten recordings of one scene show where they lie once
        shape = fit_shape(poses, len(moved), config.free_shape, axis, above / np.linalg.norm(above))
        if moved[0].rest.held:
            shape = lifted(shape, above / np.linalg.norm(above), min(p.lifted_m for p in moved), config.static_gap_m)
        coordinate = 0.0
    else:
        shape = fit_shape(poses, len(members), config.joint_shape)
        coordinate = float(joint.coordinate(shape.T_mean))
    demos = frozenset(p.demo.where for p in moved)
    margin = min(p.margin for p in moved)
    return Place(members[0].types, shape, joint, coordinate, demos, margin, joint is None and moved[0].rest.held)
