from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fake_world import CABINET, FakeWorld, at, atoms
from toy_arena import toy_library

from symskill_pddl.demos import Demo, save_demos
from symskill_pddl.errors import InputError
from symskill_pddl.evaluation.moment import Address, Moment, find_demo, problem_at, sample_at, state_at

LIBRARY = toy_library()
START = atoms("gripper-open", "food-on-counter cheese counter", "door-closed door cabinet")


@pytest.fixture(scope="module")
def demo() -> Demo:
    """The door is opened by somebody, and the cheese put into the cabinet, within two seconds at 10 Hz."""
    world, scenes = FakeWorld(), []
    for i in range(21):
        world.angle = 0.15 * min(i, 10)
        world.cheese = at(*(CABINET + np.array([0, 0, 0.05]))) if i > 15 else world.cheese
        scenes.append(replace(world.observe(), time=5.0 + 0.1 * i))
    return Demo.from_scenes(scenes, name="demo_0", task="PutIn", source="shown")


def moment(demo: Demo, at_s: float | None, goal: str | None = None, goal_at: int | None = None) -> Moment:
    return problem_at(LIBRARY, LIBRARY.domain("d"), demo, sample_at(demo, at_s), goal, goal_at)


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("a.hdf5:demo_3@2.5s", ("a.hdf5", "demo_3", 2.5)),
        ("a.hdf5:demo_3@2", ("a.hdf5", "demo_3", 2.0)),
        ("a.hdf5:demo_3@END", ("a.hdf5", "demo_3", None)),
        ("a.hdf5:demo_3", ("a.hdf5", "demo_3", 0.0)),
        ("a.hdf5@1s", ("a.hdf5", "", 1.0)),
        ("me@home/a.hdf5", ("me@home/a.hdf5", "", 0.0)),
        ("C:\\data\\a.hdf5:demo_0@.5s", ("C:\\data\\a.hdf5", "demo_0", 0.5)),
    ],
)
def test_addresses(text, parts):
    assert Address.parse(text) == Address(Path(parts[0]), *parts[1:])


@pytest.mark.parametrize("text", ["a.hdf5:demo_0@-1s", "a.hdf5:demo_0@soon", "a.hdf5@", "a.hdf5@1e3s", "a.hdf5@٣"])
def test_a_time_that_is_none(text):
    with pytest.raises(InputError, match=r"is no time in seconds, such as 2.5s, nor END; a moment is FILE:demo_0@2.5s"):
        Address.parse(text)


def test_a_name_has_to_be_one_of_the_files_and_near_ones_are_offered(tmp_path, demo):
    path = tmp_path / "shown.hdf5"
    save_demos(path, [demo, replace(demo, name="demo_1")])
    assert find_demo(Address(path, "demo_1", 0.0)).name == "demo_1"
    with pytest.raises(InputError, match=r"has no demonstration 'demo_7'; is 'demo_[01]' meant"):
        find_demo(Address(path, "demo_7", 0.0))
    with pytest.raises(InputError, match=r"has 2 demonstrations, name one, as .*shown.hdf5:demo_0@0s: demo_0, demo_1"):
        find_demo(Address(path, "", 0.0))
    with pytest.raises(InputError, match=r"'.*shwon.hdf5' does not exist; is '.*shown.hdf5' meant\?"):
        find_demo(Address(tmp_path / "shwon.hdf5", "demo_0", 0.0))
    with pytest.raises(InputError, match="does not exist; 'symskill record'"):
        find_demo(Address(tmp_path / "other", "demo_0", 0.0))


def test_times_count_from_the_beginning_of_the_recording(demo):
    assert [sample_at(demo, t) for t in (0.0, 0.12, 2.0, None)] == [0, 1, 20, 20]
    with pytest.raises(InputError, match=r"'shown:demo_0' lasts 2 s, there is no moment 2.5s"):
        sample_at(demo, 2.5)


def test_the_first_moment_with_the_learned_goal(demo):
    found = moment(demo, 0.0)
    assert found.problem.init == START
    assert found.problem.goal == atoms("food-in-cabinet cheese cabinet")
    assert dict(found.problem.objects) == demo.objects
    assert found.problem.name == "shown-demo-0-0"
    assert (found.assumed, found.notes) == ((), ())


def test_what_the_end_shows_is_a_goal(demo):
    found = moment(demo, 0.0, goal_at=20)
    assert found.problem.goal == atoms("food-in-cabinet cheese cabinet", "door-open door cabinet")
    assert moment(demo, None, goal_at=20).notes == ("the goal holds already",)


def test_between_two_places_the_nearest_is_assumed(demo):
    (assumed,) = moment(demo, 0.7, goal="(food-in-cabinet cheese cabinet)").assumed
    assert assumed.atom in atoms("door-open door cabinet", "door-closed door cabinet")


def test_what_was_last_seen_still_holds(demo):
    """The door is out of sight from before it is open."""
    blind = replace(demo, seen=np.arange(21)[:, None] < np.array([99, 99, 99, 1]))
    assert list(demo.objects)[3] == "door"
    assert atoms("door-closed door cabinet") <= state_at(LIBRARY, blind, 20)
    assert "not seen at that moment, taken to be where last seen: door" in moment(blind, None).notes


def test_objects_that_the_library_does_not_know_are_left_out(demo):
    other = replace(demo, objects={name: "thing" if name == "door" else kind for name, kind in demo.objects.items()})
    found = moment(other, 0.0)
    assert "door" not in dict(found.problem.objects)
    assert found.notes == ("left out, as the library knows no such type: door (thing)",)
    with pytest.raises(InputError, match="knows no type of its objects"):
        moment(replace(demo, objects=dict.fromkeys(demo.objects, "thing")), 0.0)


def test_a_moment_without_relations_is_no_goal(demo):
    lost = replace(
        demo, T_world_objects=type(demo.T_world_ee)(demo.T_world_objects.p + np.arange(4)[:, None], demo.T_world_objects.q)
    )
    with pytest.raises(InputError, match="shows no relation that the library knows at 2s; state the goal with --goal"):
        moment(lost, 0.0, goal_at=20)
