import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

from symskill_pddl.demos import decode_demos, encode_demos, load_demos, save_demos
from symskill_pddl.errors import FormatError, InputError
from symskill_pddl.geometry import Pose


@pytest.fixture
def saved(tmp_path, demo) -> Path:
    path = tmp_path / "kitchen.hdf5"
    save_demos(path, [demo(name="demo_10"), demo(name="demo_2", attributes={})])
    return path


def without_checksum(path: Path) -> h5py.File:
    """Open for tampering the way someone who edits a recording by hand would."""
    file = h5py.File(path, "r+")
    del file["data"].attrs["checksum"]
    return file


def test_round_trip_is_exact(tmp_path, demo):
    rng = np.random.default_rng(0)
    original = demo(
        T_world_ee=Pose(rng.normal(size=(5, 3)), rng.normal(size=(5, 4))),
        T_world_objects=Pose(rng.normal(size=(5, 2, 3)), rng.normal(size=(5, 2, 4))),
    )
    save_demos(tmp_path / "kitchen.hdf5", [original])
    (loaded,) = load_demos(tmp_path / "kitchen.hdf5")
    for field in ("name", "source", "task", "objects", "extents", "attributes"):
        assert getattr(loaded, field) == getattr(original, field)
    assert [type(v) for _, v in sorted(loaded.attributes.items())] == [str, float, int]
    assert list(loaded.objects) == list(original.objects)
    for field in ("times", "aperture", "gripper_closed"):
        np.testing.assert_array_equal(getattr(loaded, field), getattr(original, field))
    np.testing.assert_array_equal(loaded.T_world_ee.vector(), original.T_world_ee.vector())
    np.testing.assert_array_equal(loaded.T_world_objects.vector(), original.T_world_objects.vector())


def test_missing_poses_are_nan_in_the_file(tmp_path, demo):
    seen = np.array([[0, 1], [1, 1], [0, 0], [1, 1], [0, 1]], bool)
    original = demo(seen=seen)
    save_demos(tmp_path / "a.hdf5", [original])
    with h5py.File(tmp_path / "a.hdf5") as file:
        np.testing.assert_array_equal(np.isnan(file["data/demo_0/objects/cheese"][:, 0]), ~seen[:, 0])
    (loaded,) = load_demos(tmp_path / "a.hdf5")
    np.testing.assert_array_equal(loaded.seen, seen)
    np.testing.assert_array_equal(loaded.T_world_objects.vector(), original.T_world_objects.vector())
    assert encode_demos([loaded], "a") == encode_demos([original], "a")


def test_gaps_of_a_recording_by_others(saved):
    with without_checksum(saved) as file:
        group = file["data/demo_2"]
        group["objects/cheese"][2, 5] = np.nan  # part of a pose is no pose
        group["objects/counter"][:] = np.nan
        group["aperture"][1] = np.nan
    demo = load_demos(saved)[0]
    assert demo.objects == {"cheese": "food"}
    np.testing.assert_array_equal(demo.sees("cheese"), [True, False, True, True])
    np.testing.assert_allclose(demo.times, [0.0, 0.1, 0.15, 0.2])


def test_files_of_version_1_are_read(saved):
    with h5py.File(saved, "r+") as file:
        file["data"].attrs["schema_version"] = 1
    assert len(load_demos(saved)) == 2


def test_object_order_is_kept_and_not_the_alphabet(tmp_path, demo):
    save_demos(tmp_path / "a.hdf5", [demo(objects={"z": "food", "a": "counter"})])
    (loaded,) = load_demos(tmp_path / "a.hdf5")
    assert list(loaded.objects) == ["z", "a"]
    np.testing.assert_array_equal(loaded.pose("z").p, demo().pose("cheese").p)


def test_demos_come_in_natural_order_under_the_files_name(saved):
    assert [(d.source, d.name) for d in load_demos(saved)] == [("kitchen", "demo_2"), ("kitchen", "demo_10")]


def test_layout_is_what_robomimic_users_expect(saved):
    with h5py.File(saved) as file:
        group = file["data/demo_2"]
        assert set(group) == {"times", "ee_pose", "aperture", "gripper_closed", "objects"}
        assert group.attrs["num_samples"] == 5
        assert group["ee_pose"].shape == (5, 7)
        assert group["objects/cheese"].attrs["type"] == "food"
        assert file["data"].attrs["quaternion_order"] == "wxyz"
        assert file["data"].attrs["total"] == 10


