"""A view of somebody else's HDF5 file: nothing but the file is read, and no more than it can mean."""

import io
import os
import resource
import zlib

import h5py
import numpy as np
import pytest

from symskill_pddl.demos.safe_hdf5 import Dataset, Group, opened
from symskill_pddl.errors import FormatError, InputError


@pytest.fixture
def made(tmp_path):
    """Call with what makes a file; gives its path."""

    def make(fill, name="file.hdf5"):
        with h5py.File(tmp_path / name, "w") as file:
            fill(file)
        return tmp_path / name

    return make


def read(path, *names):
    with opened(path) as place:
        for name in names:
            place = place[name]
        return place.read()


def test_what_is_in_a_file(made):
    def fill(file):
        data = file.create_group("data")
        data.attrs.update({"text": "é", "bytes": np.bytes_(b"abc"), "whole": 3, "real": 0.5, "truth": True, "array": [1, 2]})
        data["plain"] = np.arange(6.0).reshape(2, 3)
        data.create_dataset("packed", data=np.zeros((300, 3), np.float32), chunks=(64, 3), compression="gzip", shuffle=True)
        data.create_dataset("checked", data=np.arange(5), chunks=(5,), compression="gzip", fletcher32=True)
        data.create_dataset("grows", data=np.arange(5), maxshape=(None,), chunks=(1024,))
        data["empty"] = np.zeros((0, 7))
        data["same"] = h5py.SoftLink("/data/plain")
        data["beside"] = h5py.SoftLink("./packed")

    path = made(fill)
    for source in (path, path.read_bytes()):
        with opened(source) as file:
            data = file["data"]
            assert isinstance(data, Group)
            assert set(data) == {"plain", "packed", "checked", "grows", "empty", "same", "beside"}
            assert data.attrs.plain() == {"text": "é", "bytes": "abc", "whole": 3, "real": 0.5, "truth": True}
            with pytest.raises(FormatError, match=r"data: attribute 'array' has to be a text or a number"):
                data.attrs["array"]
            assert data.attrs.get("none") is None
            assert isinstance(data["plain"], Dataset)
            assert data["same"].read().tolist() == [[0, 1, 2], [3, 4, 5]]
            assert data["beside"].read().shape == (300, 3)
            assert data["checked"].read().tolist() == data["grows"].read().tolist() == [0, 1, 2, 3, 4]
            assert data["empty"].read().shape == (0, 7)
            assert data.get("none") is None
            assert data.get("../data") is None


def _external_link(file):
    file["x"] = h5py.ExternalLink("other.hdf5", "/x")


def _link_to_external_link(file):
    file["y"] = h5py.ExternalLink("other.hdf5", "/")
    file["x"] = h5py.SoftLink("/y/x")


def _link_loop(file):
    file["x"] = h5py.SoftLink("/x")


def _two_links_loop(file):
    file["x"], file["y"] = h5py.SoftLink("/y"), h5py.SoftLink("/x")


def _dangling(file):
    file["x"] = h5py.SoftLink("/gone")


def _group_in_itself(file):
    group = file.create_group("a")
    group["x"] = group
    file["x"] = h5py.SoftLink("/a/x")


def _external_storage(file):
    file.create_dataset("x", (4,), "u1", external=[("private.bin", 0, 4)])


def _virtual(file):
    layout = h5py.VirtualLayout((4,), "u1")
    layout[:] = h5py.VirtualSource("other.hdf5", "x", (4,))
    file.create_virtual_dataset("x", layout)


def _objects(file):
    file.create_dataset("x", data=np.array(["a"], dtype=h5py.string_dtype()))


def _references(file):
    file.create_dataset("x", data=file.ref, dtype=h5py.ref_dtype)


def _unknown_filter(file):
    file.create_dataset("x", data=np.zeros(100), chunks=(100,), compression="lzf")


def _nothing_stored(file):
    file.create_dataset("x", (1_000_000_000, 7), "f8", chunks=(1000, 7))


def _nothing_stored_in_one_piece(file):
    file.create_dataset("x", (1_000_000_000, 7), "f8")


def _compresses_well(file):
    file.create_dataset("x", data=np.zeros(12_000_000), chunks=(12_000_000,), compression="gzip", compression_opts=9)


def _large_chunk(file):
    file.create_dataset("x", (10,), "f8", maxshape=(None,), chunks=(50_000_000,), compression="gzip")


