import numpy as np
import pytest

from symskill_pddl.demonstrator.poses import hand_pose
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.layout import Box
from symskill_pddl.panda import reach


def test_hand_pose_looks_where_it_says():
    T = hand_pose((0.1, 0.2, 0.3), 0.0, np.radians(30))
    np.testing.assert_allclose(T.p, (0.1, 0.2, 0.3))
    np.testing.assert_allclose(T.rotate([0.0, 0.0, 1.0]), (np.cos(np.radians(30)), 0.0, -0.5), atol=1e-12)
    np.testing.assert_allclose(T.rotate([0.0, 1.0, 0.0]), (0.0, 1.0, 0.0), atol=1e-12)
    left = hand_pose((0.0, 0.0, 0.0), np.radians(90), 0.0)
    np.testing.assert_allclose(left.rotate([0.0, 0.0, 1.0]), (0.0, 1.0, 0.0), atol=1e-12)


def test_box_contains_with_margin():
    box = Box((1.0, 0.0, 0.0), (0.5, 0.1, 0.1))
    assert box.contains(np.array([1.4, 0.0, 0.0]))
    assert not box.contains(np.array([1.4, 0.0, 0.0]), margin=0.2)
    assert not box.contains(np.array([1.0, 0.2, 0.0]))


@pytest.fixture(scope="module")
def physics():
    from symskill_pddl.kitchen.physics import Physics

    physics = Physics()
    physics.forward()
    return physics


REACH = {
    "handle": hand_pose(np.add(np.add(layout.CABINET.center, layout.DOOR.center), layout.HANDLE), np.radians(15), np.radians(15)),
    "cabinet floor": hand_pose(np.add(layout.CABINET.center, (-0.08, 0.0, -0.16)), 0.0, np.radians(40)),
    "cabinet floor, steep": hand_pose(np.add(layout.CABINET.center, (-0.06, 0.05, -0.16)), 0.0, np.radians(55)),
    "counter, left": hand_pose((0.43, 0.37, 0.02), 0.0, np.radians(45)),
    "counter, far left": hand_pose((0.46, 0.43, 0.02), np.radians(-15), np.radians(50)),
    "counter, right": hand_pose((0.43, -0.35, 0.02), 0.0, np.radians(50)),
    "counter, ahead": hand_pose((0.50, 0.0, 0.02), 0.0, np.radians(85)),
}


@pytest.mark.simulation
@pytest.mark.parametrize("name", REACH)
def test_within_reach(physics, name):
    q = reach.solve(physics, REACH[name])
    assert q is not None
    physics.set_arm(q)
    physics.forward()
    np.testing.assert_allclose(physics.T_world_ee().p, REACH[name].p, atol=2e-3)


@pytest.mark.simulation
def test_out_of_reach_is_told_and_the_arm_left_alone(physics):
    before = physics.arm.copy()
    assert reach.solve(physics, hand_pose((1.5, 0.0, 0.3), 0.0, 0.0)) is None
    np.testing.assert_array_equal(physics.arm, before)
