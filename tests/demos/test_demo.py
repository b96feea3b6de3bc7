import dataclasses
from typing import Any

import numpy as np
import pytest

from symskill_pddl.demos import Demo, extent_conflicts, merged_extents
from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose
from symskill_pddl.scene import Scene


def test_scene_and_pose_speak_of_the_same_moment(demo):
    d = demo()
    scene = d.scene(3)
    assert scene.time == d.times[3]
    assert scene.gripper_closed is True
    assert scene.objects == {"cheese": "food", "counter": "counter"}
    for frame in ("gripper", "cheese", "counter"):
        np.testing.assert_array_equal(scene.pose(frame).vector(), d.pose(frame)[3].vector())
    np.testing.assert_array_equal(d.scene(-1).pose("cheese").p, d.scene(4).pose("cheese").p)


def test_duration_and_length(demo):
    assert demo().duration_s == pytest.approx(0.2)
    assert len(demo()) == 5


def test_the_demo_keeps_copies_and_they_are_read_only(demo):
    times = np.arange(5) * 0.05
    d = demo(times=times)
    times[0] = -9
    assert d.times[0] == 0
    for array in (d.times, d.aperture, d.gripper_closed, d.T_world_ee.p):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_an_unknown_object_is_named_with_what_exists(demo):
    with pytest.raises(InputError, match=r"kitchen:demo_0: unknown object 'bread'; the demonstration has: cheese, counter"):
        demo().pose("bread")


def test_no_objects_are_fine(demo):
    assert demo(objects={}, T_world_objects=Pose(np.zeros((5, 0, 3)), np.ones((5, 0, 4))), extents={}).scene(0).objects == {}


def bad(array: Any, value: float) -> Any:
    array = np.array(array, dtype=float)
    array[1] = value
    return array


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"times": np.array([0.0])}, "at least 2 samples"),
        ({"times": np.zeros((5, 1))}, "at least 2 samples"),
        ({"times": np.arange(4) * 0.05}, r"has shape \(5,\), 4 times"),
        ({"times": np.array([0, 1, 1, 2, 3])}, r"times\[2\] = 1 s follows 1 s"),
        ({"times": np.array([0, 2, 1, 3, 4])}, "times have to increase"),
        ({"times": bad(np.arange(5), np.nan)}, r"times\[1\] is not a finite"),
        ({"aperture": bad(np.ones(5), np.inf)}, r"aperture\[1\] is not a finite"),
        ({"aperture": bad(np.ones(5), -0.1)}, "aperture is negative"),
        ({"aperture": np.ones(4)}, r"aperture has shape \(4,\)"),
        ({"gripper_closed": np.zeros(4, dtype=bool)}, r"gripper_closed has shape \(4,\)"),
        ({"gripper_closed": np.zeros(5)}, "has to be boolean, got float64"),
        ({"T_world_ee": Pose(np.zeros((4, 3)), np.ones((4, 4)))}, r"T_world_ee has shape \(4,\)"),
        ({"T_world_objects": Pose(np.zeros((5, 1, 3)), np.ones((5, 1, 4)))}, r"2 objects need \(5, 2\)"),
        ({"objects": {"gripper": "food", "counter": "counter"}}, "'gripper' is the end effector's name"),
        ({"objects": {"a/b": "food", "counter": "counter"}}, "object name 'a/b'"),
        ({"objects": {"cheese": "", "counter": "counter"}}, "type ''"),
        ({"objects": {"..": "food", "counter": "counter"}}, r"object name '\.\.'"),
        ({"name": "demo 0"}, "name 'demo 0'"),
        ({"extents": {"fod": (1, 1, 1)}}, "unknown type 'fod'; types here: counter, food"),
        ({"extents": {"food": (1, 0, 1)}}, "three positive half sizes"),
        ({"attributes": {"seeds": [1, 2]}}, "attribute 'seeds' has to be a text or a number, got list"),
    ],
)
def test_what_does_not_fit_is_refused(demo, changes, message):
    with pytest.raises(InputError, match=message) as caught:
        demo(**changes)
    assert "\n" not in str(caught.value)


def test_merged_extents_take_the_largest(demo):
    merged = merged_extents((demo(), demo(extents={"food": (0.01, 0.05, 0.02), "counter": (1, 1, 1)})))
    assert merged == {"counter": (1.0, 1.0, 1.0), "food": (0.03, 0.05, 0.02)}


