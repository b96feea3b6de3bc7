"""Isaac Lab's layout, written by hand: no recording of it that may be kept here was at hand."""

import json
from pathlib import Path

import h5py
import numpy as np
import pytest

from symskill_pddl.demos.importing import ImportConfig
from symskill_pddl.demos.isaac_lab import import_isaac_lab, is_isaac_lab
from symskill_pddl.errors import FormatError, InputError

N = 40


def quiet(_: str) -> None: ...


def write(path: Path, *, hand: bool = True, sim: bool = True) -> Path:
    """Two episodes: the gripper is told 1 (open), then -1 (close), and closes; a cube rises."""
    closes = np.arange(N) >= 20
    poses = np.tile([0.5, 0.0, 0.02, 1.0, 0.0, 0.0, 0.0], (N, 1))
    poses[:, 2] += 0.1 * closes
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        env = {"env_name": "Isaac-Stack-Cube-Franka-IK-Rel-v0", "type": 2}
        data.attrs["env_args"] = json.dumps(env | ({"sim_args": {"dt": 0.01, "decimation": 5}} if sim else {}))
        for name in ("demo_0", "demo_1"):
            group = data.create_group(name)
            group["actions"] = np.column_stack([np.zeros((N, 6)), np.where(closes, -1.0, 1.0)]).astype(np.float32)
            group["states/rigid_object/cube_1/root_pose"] = poses.astype(np.float32)
            group["states/articulation/robot/root_pose"] = poses
            group["states/articulation/robot/joint_position"] = np.zeros((N, 9))
            if hand:
                group["obs/eef_pos"] = poses[:, :3]
                group["obs/eef_quat"] = np.tile([0.0, 1.0, 0.0, 0.0], (N, 1))
                group["obs/gripper_pos"] = np.where(closes[:, None], [0.02, -0.02], [0.04, -0.04])
    return path


def test_poses_are_read_as_they_stand(tmp_path):
    path = write(tmp_path / "dataset.hdf5")
    assert is_isaac_lab(path)
    demos = import_isaac_lab(path, remark=pytest.fail)
    assert [d.where for d in demos] == ["dataset:demo_0", "dataset:demo_1"]
    (demo, _) = demos
    assert demo.task == "Isaac-Stack-Cube-Franka-IK-Rel-v0"
    assert demo.objects == {"cube_1": "cube"}
    np.testing.assert_allclose(np.diff(demo.times), 0.05)
    np.testing.assert_array_equal(demo.gripper_closed, np.arange(N) >= 20)
    np.testing.assert_allclose(demo.aperture[[0, -1]], [0.08, 0.04])
    np.testing.assert_allclose(demo.pose("cube_1").p[-1], [0.5, 0.0, 0.12], atol=1e-6)


def test_the_rate_is_asked_for_where_the_file_does_not_say_it(tmp_path):
    path = write(tmp_path / "dataset.hdf5", sim=False)
    with pytest.raises(InputError, match=r"does not say its rate .*: give it with --rate HZ"):
        import_isaac_lab(path, remark=quiet)
    demo = import_isaac_lab(path, ImportConfig(rate_hz=10.0, count=1), remark=quiet)[0]
    np.testing.assert_allclose(np.diff(demo.times), 0.1)


def test_without_the_hand_it_says_what_to_record(tmp_path):
    path = write(tmp_path / "dataset.hdf5", hand=False)
    with pytest.raises(
        FormatError, match=r"data/demo_0: this is a recording of Isaac Lab without the hand's pose .*docs/recordings.md"
    ):
        import_isaac_lab(path, remark=quiet)


def test_a_bad_episode_is_left_out(tmp_path):
    path = write(tmp_path / "dataset.hdf5")
    with h5py.File(path, "r+") as file:
        file["data/demo_1/obs/eef_pos"][3, 0] = np.nan
    said: list[str] = []
    assert [d.name for d in import_isaac_lab(path, remark=said.append)] == ["demo_0"]
    assert "'demo_1' is left out: 'obs/eef_pos' holds a number that is not finite, at row 3" in said[0]


def test_other_files_are_none_of_these(tmp_path):
    assert not is_isaac_lab(tmp_path)
    assert not is_isaac_lab(tmp_path / "none.hdf5")
    (tmp_path / "x.hdf5").write_bytes(b"x")
    assert not is_isaac_lab(tmp_path / "x.hdf5")