def test_two_processes_write_the_same_bytes(tmp_path, saved):
    code = "import sys; from symskill_pddl.demos import *; save_demos(sys.argv[2], reversed(load_demos(sys.argv[1])))"
    time.sleep(1.1)  # time stamps, where there are any, have a resolution of a second
    for seed in ("1", "2"):
        copy = tmp_path / f"copy{seed}.hdf5"
        subprocess.run(
            [sys.executable, "-c", code, saved, copy], check=True, env={"PYTHONHASHSEED": seed, "PYTHONPATH": ":".join(sys.path)}
        )
        assert copy.read_bytes() == saved.read_bytes()


# -- saving ---------------------------------------------------------------------------------------------------------------


def test_saving_nothing_or_twice_the_same_name_is_refused(tmp_path, demo):
    with pytest.raises(InputError, match="no demonstrations to save"):
        save_demos(tmp_path / "a.hdf5", [])
    with pytest.raises(InputError, match="two demonstrations are named 'demo_0'"):
        save_demos(tmp_path / "a.hdf5", [demo(), demo()])
    assert list(tmp_path.iterdir()) == []


def test_an_attribute_may_not_take_the_formats_names(tmp_path, demo):
    with pytest.raises(InputError, match="attribute name 'task' belongs to the file format"):
        save_demos(tmp_path / "a.hdf5", [demo(attributes={"task": "x"})])
    with pytest.raises(InputError, match="NUL"):
        save_demos(tmp_path / "a.hdf5", [demo(attributes={"note": "a\0b"})])


def test_a_failed_save_leaves_the_old_file(saved, demo, monkeypatch):
    before = saved.read_bytes()

    def full_disk(_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full_disk)
    with pytest.raises(InputError, match=r"cannot write '.*kitchen.hdf5': No space left on device"):
        save_demos(saved, [demo()])
    assert saved.read_bytes() == before
    assert [p.name for p in saved.parent.iterdir()] == ["kitchen.hdf5"]


def test_saving_into_a_missing_folder_says_so(tmp_path, demo):
    with pytest.raises(InputError, match=r"cannot write '.*missing.*': there is no folder"):
        save_demos(tmp_path / "missing" / "a.hdf5", [demo()])
    with pytest.raises(InputError, match="is a folder"):
        save_demos(tmp_path, [demo()])


# -- faults on the way in -------------------------------------------------------------------------------------------------