def _trapped_chunk(file):
    dataset = file.create_dataset("x", (1000,), "f8", chunks=(1000,), compression="gzip")
    dataset.id.write_direct_chunk((0,), zlib.compress(bytes(100_000_000), 9))


def _compressed_twice(file):
    plan = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    plan.set_chunk((1000,))
    plan.set_deflate(9)
    plan.set_deflate(9)
    h5py.h5d.create(file.id, b"x", h5py.h5t.NATIVE_DOUBLE, h5py.h5s.create_simple((1000,)), plan)


@pytest.mark.parametrize(
    ("fill", "message"),
    [
        (_external_link, "x: is a link to another file"),
        (_link_to_external_link, "y: is a link to another file"),
        (_link_loop, "x: is a link that leads to no end"),
        (_two_links_loop, "x: is a link that leads to no end"),
        (_dangling, "x: is a link to '/gone', which is not there"),
        (_group_in_itself, "a/x: is a group that contains itself"),
        (_external_storage, "x: is stored in another file"),
        (_virtual, "x: is a virtual data set"),
        (_objects, "x: has to hold numbers"),
        (_references, "x: has to hold numbers"),
        (_unknown_filter, "x: is packed with the filter 32000"),
        (_nothing_stored, r"x: states \(1000000000, 7\) numbers"),
        (_nothing_stored_in_one_piece, r"x: states \(1000000000, 7\) numbers"),
        (_compresses_well, r"x: states \(12000000,\) numbers"),
        (_large_chunk, "x: has chunks of 400000000 bytes"),
        (_trapped_chunk, "x: has a chunk of 8000 bytes that becomes longer"),
        (_compressed_twice, "x: is compressed more than once"),
    ],
)
def test_what_is_not_in_the_file_or_cannot_be_is_refused(made, tmp_path, monkeypatch, fill, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "private.bin").write_bytes(b"\x07\x08\x09\x0a")
    made(lambda file: file.create_dataset("x", data=np.arange(4, dtype="u1")), "other.hdf5")
    path = made(fill)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(FormatError, match=f"'{path}': {message}"):
        read(path, "x")
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 60_000  # kB


def test_all_that_is_read_of_a_file_together_is_bounded(made):
    def fill(file):
        for i in range(20):
            file.create_dataset(f"x{i}", data=np.zeros(1_000_000), chunks=(1_000_000,), compression="gzip")

    with opened(made(fill)) as file:
        arrays = [file[name] for name in file]
        with pytest.raises(FormatError, match="is trusted with"):
            [array.read() for array in arrays]


def test_a_text_that_is_no_text(made):
    def fill(file):
        file.attrs.create("text", np.bytes_(b"\xff\xfe"))

    with opened(made(fill)) as file, pytest.raises(FormatError, match="not a readable HDF5 file"):
        file.attrs["text"]


def test_what_is_no_hdf5_file(tmp_path):
    (tmp_path / "text").write_bytes(b"no HDF5")
    (tmp_path / "nothing").write_bytes(b"")
    for name, error in (("text", FormatError), ("nothing", FormatError), ("gone", InputError), ("", InputError)):
        with pytest.raises(error), opened(tmp_path / name):
            pass
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match="is no file"), opened(tmp_path / "pipe"):
        pass


def test_a_file_in_memory_is_called_by_its_name():
    buffer = io.BytesIO()
    h5py.File(buffer, "w").close()
    with opened(buffer.getvalue(), "copy of x") as file, pytest.raises(FormatError, match="'copy of x': y: there is no such"):
        file["y"]


@pytest.mark.parametrize("size", [0, 2**64 - 16, 2**63])
def test_a_heap_without_end_is_refused(tmp_path, made, size):
    def fill(file):
        file.attrs.create("text", "a text in the heap", dtype=h5py.string_dtype())

    content = bytearray(made(fill).read_bytes())
    at = content.index(b"GCOL")
    first = at + 16
    used = 16 + (int.from_bytes(content[first + 8 : first + 16], "little") + 7) // 8 * 8
    free = first + (0 if size else used)
    content[free : free + 16] = (1 if size else 0).to_bytes(8, "little") + size.to_bytes(8, "little")
    (tmp_path / "bad.hdf5").write_bytes(content)
    for source in (bytes(content), tmp_path / "bad.hdf5"):
        with pytest.raises(FormatError, match="in its heap"), opened(source):
            pass
