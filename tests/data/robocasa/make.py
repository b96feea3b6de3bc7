"""How the recordings beside this file were made: with robosuite's, RoboCasa's and LeRobot's own writers. Usage: make.py FOLDER

Needs the packages of requirements/robocasa.lock, ROBOCASA_ASSETS_PATH, and `lerobot==0.3.3` with datasets 3.6, pandas, jsonlines.
An environment of RoboCasa is moved by random actions for a second while its door is carried along; robosuite's
DataCollectionWrapper writes episodes, RoboCasa's scripts gather them into HDF5 and turn that into a LeRobot dataset (without
pictures, which need a graphics library). What the simulator itself said of a few frames is kept beside it, in truth.npz.

LeRobot asks for PyTorch, of which its writer uses the name of a base class and the stacking of its own columns; where it is not
installed, a stand-in for these is enough. RoboCasa's collector asks for drivers of keyboard and SpaceMouse.
"""

import gzip
import importlib.abc
import importlib.util
import json
import shutil
import sys
import tempfile
import types
from pathlib import Path

import h5py
import numpy as np


class Tensor(np.ndarray):
    """What LeRobot's writer looks back at its own file with."""

    def numpy(self):
        return np.asarray(self)


class StandIns(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Modules that only have to be there."""

    NAMES = ("torch", "torchvision", "hid", "pynput")

    def find_spec(self, name, path, target=None):
        return importlib.util.spec_from_loader(name, self, is_package=True) if name.split(".")[0] in self.NAMES else None

    def create_module(self, spec):
        module = types.ModuleType(spec.name)
        module.__getattr__ = self.nothing
        members = {"Tensor": Tensor} | dict.fromkeys(("tensor", "LongTensor"), lambda x: np.asarray(x).view(Tensor))
        members["stack"] = lambda xs: np.stack(list(xs)).view(Tensor)
        module.__dict__.update(members if spec.name == "torch" else {})
        return module

    @staticmethod
    def nothing(attribute):
        if attribute.startswith("__"):
            raise AttributeError(attribute)
        return type(attribute, (), {})  # a class of that name, which nothing is of

    def exec_module(self, module):
        pass


sys.meta_path.append(StandIns())
for name in ("torch.nn", "torch.utils.data"):
    importlib.import_module(name)
import robocasa  # noqa: E402
import robosuite  # noqa: E402
from robocasa.models.fixtures import FixtureType  # noqa: E402
from robocasa.scripts.collect_demos import gather_demonstrations_as_hdf5  # noqa: E402
from robocasa.utils import lerobot_utils as lr  # noqa: E402
from robocasa.utils.robomimic import robomimic_dataset_utils as dataset_utils  # noqa: E402
from robosuite.wrappers import DataCollectionWrapper  # noqa: E402

EPISODES, STEPS, FPS = 2, 20, 20


def collect(folder: Path) -> tuple[Path, list[dict]]:
    """Two episodes as HDF5, and what the simulator says of them."""
    config = {"env_name": "OpenCabinet", "robots": "PandaOmron", "layout_ids": [1], "style_ids": [1]}
    truths = []
    env = robosuite.make(
        **config, fixture_id=FixtureType.CABINET_SINGLE_DOOR, has_renderer=False, has_offscreen_renderer=False,
        use_camera_obs=False, ignore_done=True, control_freq=FPS, seed=0,
    )  # fmt: skip
    wrapped = DataCollectionWrapper(env, str(folder / "episodes"), use_env_xml_for_reset=True)
    rng = np.random.default_rng(0)
    for _ in range(EPISODES):
        wrapped.reset()
        truth = {"ee": [], "handle": [], "door": [], "base": [], "closed": [], "start": [], "obs": []}
        (joint,) = env.fxtr.door_joint_names
        low, high = env.sim.model.jnt_range[env.sim.model.joint_name2id(joint)]
        for k in range(STEPS):
            action = np.concatenate([rng.uniform(-0.3, 0.3, 6), [1.0 if k > STEPS // 2 else -1.0], np.zeros(4), [-1.0]])
            look(env, truth, action)
            env.sim.data.set_joint_qpos(joint, (low if low < 0 else high) * 0.5 * k / STEPS)
            wrapped.step(action)
        truths.append({key: np.array(value) for key, value in truth.items()})
    wrapped.close()
    hdf5 = gather_demonstrations_as_hdf5(str(folder / "episodes"), str(folder), json.dumps(config))
    with h5py.File(hdf5) as file:
        # gathered in whatever order the folder lists them
        starts = [file["data"][demo]["states"][0] for demo in file["data"]]
    truths = [min(truths, key=lambda truth: np.abs(truth["start"][0] - start).max()) for start in starts]
    dataset_utils.extract_action_dict = lambda **_: None  # actions in other forms, which need PyTorch
    dataset_utils.convert_to_robomimic_format(hdf5, filter_num_demos=None)
    return Path(hdf5), truths


def look(env, truth, action) -> None:
    env.sim.forward()
    data = env.sim.data._data
    grip = data.site("gripper0_right_grip_site")
    handle = data.geom(f"{env.fxtr.name}_door_handle_handle")
    base = data.body("robot0_link0")
    truth["ee"].append(np.concatenate([grip.xpos, grip.xmat]))
    truth["handle"].append(np.concatenate([handle.xpos, handle.xmat]))
    truth["base"].append(np.concatenate([base.xpos, base.xmat]))
    truth["door"].append(float(data.joint(env.fxtr.door_joint_names[0]).qpos[0]))
    truth["start"].append(env.sim.get_state().flatten())
    truth["closed"].append(action[6] > 0)
    observed = env._get_observations(force_update=True)
    truth["obs"].append({name: observed[name] for name in lr.LEROBOT_STATE_TO_HDF5_STATE.values()})


def to_lerobot(hdf5: Path, truths) -> Path:
    """RoboCasa's conversion, without the pictures."""
    root = hdf5.parent / "lerobot"
    features = {
        "annotation.human.task_description": {"dtype": "int64", "shape": (1,), "names": None},
        "annotation.human.task_name": {"dtype": "int64", "shape": (1,), "names": None},
        "observation.state": {"dtype": "float64", "shape": (16,), "names": None},
        "action": {"dtype": "float64", "shape": (12,), "names": None},
        "next.reward": {"dtype": "float32", "shape": (1,), "names": None},
        "next.done": {"dtype": "bool", "shape": (1,), "names": None},
    }
    dataset = lr.LerobotDatasetWrapper.create(
        repo_id="robocasa", root=root, robot_type="PandaOmron", fps=FPS, features=features, use_videos=False
    )
    (root / "extras").mkdir(parents=True, exist_ok=True)
    assets = Path(robocasa.__file__).parent / "models/assets/groot_dataset_assets/PandaOmron_modality.json"
    modality = json.loads(assets.read_text())
    with h5py.File(hdf5) as file:
        lr.save_dataset_meta(root, file)
        for index, demo in enumerate(file["data"]):
            lr.save_extra_demo_info(root, file["data"], demo, index)
            group = file["data"][demo]
            actions = lr.reorder_hdf5_action(group["actions"][:], modality)
            observed = {k: np.array([o[k] for o in truths[index]["obs"]]) for k in lr.LEROBOT_STATE_TO_HDF5_STATE.values()}
            states = lr.reorder_hdf5_state(observed, modality)
            for k in range(len(actions)):
                frame = {
                    "observation.state": states[k],
                    "action": actions[k],
                    "annotation.human.task_description": np.array([0], dtype=np.int64),
                    "annotation.human.task_name": np.array([1], dtype=np.int64),
                    "next.reward": np.zeros(1, dtype=np.float32),
                    "next.done": np.array([k + 1 == len(actions)]),
                }
                dataset.add_frame(frame, task=json.loads(group.attrs["ep_meta"])["lang"])
            dataset.save_episode()
    lr.add_groot_specific_metadata(str(hdf5.parent))
    return root


if __name__ == "__main__":
    out = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as scratch:
        made, seen = collect(Path(scratch))
        shutil.rmtree(out / "lerobot", ignore_errors=True)
        shutil.copytree(to_lerobot(made, seen), out / "lerobot")
        (out / "demo.hdf5.gz").write_bytes(gzip.compress(made.read_bytes(), mtime=0))
    kept = {f"{name}_{i}": value for i, truth in enumerate(seen) for name, value in truth.items() if name not in ("obs", "start")}
    np.savez_compressed(out / "truth.npz", **kept)
