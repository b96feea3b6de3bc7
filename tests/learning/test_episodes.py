from itertools import pairwise

import numpy as np
import pytest
from synthetic import Recorder, facing, move_food, record, yaw_pose

from symskill_pddl.demos import Demo
from symskill_pddl.errors import LearningError
from symskill_pddl.geometry import Pose
from symskill_pddl.learning.episodes import segment, segment_all


def world(seed=0, **more):
    objects = {"table": ("table", yaw_pose([0.5, 0, -0.02])), "cheese": ("food", yaw_pose([0.5, 0.0, 0.02])), **more}
    return Recorder(np.random.default_rng(seed), objects, faults=False)


def grip(r, name="cheese"):
    return Pose(r.poses[name].p, facing(0.0, 1.2))


def demo_of(T_ee, T_obj, closed=None):
    n = len(T_ee)
    return Demo(
        name="demo_0",
        source="hand-made",
        task="any",
        times=np.arange(n) * 0.05,
        T_world_ee=T_ee,
        aperture=np.full(n, 0.08),
        gripper_closed=np.zeros(n, bool) if closed is None else closed,
        objects={"box": "box"},
        T_world_objects=Pose(T_obj.p[:, None], T_obj.q[:, None]),
    )


def line(start, stop, n=100, rest=20):
    s = np.concatenate([np.zeros(rest), np.linspace(0, 1, n), np.ones(rest)])[:, None]
    p = np.asarray(start) + s * (np.asarray(stop) - np.asarray(start))
    return Pose(p, np.tile([1.0, 0, 0, 0], (len(p), 1)))


@pytest.mark.parametrize(
    ("task", "count"), [("OpenSingleDoor", 2), ("CloseSingleDoor", 1), ("PnPCabToCounter", 1), ("PnPCounterToCab", 1)]
)
@pytest.mark.parametrize("seed", [0, 1])
def test_faults_of_people_make_no_episodes(task, count, seed):
    for demo in record(task, 6, seed):
        episodes = segment(demo)
        assert len(episodes) == count, [str(e) for e in episodes]
        for e in episodes:
            assert 0 <= e.begin <= e.start < e.stop <= e.leave <= e.end < len(demo)
            assert e.before is not None
            assert e.after is not None
        assert all(a.end <= b.begin for a, b in pairwise(episodes))


def test_a_pause_in_mid_carry_does_not_split_the_motion():
    r = world()
    r.reach(grip(r))
    r.grasp("cheese", 0.05)
    r.go(Pose([0.5, 0.1, 0.2], r.T.q))
    r.rest(3.0)
    r.go(Pose([0.5, 0.3, 0.02], r.T.q))
    r.release()
    r.back_off(0.15)
    r.rest(1.0)
    assert len(segment(r.demo("demo_0", "s", "t"))) == 1


def test_two_contacts_are_two_episodes():
    r = world()
    for y in (0.2, -0.1):
        move_food(r, "cheese", yaw_pose([0.45, y, 0.02]), 1.2)
    assert [e.obj for e in segment(r.demo("demo_0", "s", "t"))] == ["cheese", "cheese"]


def test_a_nudge_and_a_slipped_grasp_are_dropped():
    r = world()
    home = r.poses["cheese"]
    r.reach(grip(r))
    r.grasp("cheese", 0.05)
    r.go(Pose(r.T.p + np.array([0, 0, 0.05]), r.T.q))
    r.carry = None
    for f in (0.7, 0.3, 0.0):
        r.poses["cheese"] = home @ yaw_pose([0.004, 0, 0.05 * f])
        r.rest(0.05)
    r.fingers(False)
    r.back_off(0.1)
    assert segment(r.demo("demo_0", "s", "t")) == ()


def test_what_falls_by_itself_is_no_episode():
    T_obj = line([0.5, 0.0, 0.3], [0.5, 0.0, 0.0], n=8)
    T_ee = Pose(np.tile([0.5, 0.0, 0.32], (len(T_obj), 1)), T_obj.q)
    assert segment(demo_of(T_ee, T_obj)) == ()


