"""States of objects, and whose doing their motions were."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from synthetic import Recorder, facing, yaw_pose

from symskill_pddl.demos import import_robosuite
from symskill_pddl.geometry import Pose, quat_exp, quat_multiply
from symskill_pddl.learning.acts import acts, follows
from symskill_pddl.learning.episodes import segment
from symskill_pddl.learning.states import HAND, REST, Measured, StateConfig, spans

RECORDINGS = Path(__file__).parents[1] / "data" / "robosuite"


def measured(demo):
    return Measured.of(demo, 0.08, StateConfig())


def carried(seed=0):
    """A cube grasped, carried 30 cm with a wobble, put down, and left."""
    r = Recorder(
        np.random.default_rng(seed),
        {"table": ("table", yaw_pose([0.5, 0, -0.02])), "cube": ("cube", yaw_pose([0.5, 0.1, 0.02]))},
        faults=False,
    )
    r.reach(Pose(r.poses["cube"].p, facing(0.0, 1.4)))
    r.grasp("cube", 0.04)
    r.go(Pose([0.5, 0.1, 0.15], r.T.q), Pose([0.45, -0.05, 0.2], r.T.q), Pose([0.5, -0.2, 0.02], r.T.q))
    r.release()
    r.back_off(0.15)
    r.rest(1.0)
    return r.demo("demo_0", "s", "t")


def test_a_carry_is_rest_hand_rest():
    m = measured(carried())
    assert [s.state for s in spans(m, "table")] == [REST]
    assert [s.state for s in spans(m, "cube") if s.stop - s.start > 8] == [REST, HAND, REST]


def test_a_carry_is_a_grasp_and_the_cube_is_free():
    m = measured(carried())
    (act,) = acts(m, "cube", spans(m, "cube"))
    assert act.with_hand
    assert act.near
    assert m.demo.gripper_closed[act.grasped]
    assert not m.demo.gripper_closed[act.grasped - 1]
    assert act.grasped <= act.start
    assert follows(m, act) == pytest.approx(1.0, abs=0.1)


def test_a_gap_in_sight_while_it_is_carried_changes_nothing():
    demo = carried()
    (whole,) = segment(demo)
    seen = demo.seen.copy()
    middle = (whole.start + whole.stop) // 2
    seen[middle - 5 : middle + 5, 1] = False
    (gap,) = segment(replace(demo, seen=seen))
    assert gap.held
    assert abs(gap.start - whole.start) <= 1
    assert abs(gap.stop - whole.stop) <= 1


@pytest.mark.parametrize("factor", [0.3, 3.0])
def test_sizes_and_speeds_are_the_recordings_own(factor):
    demo = carried()
    (whole,) = segment(demo)
    (quick,) = segment(replace(demo, times=demo.times / factor))
    assert (quick.held, quick.begin) == (True, whole.begin)
    assert abs(quick.start - whole.start) <= 2
    large = replace(
        demo,
        T_world_ee=Pose(factor * demo.T_world_ee.p, demo.T_world_ee.q),
        T_world_objects=Pose(factor * demo.T_world_objects.p, demo.T_world_objects.q),
        aperture=factor * demo.aperture,
    )
    (sized,) = segment(large)
    assert (sized.held, sized.start, sized.stop) == (True, whole.start, whole.stop)


def test_jitter_of_three_millimetres_and_two_degrees_leaves_the_grasp():
    demo = carried()
    rng = np.random.default_rng(1)
    T, shape = demo.T_world_objects, (*demo.seen.shape, 3)
    turn = quat_exp(rng.normal(0.0, np.radians(2.0), shape))
    noisy = replace(demo, T_world_objects=Pose(T.p + rng.normal(0.0, 0.003, shape), quat_multiply(T.q, turn)))
    (e,) = segment(noisy)
    assert e.held
    assert e.before is not None
    assert e.after is not None


def test_what_others_move_far_from_the_hand_is_no_episode():
    demo = carried()
    n = len(demo)
    p = np.tile([3.0, 0.0, 0.0], (n, 1))
    p[:, 1] += np.clip(np.linspace(-1.0, 2.0, n), 0.0, 1.0)
    T = Pose(np.stack([demo.pose("table").p, p], axis=1), demo.T_world_objects.q)
    extents = {"cube": (0.02, 0.02, 0.02)}
    assert segment(replace(demo, T_world_objects=T, extents=extents)) == ()


def test_a_recording_that_begins_in_the_hand_is_a_place_without_a_pick():
    demo = carried()
    (whole,) = segment(demo)
    first = (whole.start + whole.stop) // 2
    half = replace(
        demo,
        times=demo.times[first:],
        T_world_ee=demo.T_world_ee[first:],
        T_world_objects=demo.T_world_objects[first:],
        aperture=demo.aperture[first:],
        gripper_closed=demo.gripper_closed[first:],
        seen=demo.seen[first:],
    )
    (e,) = segment(half, length_m=0.08)
    assert (e.before, e.grasped, e.begin) == (None, 0, 0)
    assert e.after is not None


def test_a_person_regrasps_a_nut_and_both_nuts_are_grasped_once():
    """The first 0.2 s are the nuts' fall into place; a brush at 31.8 s and a first try at 34.0 s belong to the second grasp."""
    (demo,) = import_robosuite(RECORDINGS / "panda_nut-assembly.hdf5")
    first, second = segment(demo)
    assert (first.obj, second.obj) == ("RoundNut0", "SquareNut0")
    assert first.held
    assert second.held
    assert [round(float(demo.times[e.grasped]), 2) for e in (first, second)] == [7.85, 34.6]
    assert first.end <= second.begin < second.grasped
    assert second.after is not None
    assert min(first.follows, second.follows) > 0.8
