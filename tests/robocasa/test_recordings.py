"""Recordings that robosuite's, RoboCasa's and LeRobot's own writers made (tests/data/robocasa), as demonstrations."""

import gzip
import json
import shutil
from importlib.util import find_spec
from pathlib import Path

import h5py
import numpy as np
import pytest

from symskill_pddl.demos import load_demos, save_demos
from symskill_pddl.errors import FormatError, InputError
from symskill_pddl.geometry import Pose, rotation_distance
from symskill_pddl.robocasa.recordings import import_robocasa, is_robocasa
from symskill_pddl.robocasa.view import View

DATA = Path(__file__).parents[1] / "data" / "robocasa"


def has_robocasa() -> bool:
    spec = find_spec("robocasa")
    return spec is not None and spec.origin is not None


@pytest.fixture
def hdf5(tmp_path: Path) -> Path:
    file = tmp_path / "open_door.hdf5"
    file.write_bytes(gzip.decompress((DATA / "demo.hdf5.gz").read_bytes()))
    return file


def posed(rows: np.ndarray) -> Pose:
    """Poses from rows of position and rotation matrix."""
    T = np.zeros((len(rows), 4, 4))
    T[:, :3, 3], T[:, :3, :3], T[:, 3, 3] = rows[:, :3], rows[:, 3:].reshape(-1, 3, 3), 1.0
    return Pose.from_matrix(T)


def test_a_recording_is_seen_as_a_run_would_be(hdf5: Path) -> None:
    truth = np.load(DATA / "truth.npz")
    demos = import_robocasa(hdf5)
    assert [(d.name, d.task, d.source) for d in demos] == [
        ("demo_1", "OpenSingleDoor", "open_door"),
        ("demo_2", "OpenSingleDoor", "open_door"),
    ]
    for i, demo in enumerate(demos):
        assert demo.objects == {"door": "door", "cabinet": "cabinet"}
        assert demo.attributes["lang"] == "Open the cabinet door."
        base = posed(truth[f"base_{i}"])[0]
        yaw = 2 * np.arctan2(base.q[3], base.q[0])
        # cab_1 of the first layout is hinged on the left, and so seen in the mirror
        view = View(
            Pose(base.p, np.array([np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)])), mirrored=bool(demo.T_world_objects.p[0, 0, 1] > 0)
        )
        view = next(v for v in (view, View(view.T_world_robot, not view.mirrored)) if agrees(v, demo, truth, i))
        handle = view.pose(posed(truth[f"handle_{i}"]))
        door = demo.T_world_objects[:, 0]
        # the handle's bar is carried by the door's frame, within 3 cm of its origin
        offset = (door.inverse() @ Pose(handle.p, door.q)).p
        np.testing.assert_allclose(offset, offset[:1].repeat(len(offset), axis=0), atol=1e-5)
        assert np.linalg.norm(offset[0]) < 0.03
        # the door goes from shut to half open about the upright, and the cabinet stays
        turned = 2 * np.arccos(np.clip(np.abs(np.sum(door.q * door.q[:1], axis=1)), 0, 1))
        np.testing.assert_allclose(turned, np.abs(truth[f"door_{i}"] - truth[f"door_{i}"][0]), atol=1e-4)
        assert turned[-1] > 0.6
        cabinet = demo.T_world_objects[:, 1]
        np.testing.assert_allclose(cabinet.p, cabinet.p[:1].repeat(len(cabinet.p), axis=0), atol=1e-9)
        # x points into the cabinet, which is ahead of the robot; z up
        np.testing.assert_allclose(cabinet[0].rotate(np.array([1.0, 0.0, 0.0])), [1, 0, 0], atol=0.02)
        np.testing.assert_allclose(cabinet[0].rotate(np.array([0.0, 0.0, 1.0])), [0, 0, 1], atol=1e-6)


def agrees(view: View, demo: object, truth: object, i: int) -> bool:
    seen = view.pose(posed(truth[f"ee_{i}"])).p  # type: ignore[index]
    return bool(np.allclose(seen, demo.T_world_ee.p, atol=1e-4))  # type: ignore[attr-defined]


def test_what_was_imported_can_be_kept(hdf5: Path, tmp_path: Path) -> None:
    demos = import_robocasa(hdf5)
    save_demos(tmp_path / "kept.hdf5", demos)
    for kept, demo in zip(load_demos(tmp_path / "kept.hdf5"), demos, strict=True):
        np.testing.assert_allclose(kept.T_world_objects.p, demo.T_world_objects.p)


