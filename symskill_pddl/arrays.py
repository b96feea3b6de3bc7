"""Arrays in NumPy's archives (.npz), written so that the same arrays give the same bytes, and read within bounds.

An archive states the size of each member, and each member the shape of its array; two megabytes can state gigabytes. Both are
compared with each other and with what an archive of its length can mean before anything is allocated.
"""

from __future__ import annotations

import io
import math
import re
import zipfile
import zlib
from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.errors import FormatError, shown
from symskill_pddl.reading import whole

LEAST_ROOM, RATIO = 64_000_000, 32
"""All arrays together take at most so many bytes, and so many times the archive's length more."""
MOST_MEMBERS, MOST_AXES = 10_000, 16
_HEADER = re.compile(
    r"\{'descr': '([<>|=](?:[fiub][0-9]{1,2}|U[0-9]{1,6}))', 'fortran_order': (True|False), 'shape': \(([0-9, ]*)\),? *\}\s*"
)


def write_npz(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """As `numpy.savez`, with sorted names and no time stamps."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name in sorted(arrays):
            member = io.BytesIO()
            np.save(member, np.asanyarray(arrays[name]), allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(f"{name}.npy", (1980, 1, 1, 0, 0, 0)), member.getvalue())
    return buffer.getvalue()


def read_npz(content: bytes, where: str) -> dict[str, NDArray[Any]]:
    """The arrays of an archive by name; they hold finite numbers, or texts.

    Parameters
    ----------
    content : bytes
    where : str
        Stands at the head of an error: ``'states.npz'``.

    Raises
    ------
    FormatError
        It is no such archive, is damaged, states more than it can hold, or holds something else.
    """
    room = LEAST_ROOM + RATIO * len(content)
    found: dict[str, NDArray[Any]] = {}
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            members = archive.infolist()
            if len(members) > MOST_MEMBERS:
                raise FormatError(f"{where}: holds more than {MOST_MEMBERS} arrays")
            for member in members:
                room -= member.file_size
                if room < 0:
                    raise FormatError(f"{where}: states more than an archive of {len(content)} bytes is trusted with")
                name = member.filename.removesuffix(".npy")
                found[name] = _array(archive, member, f"{where}: array '{shown(name, 80)}'")
    # what zipfile raises, depending on which bytes are wrong; NotImplementedError is an unknown compression
    except (zipfile.BadZipFile, zlib.error, OSError, EOFError, ValueError, TypeError, RuntimeError, LookupError) as error:
        raise FormatError(f"{where}: is no readable archive of arrays (damaged or truncated): {shown(error, 160)}") from None
    return found


def _array(archive: zipfile.ZipFile, member: zipfile.ZipInfo, where: str) -> NDArray[Any]:
    if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise FormatError(f"{where}: is compressed in a way that NumPy does not use")
    with archive.open(member) as file:
        content = file.read(member.file_size)  # not all of it, which may be more
    shape, order, dtype, start = _header(content, where)
    size = len(content) - start
    if math.prod(shape) * dtype.itemsize != size:
        raise FormatError(f"{where}: states the shape {shown(shape, 80)}, and holds {size} bytes")
    values: NDArray[Any] = np.ndarray(shape, dtype, content, start, order=order).copy()
    if dtype.kind == "U":
        codes = np.frombuffer(content, dtype.str[0] + "u4", offset=start)
        valid = np.all((codes < 0xD800) | ((codes > 0xDFFF) & (codes < 0x110000)))
    else:
        valid = np.all(np.isfinite(values))
    if not valid:
        raise FormatError(f"{where}: holds a number that is not finite, or a text that is no Unicode")
    return values


def _header(content: bytes, where: str) -> tuple[tuple[int, ...], Literal["F", "C"], np.dtype[Any], int]:
    """Shape, order and kind of an array as a member states them, and where its numbers begin.

    NumPy's own reader evaluates the text, with many ways to fail; all that is written for plain arrays has one form.
    """
    length = {b"\x01\x00": 2, b"\x02\x00": 4}.get(content[6:8])
    if content[:6] != b"\x93NUMPY" or length is None:
        raise FormatError(f"{where}: is no array of NumPy's format 1.0 or 2.0")
    start = 8 + length + int.from_bytes(content[8 : 8 + length], "little")
    found = _HEADER.fullmatch(content[8 + length : start].decode("latin-1")) if start <= len(content) else None
    if found is None:
        raise FormatError(f"{where}: has to hold numbers or texts, found the header {shown(content[8:200], 160)}")
    axes = [whole(n) for n in found[3].replace(" ", "").split(",") if n]
    if len(axes) > MOST_AXES or None in axes:
        raise FormatError(f"{where}: states the shape ({shown(found[3], 80)})")
    return tuple(n or 0 for n in axes), "F" if found[2] == "True" else "C", np.dtype(found[1]), start
