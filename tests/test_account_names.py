"""No recording that is committed here tells whose account it was made under."""

import gzip
import io
import re
import zipfile
from collections.abc import Iterator
from pathlib import Path

import h5py
import pytest

ROOT = Path(__file__).parent.parent
RECORDINGS = sorted(p for folder in ("tests/data", "symskill_pddl/data") for p in (ROOT / folder).rglob("*") if p.is_file())
HOME = re.compile(rb"(?:/home/|/Users/|\\Users\\)(?!user\b)[\w.-]+")


def contents(name: str, content: bytes) -> Iterator[bytes]:
    """A file's bytes, and what is packed inside it."""
    yield content
    if name.endswith(".gz"):
        yield from contents(name.removesuffix(".gz"), gzip.decompress(content))
    elif name.endswith(".npz"):
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            yield from (archive.read(member) for member in archive.namelist())
    elif name.endswith(".hdf5"):
        with h5py.File(io.BytesIO(content)) as file:
            objects = [file]
            file.visititems(lambda _, found: objects.append(found))
            for found in objects:
                yield from (str(value).encode() for value in found.attrs.values())
                if isinstance(found, h5py.Dataset) and found.dtype.kind in "OSU":
                    yield str(found[()]).encode()


@pytest.mark.parametrize("path", RECORDINGS, ids=lambda p: str(p.relative_to(ROOT)))
def test_no_recording_names_an_account(path: Path) -> None:
    assert [found for content in contents(path.name, path.read_bytes()) for found in HOME.findall(content)] == []


def test_a_name_is_found_where_it_hides(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file.create_group("data/demo_0").attrs["model_file"] = '<mesh file="/Users/somebody/x.stl"/>'
        file.create_dataset("data/note", data=["from /home/someone"] * 99, compression="gzip")
    found = [m for c in contents("a.hdf5.gz", gzip.compress((tmp_path / "a.hdf5").read_bytes())) for m in HOME.findall(c)]
    assert {b"/Users/somebody", b"/home/someone"} <= set(found)