@pytest.mark.skipif(find_spec("pyarrow") is None, reason="pyarrow is not in this environment: `make robocasa-test` runs this")
def test_the_lerobot_dataset_says_the_same(hdf5: Path) -> None:
    for ours, theirs in zip(import_robocasa(DATA / "lerobot"), import_robocasa(hdf5), strict=True):
        np.testing.assert_array_equal(ours.T_world_objects.p, theirs.T_world_objects.p)
        np.testing.assert_array_equal(ours.T_world_ee.q, theirs.T_world_ee.q)
        assert (ours.task, ours.objects) == (theirs.task, theirs.objects)


def test_recordings_of_robocasa_are_told_from_others(hdf5: Path, tmp_path: Path) -> None:
    assert is_robocasa(hdf5)
    assert is_robocasa(DATA / "lerobot")
    assert not is_robocasa(tmp_path)
    assert not is_robocasa(DATA.parent / "robosuite" / "panda_lift.hdf5")


def set_attribute(file: Path, key: str, value: str) -> None:
    with h5py.File(file, "a") as f:
        for demo in f["data"].values():
            demo.attrs[key] = value


def rename(file: Path, old: str, new: str) -> None:
    with h5py.File(file, "a") as f:
        for demo in f["data"].values():
            demo.attrs["model_file"] = demo.attrs["model_file"].replace(old, new)


@pytest.mark.parametrize(
    ("key", "value", "error", "message"),
    [
        ("ep_meta", "{}", FormatError, "names no fixture with a door .'fixture_refs': none"),
        ("ep_meta", '{"fixture_refs": {"fxtr": "cab_main_main_group"}}', FormatError, "has 2 doors"),
        ("ep_meta", "3", FormatError, "has to be a JSON object"),
        ("env_args", '{"env_name": "TurnOnStove"}', FormatError, "names no knob"),
        ("env_args", '{"env_name": "OpenDrawer"}', FormatError, "names no fixture with a drawer"),
    ],
)
def test_what_does_not_fit_is_named(hdf5: Path, key: str, value: str, error: type[Exception], message: str) -> None:
    set_attribute(hdf5, key, value)
    with pytest.raises(error, match=message):
        import_robocasa(hdf5)


def test_an_environment_of_somebody_elses_shows_what_it_describes(hdf5: Path) -> None:
    set_attribute(hdf5, "env_args", '{"env_name": "MakeSoup"}')
    demo = import_robocasa(hdf5)[0]
    assert demo.task == "MakeSoup"
    assert demo.objects["cab_1_main_group_hingedoor"] == "door"
    assert "cabinet" in demo.objects["cab_1_main_group"]
    door = demo.pose("cab_1_main_group_hingedoor")
    assert np.degrees(rotation_distance(door[0], door[-1])) > 30
    set_attribute(hdf5, "ep_meta", "{}")
    with pytest.raises(FormatError, match="it is of 'MakeSoup', and its description names neither things"):
        import_robocasa(hdf5)


@pytest.mark.parametrize(("env", "part"), [("TurnOnStove", "knob"), ("TurnOffSinkFaucet", "lever"), ("OpenDrawer", "drawer")])
def test_other_parts_are_found_in_the_same_kitchen(hdf5: Path, env: str, part: str) -> None:
    set_attribute(hdf5, "env_args", f'{{"env_name": "{env}"}}')
    set_attribute(hdf5, "ep_meta", '{"task_refs": {"knob": "rear_left"}, "fixture_refs": {"drawer": "stack_1_main_group_4"}}')
    demo = import_robocasa(hdf5)[0]
    assert demo.task == env
    assert next(iter(demo.objects)) == part
    np.testing.assert_allclose(demo.T_world_objects.p[:, 0], demo.T_world_objects.p[:1, 0].repeat(20, axis=0), atol=1e-3)


def test_a_handle_whose_bar_has_another_name_is_found(hdf5: Path) -> None:
    named = import_robocasa(hdf5)[0]
    rename(hdf5, '_door_handle_handle"', '_door_handle_g3"')
    other = import_robocasa(hdf5)[0]
    # with its posts, which reach to the panel, the middle is a little nearer to that
    assert 0.0 < np.linalg.norm(other.T_world_objects.p[0, 0] - named.T_world_objects.p[0, 0]) < 0.03


STORED = {
    "fixture_refs": {"cab": "cab_1_main_group", "counter": "counter_main_main_group"},
    "object_cfgs": [{"name": "obj", "info": {"cat": "tomato"}}],
}


