"""Demonstrations made harder: noise on poses, things standing about, approaches done again. For scores of learning.

Every function takes a demonstration with its truth and returns both, changed alike; all chance comes from the generator.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.demos.demo import Demo
from symskill_pddl.demos.truth import Relation, Truth
from symskill_pddl.geometry import Array, Pose, quat_exp, quat_multiply

TURN_RAD_M = 2.0
"""Noise turns a frame by this much for every metre that it shifts it: 1 cm goes with 1.1 degrees."""
JITTER = 0.05
"""Of the noise, the part that changes from sample to sample; the rest is a constant error of each object's tracker."""
CLEAR_M = 0.06
"""Nothing comes nearer than this to a thing that stands about, at any time."""
AGAIN_S = 1.2
"""How far back in time a hand goes before it approaches again [s]."""
RESTED_S = 0.5
"""After a move, the hand is not sent back before this has passed [s]."""
STRANGERS = ("bottle", "mug", "box")
"""Types of the things that stand about, besides those of the scene."""
STRANGER_HALF = (0.03, 0.03, 0.03)
"""Their half sizes [m]."""


def with_noise(demo: Demo, truth: Truth, sigma_m: float, rng: np.random.Generator) -> tuple[Demo, Truth]:
    """Every object's pose off by a constant of standard deviation `sigma_m` [m] per axis, and by a little jitter on top."""
    shape = demo.T_world_objects.shape

    def drawn(scale: float) -> Array:
        constant = rng.normal(0.0, scale, (1, shape[1], 3))
        return np.asarray(constant + rng.normal(0.0, JITTER * scale, (*shape, 3)))

    p = demo.T_world_objects.p + drawn(sigma_m)
    q = quat_multiply(demo.T_world_objects.q, quat_exp(drawn(TURN_RAD_M * sigma_m)))
    return replace(demo, T_world_objects=Pose(p, q)), truth


def with_distractors(demo: Demo, truth: Truth, n: int, rng: np.random.Generator) -> tuple[Demo, Truth]:
    """`n` more things on what others lie on, out of everybody's way: every other one of a type that the scene has.

    Fewer, where there is no room for more.
    """
    lying = sorted({(obj, ref) for kind, obj, ref in truth.relations if kind == "at" and truth.relations[kind, obj, ref][0]})
    objects, extents = dict(demo.objects), dict(demo.extents)
    T, relations = demo.T_world_objects, dict(truth.relations)
    for k in range(n if lying else 0):
        obj, ref = lying[int(rng.integers(len(lying)))]
        p = _free_spot(demo, T, obj, ref, rng)
        if p is None:
            continue
        type_ = demo.objects[obj] if k % 2 else STRANGERS[(k // 2) % len(STRANGERS)]
        name = f"distractor-{k + 1}"
        objects[name] = type_
        extents.setdefault(type_, STRANGER_HALF)
        turn = quat_exp(np.array([0.0, 0.0, rng.uniform(-np.pi, np.pi)]))
        pose = Pose(p, quat_multiply(turn, demo.pose(obj).q[0]))
        T = Pose(
            np.concatenate([T.p, np.broadcast_to(pose.p, (len(demo), 1, 3))], axis=1),
            np.concatenate([T.q, np.broadcast_to(pose.q, (len(demo), 1, 4))], axis=1),
        )
        relations["at", name, ref] = np.ones(len(demo), dtype=bool)
    seen = np.concatenate([demo.seen, np.ones((len(demo), len(objects) - len(demo.objects)), bool)], axis=1)
    return replace(demo, objects=objects, extents=extents, T_world_objects=T, seen=seen), Truth(truth.moves, relations)


def _free_spot(demo: Demo, T_world_objects: Pose, obj: str, ref: str, rng: np.random.Generator) -> Array | None:
    """A place (3,) as high as the object, on the same reference, that nothing comes near; None if none is found."""
    # the origins of fixtures are no obstacles, what lies on them is
    ways = np.concatenate([T_world_objects.p.reshape(-1, 3), demo.T_world_ee.p])
    half = demo.extents.get(demo.objects[ref])
    T_world_ref = demo.pose(ref)[0]
    for _ in range(200):
        angle, distance = rng.uniform(0.0, 2 * np.pi), rng.uniform(0.08, 0.35)
        p = demo.pose(obj).p[0] + distance * np.array([np.cos(angle), np.sin(angle), 0.0])
        inside = T_world_ref.inverse().apply(p)
        if half is not None and np.any(np.abs(inside[:2]) > np.array(half[:2]) - 0.03):
            continue
        if np.linalg.norm(ways - p, axis=-1).min() > CLEAR_M:
            return np.asarray(p)
    return None


def with_approaches_again(demo: Demo, truth: Truth, n: int) -> tuple[Demo, Truth]:
    """The hand goes back the way it came and comes again, `n` times, spread over the moves in turn."""
    for k in range(n if truth.moves else 0):
        demo, truth = _again(demo, truth, k % len(truth.moves))
    return demo, truth


def _again(demo: Demo, truth: Truth, which: int) -> tuple[Demo, Truth]:
    start = int(np.searchsorted(demo.times, truth.moves[which].start_s - 1e-9))
    earlier = [
        int(np.searchsorted(demo.times, m.stop_s + RESTED_S)) for m in truth.moves if m.stop_s <= truth.moves[which].start_s
    ]
    # from where the fingers have not yet been told anything for this move
    changes = np.flatnonzero(np.diff(demo.gripper_closed[: start + 1].astype(np.int8)))
    since = max([0, *earlier, *(int(c) + 1 for c in changes[:-1])])
    turn = int(changes[-1]) if len(changes) and changes[-1] >= since else start - 4
    back = max(turn - round(AGAIN_S / float(np.median(np.diff(demo.times)))), since)
    if turn - back < 4:
        return demo, truth
    index = np.concatenate([np.arange(turn), np.arange(turn - 1, back, -1), np.arange(back, len(demo))])
    return _resampled(demo, truth, index)


def _resampled(demo: Demo, truth: Truth, index: NDArray[np.intp]) -> tuple[Demo, Truth]:
    """Samples `index` of a demonstration, at its usual rate."""
    period = float(np.median(np.diff(demo.times)))
    times = demo.times[0] + period * np.arange(len(index))
    last = {int(old): new for new, old in enumerate(index)}

    def clock(seconds: float) -> float:
        return float(times[last[int(np.searchsorted(demo.times, seconds - 1e-9))]])

    moves = tuple(replace(m, start_s=clock(m.start_s), stop_s=clock(m.stop_s)) for m in truth.moves)
    relations: dict[Relation, NDArray[np.bool_]] = {relation: value[index] for relation, value in truth.relations.items()}
    changed = replace(
        demo,
        times=times,
        T_world_ee=demo.T_world_ee[index],
        aperture=demo.aperture[index],
        gripper_closed=demo.gripper_closed[index],
        T_world_objects=demo.T_world_objects[index],
        seen=demo.seen[index],
    )
    return changed, Truth(moves, relations)


__all__ = ["with_approaches_again", "with_distractors", "with_noise"]
