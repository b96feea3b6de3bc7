import dataclasses
import hashlib

import h5py
import numpy as np
import pytest

from symskill_pddl.demos import Move, Truth, load_demos, load_truths, save_demos
from symskill_pddl.errors import FormatError, InputError

from .conftest import make_demo

MOVE = Move("cheese", 1.0, 2.5, "cabinet", "counter")


def truth(n):
    return Truth((MOVE,), {("at", "cheese", "counter"): np.arange(n) > n // 2, ("open", "door", "cabinet"): np.ones(n, bool)})


def test_truth_lies_beside_the_demonstrations_and_they_read_the_same(tmp_path):
    demo = make_demo()
    save_demos(tmp_path / "a.hdf5", [demo], {"demo_0": truth(len(demo))})
    save_demos(tmp_path / "b.hdf5", [demo])
    found = load_truths(tmp_path / "a.hdf5")["demo_0"]
    assert found.moves == (MOVE,)
    assert {k: v.tolist() for k, v in found.relations.items()} == {k: v.tolist() for k, v in truth(len(demo)).relations.items()}
    a, b = (load_demos(tmp_path / f"{name}.hdf5")[0] for name in "ab")
    same = [f.name for f in dataclasses.fields(a) if f.name not in ("source", "T_world_ee", "T_world_objects")]
    assert all(np.array_equal(getattr(a, name), getattr(b, name)) for name in same)
    assert np.array_equal(a.T_world_objects.vector(), b.T_world_objects.vector())
    assert load_truths(tmp_path / "b.hdf5") == {}


def test_the_same_truth_gives_the_same_bytes(tmp_path):
    demo = make_demo()
    for name in "ab":
        save_demos(tmp_path / name, [demo], {"demo_0": truth(len(demo))})
    assert len({hashlib.sha256((tmp_path / name).read_bytes()).hexdigest() for name in "ab"}) == 1


def test_truth_of_something_else_is_refused(tmp_path):
    demo = make_demo()
    for truths in ({"demo_0": truth(len(demo) + 1)}, {"demo_7": truth(len(demo))}):
        with pytest.raises(InputError, match="does not belong to a demonstration of that name and length"):
            save_demos(tmp_path / "a.hdf5", [demo], truths)
    assert not (tmp_path / "a.hdf5").exists()


def test_damage_is_said_in_one_line(tmp_path):
    demo, path = make_demo(), tmp_path / "a.hdf5"
    with pytest.raises(InputError, match="does not exist"):
        load_truths(path)
    save_demos(path, [demo], {"demo_0": truth(len(demo))})
    with h5py.File(path, "r+") as file:
        file["truth"].attrs["schema_version"] = 9
    with pytest.raises(FormatError, match="schema_version 9 cannot be read"):
        load_truths(path)
    with h5py.File(path, "r+") as file:
        file["truth"].attrs["schema_version"] = 1
        file["truth/demo_0"].attrs["moves"] = "[{"
    with pytest.raises(FormatError, match="truth/demo_0: moves: is no JSON"):
        load_truths(path)
    assert load_demos(path)
    (tmp_path / "text").write_text("no HDF5")
    with pytest.raises(FormatError, match="not a readable HDF5 file"):
        load_truths(tmp_path / "text")