def test_what_lies_in_a_drawer_is_a_passenger():
    r = world(drawer=("drawer", yaw_pose([0.55, 0.3, 0.1])), spoon=("spoon", yaw_pose([0.60, 0.3, 0.1])))
    r.reach(Pose([0.40, 0.3, 0.1], facing(0.0, 0.5)))
    r.fingers(True, 0.01)
    T_drawer, T_spoon = (r.T.inverse() @ r.poses[o] for o in ("drawer", "spoon"))
    r.carry = lambda T: {"drawer": T @ T_drawer, "spoon": T @ T_spoon}
    r.go(Pose([0.25, 0.3, 0.1], r.T.q))
    r.release()
    r.back_off(0.1)
    r.rest(1.0)
    (episode,) = segment(r.demo("demo_0", "s", "t", extents=False))
    assert (episode.obj, episode.passengers) == ("drawer", ("spoon",))


def test_a_recording_that_ends_in_the_air_has_no_rest_after():
    r = world()
    r.reach(grip(r))
    r.grasp("cheese", 0.05)
    r.go(Pose([0.5, 0.0, 0.25], r.T.q))
    (episode,) = segment(r.demo("demo_0", "s", "t"))
    assert episode.leave is None
    assert episode.after is None


def test_nothing_moves():
    T = Pose(np.zeros((40, 3)), np.tile([1.0, 0, 0, 0], (40, 1)))
    with pytest.raises(LearningError, match="no object moves in any of the 1 demonstrations"):
        segment_all([demo_of(T, T)])


def test_a_slow_end_in_the_hand_belongs_to_the_motion():
    r = world(door=("door", yaw_pose([0.6, -0.2, 0.4])))
    r.go(Pose([0.5, -0.2, 0.4], facing(0.0, 0.0)))
    hold = r.poses["door"].inverse() @ r.T

    def turn(rate, seconds):
        for _ in range(round(seconds / 0.05)):
            r.poses["door"] = r.poses["door"] @ yaw_pose([0, 0, 0], rate * 0.05)
            r._tick(r.poses["door"] @ hold)

    turn(0.3, 2.0)
    turn(0.025, 5.0)  # below the thresholds, but 7 degrees all the same
    end = len(r.rows)
    r.rest(1.0)
    r.back_off(0.2)
    r.rest(1.0)
    (episode,) = segment(r.demo("demo_0", "s", "t", extents=False))
    assert end - 50 < episode.stop <= end + 5  # it counts until 3.6 degrees are left
    assert episode.stop > episode.start + 80


def test_a_hand_that_comes_back_to_the_same_thing_retreated_as_far_as_it_went():
    """Its first long rest is the next grasp: the retreat ended before, where the hand was farthest away."""
    r = world()
    r.reach(grip(r))
    r.grasp("cheese", 0.04)
    r.go(Pose([0.5, 0.15, 0.1], r.T.q), Pose([0.5, 0.15, 0.02], r.T.q))
    r.release()
    r.back_off(0.12)
    r.go(grip(r), speed=0.3)
    r.grasp("cheese", 0.04)
    r.rest(1.0)
    r.go(Pose([0.5, 0.3, 0.1], r.T.q), Pose([0.5, 0.3, 0.02], r.T.q))
    r.release()
    r.back_off(0.2)
    r.rest(1.0)
    first, second = segment(r.demo("demo_0", "s", "t"))
    away = np.linalg.norm(first.demo.T_world_ee.p - first.demo.T_world_ee.p[first.stop], axis=-1)
    assert away[first.end] > 0.08
    assert first.end <= second.begin
    assert away[second.begin] > 0.11  # the next approach begins where the hand is farthest away
    assert not first.demo.gripper_closed[second.begin]
