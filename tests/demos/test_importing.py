from pathlib import Path

import pytest

from symskill_pddl.demos.importing import ImportConfig, each, no_hdf5, task_name
from symskill_pddl.errors import FormatError, InputError

NAMES, LISTS = ("demo_1", "demo_2", "demo_10"), {"good": ("demo_10", "demo_1")}


def test_episodes_are_chosen_by_name_by_list_and_by_number():
    assert ImportConfig().chosen(NAMES, LISTS, "f") == NAMES
    assert ImportConfig(count=2).chosen(NAMES, LISTS, "f") == ("demo_1", "demo_2")
    assert ImportConfig(names=("demo_10",)).chosen(NAMES, LISTS, "f") == ("demo_10",)
    assert ImportConfig(filter_key="good").chosen(NAMES, LISTS, "f") == ("demo_1", "demo_10")
    assert ImportConfig(filter_key="good", count=1).chosen(NAMES, LISTS, "f") == ("demo_1",)


@pytest.mark.parametrize(
    ("config", "message"),
    [
        ({"names": ("demo_3",)}, "there is no episode 'demo_3'; it has: demo_1"),
        ({"filter_key": "better"}, "there is no filter key 'better'; it has: good"),
        ({"filter_key": "good", "names": ("demo_2",)}, "no episode is both in filter key 'good' and chosen by name"),
    ],
)
def test_a_choice_of_nothing_is_refused(config, message):
    with pytest.raises(InputError, match=message):
        ImportConfig(**config).chosen(NAMES, LISTS, "f")


@pytest.mark.parametrize("config", [{"count": 0}, {"rate_hz": 0.0}, {"rate_hz": float("nan")}])
def test_numbers_have_to_make_sense(config):
    with pytest.raises(InputError):
        ImportConfig(**config)


def test_what_cannot_be_used_is_left_out_and_said():
    def make(name: str) -> str:
        if name == "demo_2":
            raise FormatError("'file': data/demo_2: it has 1 samples")
        return name.upper()

    said: list[str] = []
    assert each(NAMES, make, "'file'", said.append) == ("DEMO_1", "DEMO_10")
    assert said == ["'file': 'demo_2' is left out: it has 1 samples"]
    with pytest.raises(FormatError, match="it has 1 samples"):
        each(("demo_2",), make, "'file'", said.append)


def test_an_instruction_becomes_a_name():
    assert task_name("put the bowl, then the plate.") == "put_the_bowl_then_the_plate"
    assert task_name(" ") == ""


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.csv", b"time,x,y\n0,1,2\n", "is no HDF5 file but a text file; poses of one's own .*docs/recordings.md"),
        ("a.hdf5", b"time,x,y\n0,1,2\n", "but a text file"),
        ("a.npz", b"PK\x03\x04 and more", "but a zip archive"),
        ("a.parquet", b"PAR1 and more", "but a Parquet file; of a LeRobot dataset, name the folder"),
        ("a.bin", b"\x00\x01\x02", "but of an unknown kind"),
        ("a.hdf5", b"", "damaged or truncated"),
        ("a.h5", b"\x89HD", "damaged or truncated"),
    ],
)
def test_what_is_no_hdf5_is_called_what_it_is(tmp_path: Path, name, content, message):
    (tmp_path / name).write_bytes(content)
    error = no_hdf5(tmp_path / name)
    assert error is not None
    with pytest.raises(FormatError, match=message):
        raise error
