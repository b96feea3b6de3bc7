"""Hints: what a person says counts, unless the recordings contradict it, and the library knows what was said."""

from dataclasses import replace

import numpy as np
import pytest
from synthetic import Recorder, facing, record, yaw_pose

from symskill_pddl.errors import InputError, LearningError
from symskill_pddl.geometry import Pose, quat_multiply
from symskill_pddl.learning import LearnConfig, learn, learn_symbols
from symskill_pddl.learning.hints import Hints, hinted
from symskill_pddl.learning.skills import SkillConfig
from symskill_pddl.library import Library


@pytest.fixture(scope="module")
def door():
    return record("OpenSingleDoor", 2, faults=False)


@pytest.fixture(scope="module")
def food():
    return record("PnPCounterToCab", 2, faults=False)


def places(demos, **hints):
    return set(learn_symbols(hinted(demos, Hints(**hints)), LearnConfig(hints=Hints(**hints))).places)


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ({"upp": "z"}, "there is no hint 'upp'; there are: .*up"),
        ({"leave_out": {"object": []}}, "there is no hint 'leave_out.object'"),
        ({"up": "w"}, "hint up: 'w' is none of"),
        ({"up": 3}, "hint 'up' has to be a text"),
        ({"types": "cube"}, "hint 'types' has to be a table of texts"),
        ({"joints": {"door": "hinge"}}, "hint joints.door: 'hinge' is none of free, prismatic, revolute"),
        ({"symmetry": {"can": "up"}}, "hint symmetry.can: 'up' is none of"),
        ({"fingers": "swapped"}, "hint fingers: 'swapped'"),
        ({"closed": {"door": "at the start"}}, "hint closed.door: 'at the start' is no moment"),
        ({"leave_out": {"spans": ["demo_0"]}}, "'demo_0' is no span"),
        ({"leave_out": {"spans": "demo_0"}}, "has to be a list of texts"),
    ],
)
def test_what_is_no_hint_is_refused(document, message):
    with pytest.raises(InputError, match=message):
        Hints.of(document)


def test_a_document_of_hints_comes_back():
    document = {
        "up": "-y",
        "types": {"a": "cube"},
        "joints": {"block": "free"},
        "leave_out": {"objects": ["lamp"], "spans": ["d:demo_0@1-2.5"]},
    }
    assert Hints.of(document).document() == document
    assert Hints().document() == {}


@pytest.mark.parametrize(
    ("hints", "message"),
    [
        ({"types": {"ball": "toy"}}, "hint types.ball: no demonstration has 'ball'; there are: "),
        ({"objects": ("lamp",)}, "hint leave_out.objects: no demonstration has 'lamp'"),
        ({"joints": {"hatch": "free"}}, "hint joints.hatch: no demonstration has 'hatch'"),
        ({"references": {"door": "wall"}}, "hint references.door: no demonstration has 'wall'"),
        ({"spans": ("other:demo_0@0-1",)}, "hint leave_out.spans: no demonstration has 'other:demo_0'"),
        ({"fingers": "inverted"}, "apart when told to close and .* as recorded they agree"),
        ({"symmetry": {"door": "z"}}, r"hint symmetry.door: in .* it measures 1.8 by 38.0 cm across its z axis"),
        ({"types": {"door": "counter"}}, "too different for one type"),
    ],
)
def test_hints_that_the_recordings_contradict(door, hints, message):
    with pytest.raises(InputError, match=message):
        hinted(door, Hints(**hints))


def test_a_joint_that_is_none_contradicts_its_hint(door, food):
    with pytest.raises(LearningError, match=r"hint joints.food: revolute, but the recordings say that"):
        places(food, joints={"food": "revolute"})
    with pytest.raises(LearningError, match=r"hint joints.door: prismatic, but the recordings say that it is revolute"):
        places(door, joints={"door": "prismatic"})


