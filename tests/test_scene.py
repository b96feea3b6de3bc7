"""Scenes and commands validate themselves."""

from dataclasses import replace

import numpy as np
import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose
from symskill_pddl.scene import Command, Scene


def scene(objects: dict[str, str], n: int) -> Scene:
    poses = Pose(np.arange(3.0 * n).reshape(n, 3), np.tile([1.0, 0, 0, 0], (n, 1)))
    return Scene(0.0, Pose.identity(), 0.08, False, objects, poses)


def test_a_frame_is_found_by_its_name() -> None:
    s = scene({"cup": "cup", "plate": "plate"}, 2)
    assert np.allclose(s.pose("plate").p, [3, 4, 5])
    assert np.allclose(s.pose("gripper").p, 0)


def test_an_unknown_frame_lists_what_exists() -> None:
    with pytest.raises(InputError, match="unknown object 'pan'; the scene has: cup"):
        scene({"cup": "cup"}, 1).pose("pan")


def test_as_many_poses_as_objects() -> None:
    with pytest.raises(InputError, match="2 objects need 2 poses"):
        scene({"a": "x", "b": "x"}, 1)


def test_only_an_object_can_be_unseen() -> None:
    assert replace(scene({"cup": "cup"}, 1), unseen=frozenset({"cup"})).unseen == {"cup"}
    with pytest.raises(InputError, match="unseen names the unknown object 'pan'; the scene has: cup"):
        replace(scene({"cup": "cup"}, 1), unseen=frozenset({"pan"}))


def test_no_object_is_called_gripper() -> None:
    with pytest.raises(InputError, match="gripper"):
        scene({"gripper": "x"}, 1)


@pytest.mark.parametrize("twist", [np.zeros(3), np.full(6, np.nan)])
def test_a_command_is_a_finite_twist(twist: np.ndarray) -> None:
    with pytest.raises(InputError):
        Command(twist, False)


def test_hold_stays() -> None:
    command = Command.hold(True)
    assert np.all(command.twist == 0)
    assert command.close_gripper