def refused(path: Path, message: str, kind: type[InputError] = FormatError) -> None:
    with pytest.raises(kind, match=message) as caught:
        load_demos(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_missing_files_and_folders(tmp_path):
    refused(tmp_path / "none.hdf5", "does not exist", InputError)
    refused(tmp_path, "is a folder", InputError)


def test_truncation_anywhere_is_refused(saved):
    whole = saved.read_bytes()
    for size in (0, 1, 7, 48, 100, *range(200, len(whole), len(whole) // 40), len(whole) - 1):
        saved.write_bytes(whole[:size])
        refused(saved, "damaged or truncated|no such|has to be|cannot be read")


def test_no_flipped_byte_changes_what_is_read(saved):
    whole = saved.read_bytes()
    good = load_demos(saved)
    rng = np.random.default_rng(1)
    refusals = 0
    for at in rng.choice(len(whole), size=300, replace=False):
        broken = bytearray(whole)
        broken[at] ^= int(rng.integers(1, 256))
        saved.write_bytes(broken)
        try:
            demos = load_demos(saved)
        except InputError:
            refusals += 1
        else:  # unused space in the file
            for a, b in zip(demos, good, strict=True):
                assert (a.name, a.task, a.objects, a.extents, a.attributes) == (
                    b.name,
                    b.task,
                    b.objects,
                    b.extents,
                    b.attributes,
                )
                np.testing.assert_array_equal(a.T_world_objects.vector(), b.T_world_objects.vector())
                np.testing.assert_array_equal(a.T_world_ee.vector(), b.T_world_ee.vector())
                np.testing.assert_array_equal(a.times, b.times)
    assert refusals > 50


def test_other_files_are_refused(tmp_path):
    path = tmp_path / "notes.hdf5"
    path.write_text("not HDF5")
    refused(path, "is no HDF5 file but a text file")
    with h5py.File(path, "w") as file:
        file["x"] = 1
    refused(path, "data: there is no such group; the file has: x")


def test_a_robosuite_recording_is_sent_to_the_importer(tmp_path):
    path = tmp_path / "lift.hdf5"
    with h5py.File(path, "w") as file:
        file.create_group("data").attrs["env"] = "Lift"
    refused(path, "convert it with 'symskill import'")


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("format", "other", "'format' has to be 'symskill-demos', found 'other'"),
        ("schema_version", 3, "schema_version 3 cannot be read, this release reads versions 1 to 2"),
        ("quaternion_order", "xyzw", "'quaternion_order' has to be 'wxyz', found 'xyzw'"),
        ("units", "mm", "'units' has to be"),
    ],
)
def test_header_attributes(saved, key, value, message):
    with h5py.File(saved, "r+") as file:
        file["data"].attrs[key] = value
    refused(saved, message)


def test_an_edit_is_noticed_by_the_checksum(saved):
    with h5py.File(saved, "r+") as file:
        file["data/demo_2/aperture"][1] = 0.03
    refused(saved, "checksum does not match")
    without_checksum(saved).close()  # an own recorder need not write one
    assert load_demos(saved)[0].aperture[1] == 0.03


def test_an_empty_file_of_the_format(saved):
    with h5py.File(saved, "r+") as file:
        del file["data/demo_2"], file["data/demo_10"]
    refused(saved, "holds no demonstration")


@pytest.mark.parametrize("name", ["times", "ee_pose", "aperture", "gripper_closed", "objects"])
def test_missing_parts(saved, name):
    with without_checksum(saved) as file:
        del file["data/demo_2"][name]
    refused(saved, f"data/demo_2/{name}: there is no such")


@pytest.mark.parametrize(
    ("name", "values", "message"),
    [
        ("times", np.arange(10.0).reshape(5, 2), r"data/demo_2/times: has shape \(5, 2\), expected \(n,\)"),
        ("times", np.array([0, 1, 1, 2, 3.0]), r"data/demo_2: times have to increase"),
        ("times", np.zeros(0), "shape"),
        ("ee_pose", np.zeros((5, 6)), r"data/demo_2/ee_pose: has shape \(5, 6\), expected \(5, 7\)"),
        ("ee_pose", np.zeros((5, 7)), r"data/demo_2/ee_pose: row 0: columns 3 to 6 have to be a unit quaternion"),
        ("aperture", np.zeros(4), r"data/demo_2/aperture: has shape \(4,\), expected \(5,\)"),
        ("aperture", np.full(5, np.nan), r"data/demo_2: the hand's pose or its aperture is missing \(NaN\) in 5 of 5 samples"),
        ("aperture", np.full(5, np.inf), "data/demo_2/aperture: holds a number that is not finite, at index 0"),
        ("times", np.full(5, np.nan), "data/demo_2/times: holds a number that is not finite, at index 0"),
        ("aperture", np.full(5, -1.0), "data/demo_2: an aperture is negative"),
        ("aperture", np.array([b"a"] * 5), "data/demo_2/aperture: has to hold numbers"),
        ("gripper_closed", np.array([0, 1, 2, 0, 0]), "data/demo_2/gripper_closed: has to hold 0"),
        ("objects/cheese", np.full((5, 7), np.inf), "data/demo_2/objects/cheese: holds a number that is not finite"),
    ],
)
def test_wrong_values(saved, name, values, message):
    with without_checksum(saved) as file:
        attributes = dict(file["data/demo_2"][name].attrs)
        del file["data/demo_2"][name]
        file["data/demo_2"][name] = values
        file["data/demo_2"][name].attrs.update(attributes)
    refused(saved, message)


@pytest.mark.parametrize(
    ("where", "key", "value", "message"),
    [
        ("", "object_order", '["cheese"]', "object_order names cheese, the group holds cheese, counter"),
        ("", "object_order", "[cheese", "has to be JSON: a list of names"),
        ("", "extents", '{"food": [1]}', "has to be JSON: half sizes"),
        ("", "extents", '{"fod": [1, 1, 1]}', "unknown type 'fod'"),
        ("", "task", 3, "attribute 'task' has to be a text, found 3"),
        ("", "odd", np.arange(3), "attribute 'odd' has to be a text or a number"),
        ("/objects/cheese", "type", 3, "objects/cheese: attribute 'type' has to be a text"),
    ],
)
def test_wrong_attributes(saved, where, key, value, message):
    with without_checksum(saved) as file:
        file[f"data/demo_2{where}"].attrs[key] = value
    refused(saved, message)


def test_importing_the_room_is_cheap():
    code = "import sys, symskill_pddl.demos; sys.exit(bool({'h5py', 'mujoco'} & sys.modules.keys()))"
    assert subprocess.run([sys.executable, "-c", code], check=False, env={"PYTHONPATH": ":".join(sys.path)}).returncode == 0


def test_demonstrations_in_memory_are_the_file(saved):
    content = saved.read_bytes()
    demos = load_demos(saved)
    assert encode_demos(reversed(demos)) == content
    again = decode_demos(content, "some")
    assert [d.where for d in again] == [d.where.replace(saved.stem, "some") for d in demos]
    assert encode_demos(again) == content
    with pytest.raises(FormatError, match=r"'some\.hdf5' is not a readable HDF5 file"):
        decode_demos(content[:100], "some")
    with pytest.raises(InputError, match="no demonstrations to save in 'memory'"):
        encode_demos([])
