"""The LeRobot dataset in tests/data/robocasa was written by LeRobot and RoboCasa themselves; make.py beside it says how."""

import gzip
import json
import shutil
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from symskill_pddl.demos.importing import ImportConfig
from symskill_pddl.demos.lerobot import is_lerobot, read_lerobot
from symskill_pddl.demos.recorded import Recorded, read_recording
from symskill_pddl.demos.replay import KinematicModel
from symskill_pddl.errors import FormatError, InputError, MissingDependencyError

DATA = Path(__file__).parents[1] / "data" / "robocasa"
needs_pyarrow = pytest.mark.skipif(
    find_spec("pyarrow") is None, reason="pyarrow is not in this environment: `make robocasa-test` runs this in one that has it"
)

BOMB = "extras/episode_000000/model.xml.gz"


def same(recorded: Recorded) -> Recorded:
    return recorded


@pytest.fixture
def dataset(tmp_path: Path) -> Path:
    return Path(shutil.copytree(DATA / "lerobot", tmp_path / "lerobot"))


@pytest.fixture(scope="module")
def hdf5(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("hdf5") / "open_door.hdf5"
    file.write_bytes(gzip.decompress((DATA / "demo.hdf5.gz").read_bytes()))
    return file


def test_robocasas_hdf5_is_read_as_the_simulator_was(hdf5: Path) -> None:
    truth = np.load(DATA / "truth.npz")
    recordings = read_recording(hdf5, same)
    assert [r.name for r in recordings] == ["demo_1", "demo_2"]
    for i, recorded in enumerate(recordings):
        assert recorded.env["env_name"] == "OpenCabinet"
        assert recorded.meta["lang"] == "Open the cabinet door."
        # the gripper's number is the seventh of twelve; the last one says who drives
        np.testing.assert_array_equal(recorded.closed, truth[f"closed_{i}"])
        np.testing.assert_allclose(np.diff(recorded.times), 0.05, atol=1e-9)
        model = KinematicModel(recorded.xml)
        recorded.check_states(model.state_size)
        replayed = model.replay(recorded.states)
        np.testing.assert_allclose(replayed.T_world_ee.p, truth[f"ee_{i}"][:, :3], atol=1e-5)


@needs_pyarrow
def test_a_lerobot_dataset_holds_the_same_as_the_hdf5_it_was_made_from(dataset: Path, hdf5: Path) -> None:
    assert is_lerobot(dataset)
    for ours, theirs in zip(read_lerobot(dataset, same), read_recording(hdf5, same), strict=True):
        np.testing.assert_array_equal(ours.states, theirs.states)
        np.testing.assert_array_equal(ours.closed, theirs.closed)
        np.testing.assert_array_equal(ours.times, theirs.times)
        assert ours.meta == theirs.meta
        assert ours.env["env_name"] == theirs.env["env_name"]
        assert KinematicModel(ours.xml).state_size == ours.states.shape[1]


@needs_pyarrow
def test_episodes_that_share_a_parquet_file_are_told_apart(dataset: Path) -> None:
    import pyarrow
    import pyarrow.parquet as parquet

    separate = read_lerobot(dataset, same)
    files = sorted((dataset / "data").glob("*/*.parquet"))
    table = pyarrow.concat_tables([parquet.read_table(f) for f in files])
    for file in files:
        file.unlink()
    parquet.write_table(table, dataset / "data" / "chunk-000" / "file-000.parquet")
    for a, b in zip(separate, read_lerobot(dataset, same), strict=True):
        np.testing.assert_array_equal(a.closed, b.closed)


def break_action(dataset: Path) -> None:
    import pyarrow
    import pyarrow.parquet as parquet

    file = dataset / "data" / "chunk-000" / "episode_000000.parquet"
    table = parquet.read_table(file)
    parquet.write_table(table.drop_columns(["action"]).append_column("act", pyarrow.array([0] * len(table))), file)


def shorten_action(dataset: Path) -> None:
    import pyarrow.parquet as parquet

    file = dataset / "data" / "chunk-000" / "episode_000000.parquet"
    parquet.write_table(parquet.read_table(file).slice(3), file)


def edit(dataset: Path, name: str, **changes: object) -> None:
    value = json.loads((dataset / name).read_text())
    (dataset / name).write_text(json.dumps(value | changes))


@needs_pyarrow
@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda d: (d / "data/chunk-000/episode_000000.parquet").unlink(), "episode_000000: no actions"),
        (lambda d: (d / "data/chunk-000/episode_000000.parquet").write_bytes(b"PAR1 no"), "parquet file cannot be read"),
        (break_action, "parquet file cannot be read"),
        (shorten_action, "17 actions do not match 20 states"),
        (lambda d: edit(d, "meta/modality.json", action={"gripper_close": {"start": 40}}), "would be number 41"),
    ],
)
def test_bad_actions_are_named(dataset: Path, spoil: object, message: str) -> None:
    spoil(dataset)  # type: ignore[operator]
    with pytest.raises(FormatError, match=message):
        read_lerobot(dataset, same, ImportConfig(names=("demo_0",)))