class TestFromScenes:
    def test_scenes_come_back(self) -> None:
        scenes = [a_scene(t) for t in (0.0, 0.05, 0.1)]
        demo = Demo.from_scenes(scenes, name="demo_0", task="Move", extents={"cube": (0.1, 0.1, 0.1)}, attributes={"seed": 3})
        assert len(demo) == 3
        assert (demo.name, demo.task, demo.source, demo.attributes) == ("demo_0", "Move", "recording", {"seed": 3})
        for i, scene in enumerate(scenes):
            again = demo.scene(i)
            assert (again.time, again.aperture, again.gripper_closed) == (scene.time, scene.aperture, scene.gripper_closed)
            assert again.objects == scene.objects
            np.testing.assert_array_equal(again.T_world_ee.vector(), scene.T_world_ee.vector())
            np.testing.assert_array_equal(again.T_world_objects.vector(), scene.T_world_objects.vector())

    def test_one_scene_is_none(self) -> None:
        with pytest.raises(InputError, match="at least 2 scenes, got 1"):
            Demo.from_scenes([a_scene(0.0)], name="demo_0", task="Move")

    def test_objects_may_come_and_go(self) -> None:
        demo = Demo.from_scenes([a_scene(0.0), a_scene(0.1, name="cup"), a_scene(0.2)], name="demo_0", task="Move")
        assert demo.objects == {"box": "cube", "cup": "cube"}
        np.testing.assert_array_equal(demo.seen, [[True, False], [False, True], [True, False]])
        np.testing.assert_allclose(demo.pose("box").p[:, 1], [0.0, 0.0, 0.2])
        np.testing.assert_allclose(demo.pose("cup").p[:, 1], 0.1)
        assert demo.scene(1).unseen == {"box"}

    def test_an_object_that_is_out_of_sight_all_the_time_is_left_out(self) -> None:
        scenes = [dataclasses.replace(a_scene(t), unseen=frozenset({"box"})) for t in (0.0, 0.1)]
        assert Demo.from_scenes(scenes, name="demo_0", task="Move").objects == {}

    def test_a_type_stays(self) -> None:
        with pytest.raises(InputError, match="'box' is of type 'cup' in scene 1, of type 'cube' before"):
            Demo.from_scenes([a_scene(0.0), a_scene(0.1, type_="cup")], name="demo_0", task="Move")


class TestSeen:
    def test_everything_is_seen_unless_told(self, demo) -> None:
        assert demo().seen.shape == (5, 2)
        assert demo().seen.all()
        assert demo().sees("gripper").all()

    def test_an_unseen_pose_is_the_last_one_and_before_the_first_sight_the_first(self, demo) -> None:
        seen = np.array([[0, 1], [1, 1], [0, 0], [1, 1], [0, 1]], bool)
        d = demo(seen=seen)
        T = demo().T_world_objects
        np.testing.assert_array_equal(d.pose("cheese").p, T.p[[1, 1, 1, 3, 3], 0])
        np.testing.assert_array_equal(d.pose("counter").q, T.q[[0, 1, 1, 3, 4], 1])
        np.testing.assert_array_equal(d.sees("cheese"), seen[:, 0])
        assert d.scene(2).unseen == {"cheese", "counter"}
        assert d.scene(3).unseen == frozenset()

    def test_holding_again_changes_nothing(self, demo) -> None:
        d = demo(seen=np.array([[0, 1], [1, 1], [0, 0], [1, 1], [0, 1]], bool))
        again = dataclasses.replace(d)
        np.testing.assert_array_equal(again.T_world_objects.vector(), d.T_world_objects.vector())

    def test_refused(self, demo) -> None:
        with pytest.raises(InputError, match="'counter' is never seen"):
            demo(seen=np.tile([True, False], (5, 1)))
        with pytest.raises(InputError, match=r"seen has to be boolean \(5, 2\), got bool \(5,\)"):
            demo(seen=np.ones(5, bool))
        with pytest.raises(InputError, match="seen has to be boolean"):
            demo(seen=np.ones((5, 2)))


def a_scene(time: float, name: str = "box", type_: str = "cube") -> Scene:
    hand, thing = Pose.from_rotvec([time, 0, 0], [0, time, 0]), Pose.from_rotvec([0, time, 0], [0, 0, time])
    return Scene(time, hand, 0.08 - time / 10, time > 0, {name: type_}, Pose.stack([thing]))


def test_a_type_of_two_sizes_names_its_files(demo):
    one, other = demo(), demo(source="play", extents={"food": (0.05, 0.02, 0.02), "counter": (0.5, 0.5, 0.02)})
    assert extent_conflicts([one, demo()]) == ()
    (line,) = extent_conflicts([one, other])
    assert "type 'food' has more than one size: 6.0 x 4.0 x 4.0 cm in 'kitchen', 10.0 x 4.0 x 4.0 cm in 'play'" in line