def test_what_is_carried_and_where_it_can_go_are_found_by_their_names(hdf5: Path) -> None:
    # what lies in the cabinet of the recording is what such a task would be about
    rename(hdf5, '"door_obj_', '"obj_')
    set_attribute(hdf5, "env_args", '{"env_name": "PickPlaceCabinetToCounter"}')
    set_attribute(hdf5, "ep_meta", json.dumps(STORED))
    demo = import_robocasa(hdf5)[0]
    assert demo.task == "PnPCabToCounter"
    assert list(demo.objects) == ["food", "cabinet", "door", "counter"]
    base = posed(np.load(DATA / "truth.npz")["base_0"])[0]
    food, _, _, counter = (demo.T_world_objects.p[0, i] + [0, 0, base.p[2]] for i in range(4))
    # a counter's top is 92 cm high; the cabinet's shelf is above it, and food on that
    assert counter[2] == pytest.approx(0.92, abs=1e-6)
    assert 1.38 < food[2] < 1.5
    assert set(demo.extents) == {"food"}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"object_cfgs": []}, "names no thing 'obj' that the model has .'object_cfgs': none"),
        ({"fixture_refs": {"cab": "cab_1_main_group"}}, "names no counter .'fixture_refs': cab"),
        ({"fixture_refs": {"cab": "cab_1_main_group", "counter": "table"}}, "the model has no fixture 'table'"),
        ({"fixture_refs": {"cab": "cab_1_main_group", "counter": "sink_main_group"}}, "has no top to put something on"),
    ],
)
def test_what_a_task_of_carrying_lacks_is_named(hdf5: Path, change: dict[str, object], message: str) -> None:
    rename(hdf5, '"door_obj_', '"obj_')
    set_attribute(hdf5, "env_args", '{"env_name": "PickPlaceCounterToCabinet"}')
    set_attribute(hdf5, "ep_meta", json.dumps(STORED | change))
    with pytest.raises(FormatError, match=message):
        import_robocasa(hdf5)


def test_a_folder_that_is_no_dataset(tmp_path: Path) -> None:
    shutil.copytree(DATA / "lerobot", tmp_path / "d")
    shutil.rmtree(tmp_path / "d" / "meta")
    with pytest.raises(InputError, match="is a folder"):
        import_robocasa(tmp_path / "d")


@pytest.mark.skipif(not has_robocasa(), reason="RoboCasa is not in this environment: `make robocasa-test` runs this")
@pytest.mark.parametrize(
    "task",
    [
        "OpenSingleDoor",
        "OpenDrawer",
        "TurnOnStove",
        "TurnOffSinkFaucet",
        "PnPCabToCounter",
        "PnPCounterToCab",
        "PnPStoveToCounter",
    ],
)
def test_a_recording_of_a_run_says_what_the_run_said(task: str, tmp_path: Path) -> None:
    from symskill_pddl.robocasa.tasks import TASKS
    from symskill_pddl.robocasa.world import open_world

    world = open_world(TASKS[task], 3)
    model, data = world.arm.model, world.arm.data
    states, scenes = [], []
    for part in (None, 0.3, 0.7):
        for joint in (moving.joint for moving in world.moving.values() if part is not None):
            low, high = model.jnt_range[joint]
            data.qpos[model.jnt_qposadr[joint]] = part * (low if abs(low) > abs(high) else high)
        if part is not None and "obj" in world.env.objects:
            data.qpos[model.joint(world.env.objects["obj"].joints[0]).qposadr[0] + 2] += 0.1
        data.qpos[model.joint("robot0_joint1").qposadr] += 0.1
        world.arm.forward()
        states.append(world.env.sim.get_state().flatten())
        states[-1][0] = 0.05 * len(states)
        scenes.append(world.observe())
    with h5py.File(tmp_path / "run.hdf5", "w") as file:
        data_group = file.create_group("data")
        data_group.attrs["env_args"] = json.dumps({"env_name": type(world.env).__name__, "env_kwargs": {"control_freq": 20}})
        demo = data_group.create_group("demo_1")
        demo.attrs["model_file"] = world.env.model.get_xml()
        demo.attrs["ep_meta"] = json.dumps(world.env.get_ep_meta())
        demo["states"], demo["actions"] = np.array(states), np.zeros((3, 12))
    (imported,) = import_robocasa(tmp_path / "run.hdf5")
    assert imported.task == task
    assert imported.objects == dict(scenes[0].objects)
    for i, scene in enumerate(scenes):
        np.testing.assert_allclose(imported.T_world_objects.p[i], scene.T_world_objects.p, atol=1e-6)
        np.testing.assert_allclose(np.abs(np.sum(imported.T_world_objects.q[i] * scene.T_world_objects.q, axis=1)), 1, atol=1e-9)
        np.testing.assert_allclose(imported.T_world_ee.p[i], scene.T_world_ee.p, atol=1e-6)
        assert abs(np.dot(imported.T_world_ee.q[i], scene.T_world_ee.q)) > 1 - 1e-9
        assert imported.aperture[i] == pytest.approx(scene.aperture, abs=1e-6)
