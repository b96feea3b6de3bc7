"""Two identical tins in every scene, either of which is moved: what is learned never takes the one for the other."""

import numpy as np
import pytest
from synthetic import EXTENTS, Recorder, in_cabinet, kitchen, move_food, yaw_pose

from .conftest import Symbols

NAMES = ("can-1", "can-2")


def demonstration(k):
    """Out of the cabinet (even k) or into it: tin 1 or 2, the other beside it or where the first is to go."""
    rng = np.random.default_rng(k)
    r = Recorder(rng, kitchen(rng, 1.6) | {name: ("food", yaw_pose([0, 0, 0])) for name in NAMES}, faults=False)
    inside = in_cabinet(r.poses["cabinet"], rng)
    top = r.poses["counter"]
    moved, other = NAMES if (k // 2) % 2 else NAMES[::-1]
    spots = [top @ yaw_pose([-0.1, y, 0.04], rng.uniform(-0.3, 0.3)) for y in (0.0, 0.12, -0.13)]
    r.poses[moved], goal = (inside, spots[0]) if k % 2 == 0 else (spots[0], inside)
    beside = inside @ yaw_pose([0.0, 0.09, 0.0])
    r.poses[other] = (spots[1], beside)[(k // 4) % 2]
    r.rows.clear()
    r._record()
    move_food(r, moved, goal, 0.7)
    return moved, r.demo(f"demo_{k}", "tins", "out" if k % 2 == 0 else "in")


@pytest.fixture(scope="module")
def learned():
    shown = [demonstration(k) for k in range(12)]
    return {demo.where: moved for moved, demo in shown}, Symbols.of([demo for _, demo in shown])


def test_the_moved_tin_is_the_bound_one(learned):
    moved, symbols = learned
    assert EXTENTS["food"]
    names = {"pick-food-from-cabinet", "pick-food-from-counter", "place-food-in-cabinet", "place-food-on-counter"}
    assert set(symbols.groups) == names
    bound = [(t.demo.where, b["?food"]) for g in symbols.groups.values() for t, b in zip(g.transitions, g.bindings, strict=True)]
    assert len(bound) == 24
    assert all(obj == moved[where] for where, obj in bound)


def test_every_effect_is_seen_with_its_binding_in_every_demonstration(learned):
    _, symbols = learned
    for group in symbols.groups.values():
        op = group.learned.operator
        for t, binding in zip(group.transitions, group.bindings, strict=True):
            assert {a.substitute(binding) for a in op.add} <= t.after
            assert not {a.substitute(binding) for a in op.delete} & t.after
            assert {a.substitute(binding) for a in op.pre} <= t.before
            assert len(set(binding.values())) == len(binding)


def test_the_other_tin_is_no_part_of_any_operator(learned):
    _, symbols = learned
    for group in symbols.groups.values():
        assert [p.type for p in group.learned.operator.parameters].count("food") == 1
        assert not group.learned.operator.absent
