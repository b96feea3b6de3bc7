"""Recordings that end early, and parts that move the body they hang on; by hand, and as people recorded them."""

from pathlib import Path

import numpy as np
import pytest
from synthetic import Recorder, facing, yaw_pose

from symskill_pddl.demos import import_robosuite
from symskill_pddl.geometry import Pose
from symskill_pddl.learning import LearnConfig, learn_reported
from symskill_pddl.learning.episodes import segment
from symskill_pddl.learning.skills import SkillConfig
from symskill_pddl.symbols import Atom

FAST = LearnConfig(skills=SkillConfig(max_fields=1))
RECORDINGS = Path(__file__).parents[1] / "data" / "robosuite"


def lifted():
    """A cube lifted and lowered again elsewhere, the hand still around it."""
    r = Recorder(
        np.random.default_rng(0),
        {"table": ("table", yaw_pose([0.5, 0, -0.02])), "cube": ("cube", yaw_pose([0.5, 0.1, 0.02]))},
        faults=False,
    )
    r.reach(Pose(r.poses["cube"].p, facing(0.0, 1.4)))
    r.grasp("cube", 0.04)
    r.go(Pose([0.5, 0.1, 0.2], r.T.q))
    return r


def only(r):
    (episode,) = segment(r.demo("demo_0", "s", "Lift"))
    return episode


def test_what_is_released_and_lies_still_for_a_moment_rests_there():
    r = lifted()
    r.go(Pose([0.5, -0.1, 0.02], r.T.q))
    r.release()
    r.rest(0.4)
    e = only(r)
    assert (e.leave, e.after.obj, e.end) == (None, "cube", len(e.demo) - 1)
    np.testing.assert_allclose(e.after.T_world_obj.p, [0.5, -0.1, 0.02], atol=0.01)
    assert e.stop < len(e.demo)


def test_what_is_held_rests_nowhere():
    r = lifted()
    r.rest(0.6)
    assert only(r).after is None


def test_what_is_let_go_of_is_put_down_though_the_recording_ends_before_the_hand_leaves():
    def placed(name, leaves):
        r = lifted()
        r.go(Pose([0.5, -0.3, 0.02], r.T.q))
        r.release()
        r.rest(0.4)
        if leaves:
            r.back_off(0.1)
            r.rest(1.0)
        return r.demo(name, "s", "Move")

    library, report = learn_reported([placed("demo_0", False), placed("demo_1", True)], FAST)
    (place,) = (o for o in library.operators if o.kind == "place")
    assert place.operator.delete == {Atom("gripper-holds-cube", ("?cube",))}
    assert [e.demo for e in place.evidence] == ["s:demo_0", "s:demo_1"]
    assert report.left_out == ()


def door_demo(latch_first: bool):
    """A latch on a door on a frame; pulled by the latch, which turns first or not at all. Ends while the door moves."""
    r = Recorder(
        np.random.default_rng(0),
        {
            "frame": ("frame", yaw_pose([0.6, -0.2, 0.4])),
            "door": ("door", yaw_pose([0.6, -0.2, 0.4])),
            "latch": ("latch", yaw_pose([0.6, 0.1, 0.4])),
        },
        faults=False,
    )
    r.go(Pose([0.5, 0.1, 0.4], facing(0.0, 0.0)))
    r.rest(0.5)
    hold = r.poses["latch"].inverse() @ r.T
    for step in range(60 if latch_first else 0):
        r.poses["latch"] = r.poses["latch"] @ Pose.from_rotvec([0, 0, 0], [0.02 if step < 50 else 0.0, 0, 0])
        r._tick(r.poses["latch"] @ hold)
    hang = r.poses["door"].inverse() @ r.poses["latch"]
    for _ in range(50):
        r.poses["door"] = r.poses["door"] @ yaw_pose([0, 0, 0], 0.01)
        r.poses["latch"] = r.poses["door"] @ hang
        r._tick(r.poses["latch"] @ hold)
    return r


def test_a_latch_that_turns_first_is_part_of_the_door_that_follows():
    e = only(door_demo(True))
    assert (e.obj, e.body, e.moved) == ("latch", "door", "door")
    assert (e.before.obj, e.body_before.obj, e.after.obj) == ("latch", "door", "door")
    assert e.after.parts == ("latch",)


def test_what_moves_with_its_carrier_from_the_first_is_no_body():
    e = only(door_demo(False))
    assert e.body is None
    assert e.after is not None  # hinged: it stays where it is left


@pytest.fixture(scope="module")
def stack():
    return learn_reported(import_robosuite(RECORDINGS / "panda_stack.hdf5"), FAST)[0]


@pytest.fixture(scope="module")
def door():
    return learn_reported(import_robosuite(RECORDINGS / "panda_door.hdf5"), FAST)[0]


def test_a_stack_recorded_by_a_person_is_a_pick_and_a_place(stack):
    assert [(o.operator.name, o.kind) for o in stack.operators] == [
        ("pick-cubea-from-table", "pick"),
        ("place-cubea-on-cubeb", "place"),
    ]
    pick, place = (o.operator for o in stack.operators)
    assert Atom("cubea-at-table", ("?cubea", "?table")) in pick.pre & pick.delete
    assert place.pre == {Atom("gripper-holds-cubea", ("?cubea",))}
    assert place.add == {Atom("cubea-on-cubeb", ("?cubea", "?cubeb")), Atom("gripper-open")}
    # the fingers let go, though the hand is not seen to leave
    assert place.delete == {Atom("gripper-holds-cubea", ("?cubea",))}
    skill = stack.skills["place-cubea-on-cubeb"]
    assert {p.frame for p in skill.phases} == {"?cubeb"}
    assert not skill.close_gripper_at_end


def test_a_door_recorded_by_a_person_opens_once_its_latch_is_turned(door):
    opened, reach, turn = (door.learned(n).operator for n in ("move-door-at-22deg", "reach-latch-unturned", "turn-latch"))
    hand, turned = Atom("gripper-at-latch", ("?latch",)), Atom("latch-turned", ("?latch", "?door"))
    assert reach.add == {hand}
    assert (turn.add, hand in turn.pre) == ({turned}, True)
    assert opened.pre >= {hand, turned}
    assert (opened.add, opened.delete) == (
        {Atom("door-at-22deg", ("?door", "?frame"))},
        {Atom("door-at-0deg", ("?door", "?frame"))},
    )
    assert any("no retreat" in note for note in door.learned("move-door-at-22deg").notes)
    (goal,) = door.goals
    assert goal.atoms == {Atom("door-at-22deg", ("?door", "?frame")), turned}