@pytest.mark.parametrize(
    ("spoil", "error", "message"),
    [
        (lambda d: shutil.rmtree(d / "meta"), InputError, "no LeRobot dataset"),
        (lambda d: shutil.rmtree(d / "extras"), InputError, "is a LeRobot dataset without poses of objects"),
        (lambda d: (d / "extras/dataset_meta.json").unlink(), InputError, "there is no file of the dataset .*dataset_meta.json"),
        (lambda d: (d / "extras/dataset_meta.json").write_text("{"), FormatError, "is no JSON"),
        (lambda d: (d / "extras/dataset_meta.json").write_text("[]"), FormatError, "has to be a JSON object"),
        (lambda d: edit(d, "extras/dataset_meta.json", env_args=3), FormatError, "env_args has to be"),
        (lambda d: edit(d, "meta/modality.json", action={"arm": {}}), FormatError, "gripper_close.start; its actions are: arm"),
        (
            lambda d: (d / "extras/episode_000000/states.npz").unlink(),
            FormatError,
            "there is no file of the episode .*states.npz",
        ),
        (
            lambda d: (d / "extras/episode_000000/states.npz").write_bytes(b"PK"),
            FormatError,
            "states.npz: is no readable archive",
        ),
        (lambda d: (d / "extras/episode_000000/model.xml.gz").write_bytes(b"x"), FormatError, "cannot be read"),
        (lambda d: np.savez(d / "extras/episode_000000/states.npz", states=np.zeros(3)), FormatError, "states have to be"),
        (
            lambda d: np.savez(d / "extras/episode_000000/states.npz", other=np.zeros(3)),
            FormatError,
            "no array 'states' of numbers; it has: other",
        ),
        (lambda d: (d / BOMB).write_bytes(gzip.compress(bytes(70_000_000), 1)), FormatError, "is longer than 64000000 bytes"),
        (lambda d: edit(d, "meta/modality.json", action={"gripper_close": 0.5}), FormatError, "its actions are: gripper_close"),
        (lambda d: (d / "extras/episode_000000").rename(d / "extras/episode_x"), FormatError, "end in its number"),
    ],
)
def test_what_is_missing_or_damaged_is_named(dataset: Path, spoil: object, error: type[Exception], message: str) -> None:
    spoil(dataset)  # type: ignore[operator]
    with pytest.raises(error, match=message):
        read_lerobot(dataset, same, ImportConfig(names=("demo_0",)))


def test_without_pyarrow_it_says_what_to_install(dataset: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    monkeypatch.setitem(__import__("sys").modules, "pyarrow.compute", None)
    with pytest.raises(MissingDependencyError, match=r"symskill-pddl\[lerobot\]"):
        read_lerobot(dataset, same)