def slid(name, seed):
    """A block that is taken along a straight line on a table."""
    rng = np.random.default_rng(seed)
    at = np.array([0.5 + 0.01 * seed, -0.2, 0.02])
    r = Recorder(rng, {"table": ("table", yaw_pose([0.5, 0, -0.02])), "block": ("block", yaw_pose(at))}, faults=False)
    r.reach(Pose(at, facing(0.0, 1.4)))
    r.grasp("block", 0.04)
    r.go(Pose(at + np.array([0.0, 0.4, 0.0]), r.T.q))
    r.release()
    r.back_off(0.15)
    r.rest(1.0)
    return r.demo(name, "slide", "Slide")


def test_what_is_said_to_be_free_has_no_joint():
    demos = [slid(f"demo_{k}", k) for k in range(3)]
    assert all(name.startswith("block-at-table") for name in places(demos, joints={"block": "free"}))


def test_without_extents_nothing_is_called_closed_unless_somebody_says_so(door):
    blind = tuple(replace(d, extents={}) for d in door)
    names = places(blind)
    assert "door-at-0deg" in names
    assert all(name.startswith("door-at-") for name in names)
    first = f"{blind[0].where}@0.0"
    assert places(blind, closed={"door": first}) == {"door-closed", "door-ajar", "door-open"}
    moving = f"{blind[0].where}@{blind[0].duration_s / 2:.2f}"
    last = f"{blind[0].where}@{blind[0].duration_s:.2f}"
    assert places(blind, closed={"door": last}) == {"door-closed", "door-ajar", "door-open"}
    assert moving != last


def test_a_frame_that_is_turned_changes_no_name(door):
    turn = Pose.from_rotvec([0, 0, 0], [0, 0, -1.65])

    def turned(demo):
        column = list(demo.objects).index("door")
        q = demo.T_world_objects.q.copy()
        q[:, column] = quat_multiply(q[:, column], turn.q)
        return replace(demo, extents={}, T_world_objects=Pose(demo.T_world_objects.p, q))

    blind = tuple(replace(d, extents={}) for d in door)
    assert places(tuple(map(turned, door))) == places(blind)


def test_references_that_are_said_are_taken(food):
    assert "food-in-cabinet" in places(food)
    assert not {"food-in-cabinet"} & places(food, references={"food": "counter"})


def test_objects_and_times_are_left_out(food):
    demo = food[0]
    (left, _) = hinted(food, Hints(objects=("counter",), spans=(f"{demo.where}@0.0-1.0",)))
    assert "counter" not in left.objects
    assert left.times[0] > 1.0
    assert len(left) < len(demo)
    with pytest.raises(InputError, match="nothing is left of"):
        hinted(food, Hints(spans=(f"{demo.where}@0-1000",)))


def test_another_axis_may_point_up(food):
    lying = [replace(d, T_world_ee=rolled(d.T_world_ee), T_world_objects=rolled(d.T_world_objects)) for d in food]
    for demo, was in zip(hinted(lying, Hints(up="y")), food, strict=True):
        np.testing.assert_allclose(demo.T_world_objects.p[..., 2], was.T_world_objects.p[..., 2], atol=1e-9)


def rolled(T):
    """From a world with z up into one with y up."""
    roll = Pose.from_rotvec([0, 0, 0], [-np.pi / 2, 0, 0])
    return Pose(roll.rotate(T.p), quat_multiply(roll.q, T.q))


def test_a_library_knows_its_hints(door, tmp_path):
    config = LearnConfig(skills=SkillConfig(max_fields=1), hints=Hints(references={"door": "cabinet"}))
    learn(door, config).save(tmp_path / "library")
    assert Library.load(tmp_path / "library").hints == {"references": {"door": "cabinet"}}
    older = LearnConfig(hints=Hints(up="y")).with_older_hints({"up": "x", "joints": {"door": "free"}})
    assert older.hints.document() == {"up": "y", "joints": {"door": "free"}}
