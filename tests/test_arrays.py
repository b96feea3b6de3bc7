"""Archives of arrays: what is written is read, and nothing that states more than it holds."""

import contextlib
import io
import resource
import zipfile

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as some

from symskill_pddl.arrays import read_npz, write_npz
from symskill_pddl.errors import FormatError

ARRAYS = some.arrays(
    st.sampled_from([np.float64, np.float32, np.int64, np.uint8, np.bool_]), some.array_shapes(min_dims=0, min_side=0)
)


@given(st.dictionaries(st.text("abc.", min_size=1), ARRAYS, max_size=3))
def test_what_is_written_is_read(arrays):
    arrays = {name: np.nan_to_num(a, posinf=1, neginf=1) if a.dtype.kind == "f" else a for name, a in arrays.items()}
    content = write_npz(arrays)
    assert content == write_npz(dict(reversed(arrays.items())))
    for form in (content, _numpys(arrays)):
        found = read_npz(form, "x")
        assert found.keys() == arrays.keys()
        assert all(np.array_equal(found[n], a) and found[n].dtype == a.dtype for n, a in arrays.items())


def _numpys(arrays):
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **{name: np.asfortranarray(a) if a.ndim else a for name, a in arrays.items()})
    return buffer.getvalue()


def _archive(content, name="a.npy", compression=zipfile.ZIP_STORED):
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", compression) as archive:
        archive.writestr(name, content)
    return buffer.getvalue()


def _npy(header, data=b""):
    text = (header + "\n").encode()
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + data


def _bomb():
    return _archive(_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (25000000,)}", bytes(200_000_000)), "a.npy", 8)


def _understated():
    # the directory says 8 bytes, the stream holds two hundred million
    honest = bytearray(_bomb())
    at = honest.index(b"PK\x01\x02")
    honest[at + 24 : at + 28] = (8).to_bytes(4, "little")
    return bytes(honest)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: b"", "no readable archive"),
        (lambda: b"no archive", "no readable archive"),
        (lambda: _numpys({"a": np.zeros(1000)})[:-100], "no readable archive"),
        (_bomb, "is trusted with"),
        (_understated, "array 'a'|no readable archive"),
        (lambda: _archive(_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999,)}")), "states the shape"),
        (lambda: _archive(_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (-1,)}")), "has to hold numbers or texts"),
        (lambda: _archive(_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (0,)}", b"1")), "states the shape"),
        (lambda: _archive(_npy("{'descr': '|O', 'fortran_order': False, 'shape': ()}")), "has to hold numbers"),
        (lambda: _archive(_npy("{'descr': '<U1', 'fortran_order': False, 'shape': ()}", b"\0\xd8\0\0")), "no Unicode"),
        (lambda: _archive(_npy("{'descr': '<U1', 'fortran_order': False, 'shape': ()}", b"\xff" * 4)), "no Unicode"),
        (lambda: _archive(_npy("{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (0,)}")), "has to hold numbers"),
        (lambda: _archive(_npy("[" * 5000)), "has to hold numbers or texts"),
        (lambda: _archive(_npy("open('x')")), "has to hold numbers or texts"),
        (lambda: _archive(b"\x93NUMPY\x03\x00"), "is no array"),
        (lambda: _archive(b"no array"), "is no array"),
        (lambda: _archive(_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1,)}", b"\0" * 8), "a.npy", 14), "in a way"),
        (lambda: write_npz({"a": np.array([1.0, np.nan])}), "not finite"),
    ],
)
def test_an_archive_that_is_none_or_a_trap(make, message):
    content = make()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(FormatError, match=f"^'x.npz': .*({message})"):
        read_npz(content, "'x.npz'")
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 60_000  # kB


@given(st.data())
def test_no_flipped_byte_raises_anything_else(data):
    content = bytearray(write_npz({"a": np.arange(6.0).reshape(2, 3), "b": np.array(True)}))
    for _ in range(data.draw(st.integers(1, 3))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    with contextlib.suppress(FormatError):
        read_npz(bytes(content), "x")
