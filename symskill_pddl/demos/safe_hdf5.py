"""HDF5 files that somebody else made, as a view that reads nothing but the file itself, and no more than it can mean.

HDF5 can name other files (external links, external storage, virtual data sets, filters that are loaded from the disk), can point
in circles, and can state sizes that have nothing to do with what is there. Every reader of HDF5 goes through this module:

- links inside the file are followed, at most a few in a row; external links are refused, and so is a group within itself;
- a data set has to store its numbers in the file, plain, or compressed once with gzip (shuffle and checksums are allowed);
- before anything is allocated, its size is compared with the file's length, and each chunk's true size is counted while it is
  decompressed;
- attributes are texts and numbers.

Whatever HDF5 itself finds wrong becomes a `FormatError` that names the file and the path inside it.
"""

from __future__ import annotations

import io
import math
import mmap
import zlib
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.errors import FormatError, InputError, UnsafeError, shown

if TYPE_CHECKING:
    import h5py

LEAST_ROOM, RATIO = 64_000_000, 32
"""All that is read of a file takes at most so many bytes, and so many times the file's length more: numbers that were recorded
compress well, those of a trap a thousand times."""
MOST_NAMES, MOST_CHUNKS, MOST_HOPS, LONGEST_TEXT = 100_000, 100_000, 8, 64_000_000
_HEAP = b"GCOL\x01\0\0\0"
# what h5py raises, depending on which bytes are wrong
_DAMAGE = (OSError, RuntimeError, LookupError, ValueError, TypeError, ArithmeticError, AttributeError, MemoryError, zlib.error)

Scalar = str | int | float


@contextmanager
def opened(source: str | Path | bytes, name: str | Path | None = None) -> Iterator[Group]:
    """The root of an HDF5 file, or of one in memory; `name` is what errors call it, the path if it is not given.

    Raises
    ------
    InputError
        The file does not exist, is no regular file, or must not be read.
    FormatError
        It is no HDF5 file, or a damaged one; also from everything in the view.
    """
    import h5py

    where = str(name) if name is not None else "memory" if isinstance(source, bytes) else str(source)
    if isinstance(source, bytes):
        length = len(source)
    else:
        if not Path(source).is_file():
            what = "is no file" if Path(source).exists() else "does not exist"
            raise InputError(f"'{where}' {what}; an HDF5 file is needed")
        length = Path(source).stat().st_size
    try:
        _check_heaps(source, where, length)
        file = h5py.File(io.BytesIO(source) if isinstance(source, bytes) else source, "r")
    except PermissionError as error:
        raise InputError(f"cannot read '{where}': {error.strerror or 'permission denied'}") from error
    except FormatError:
        raise
    except _DAMAGE as error:
        raise _damaged(where, error) from error
    try:
        yield Group(_File(where, file, length, LEAST_ROOM + RATIO * length), file, "", ())
    finally:
        file.close()


def _check_heaps(source: str | Path | bytes, where: str, length: int) -> None:
    """Raise where HDF5 would go through the texts of a file without end: in a heap (``GCOL``) an object that takes no room.

    Each object is an index, a count and 4 bytes unused, its size in 8 bytes, and that many bytes up to the next multiple of 8;
    index 0 is free space, whose size counts its head too.
    """
    if not length:
        return
    with ExitStack() as stack:
        if isinstance(source, bytes):
            content: bytes | mmap.mmap = source
        else:
            file = stack.enter_context(Path(source).open("rb"))
            content = stack.enter_context(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))
        at = content.find(_HEAP)
        while at >= 0:
            end, place = at + int.from_bytes(content[at + 8 : at + 16], "little"), at + 16
            while place + 16 <= min(end, length):
                index, size = int.from_bytes(content[place : place + 2], "little"), content[place + 8 : place + 16]
                taken = int.from_bytes(size, "little")
                taken = taken if index == 0 else (16 + (taken + 7) // 8 * 8)
                if taken % 2**64 == 0 or taken > 2**63:
                    raise FormatError(f"'{where}' is damaged: an object in its heap at byte {at} has no size")
                place += taken
            at = content.find(_HEAP, at + 1)


def _damaged(where: str, error: BaseException) -> FormatError:
    return FormatError(f"'{where}' is not a readable HDF5 file (damaged or truncated): {shown(error, 160)}")


@dataclass
class _File:
    """What all views of one file share; `room` is how many bytes may still be read."""

    where: str
    file: h5py.File
    length: int
    room: int


class _Node:
    """A group or data set at a path inside the file."""

    def __init__(self, shared: _File, node: Any, inside: str) -> None:
        self._shared, self._node, self.name = shared, node, inside

    def fail(self, message: str, inside: str | None = None) -> FormatError:
        """An error about this node, or another path."""
        at = self.name if inside is None else inside
        return FormatError(f"'{self._shared.where}': {shown(at, 120)}{': ' if at else ''}{message}")

    def unsafe(self, message: str, inside: str | None = None) -> UnsafeError:
        """An error for which the whole file is refused."""
        return UnsafeError(str(self.fail(message, inside)))

    @contextmanager
    def _reading(self) -> Iterator[None]:
        try:
            yield
        except FormatError:
            raise
        except _DAMAGE as error:
            raise _damaged(self._shared.where, error) from error

    @property
    def attrs(self) -> Attributes:
        """Its attributes."""
        return Attributes(self)


class Attributes(Mapping[str, Scalar]):
    """Texts and numbers by name; one that is neither raises `FormatError` when it is asked for."""

    def __init__(self, node: _Node) -> None:
        self._node = node
        with node._reading():
            self._names = tuple(str(name) for name in node._node.attrs)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __getitem__(self, name: str) -> Scalar:
        if name not in self._names:
            raise KeyError(name)
        value = self._read(name)
        if value is None:
            raise self._node.fail(f"attribute '{shown(name, 80)}' has to be a text or a number")
        return value

    def plain(self) -> dict[str, Scalar]:
        """All that are texts or numbers."""
        return {name: value for name in self._names if (value := self._read(name)) is not None}

    def _read(self, name: str) -> Scalar | None:
        import h5py

        node = self._node
        with node._reading():
            own = h5py.h5a.open(node._node.id, name.encode("utf-8", "surrogateescape"))
            if own.shape != () or own.get_storage_size() > min(LONGEST_TEXT, node._shared.length):
                return None
            kind = own.get_type().get_class()
            if kind not in (h5py.h5t.STRING, h5py.h5t.INTEGER, h5py.h5t.FLOAT, h5py.h5t.ENUM):
                return None
            value = node._node.attrs[name]
            if isinstance(value, bytes):
                value = value.decode("utf-8")
            if isinstance(value, np.generic):
                value = value.item()
            if isinstance(value, str):
                value.encode("utf-8")  # half a character could be written nowhere
            return value if isinstance(value, str | int | float) else None


class Group(_Node):
    """A group; its members by name."""

    def __init__(self, shared: _File, node: Any, inside: str, above: tuple[int, ...]) -> None:
        super().__init__(shared, node, inside)
        with self._reading():
            self._above = (*above, _address(node))

    def __iter__(self) -> Iterator[str]:
        with self._reading():
            if len(self._node) > MOST_NAMES:
                raise self.fail(f"holds more than {MOST_NAMES} members")
            names = [str(name) for name in self._node]
            for name in names:
                name.encode("utf-8")
        return iter(names)

    def __contains__(self, name: object) -> bool:
        with self._reading():
            return isinstance(name, str) and name not in ("", ".") and "/" not in name and self._has(name)

    def _has(self, name: str) -> bool:
        return bool(self._node.id.links.exists(name.encode("utf-8")))

    def __getitem__(self, name: str) -> Group | Dataset:
        found = self.get(name)
        if found is None:
            raise self.fail("there is no such member", self._inside(name))
        return found

    def get(self, name: str) -> Group | Dataset | None:
        """A member; None if there is none."""
        return self._follow(name, MOST_HOPS) if name in self else None

    def _inside(self, name: str) -> str:
        return f"{self.name}/{name}" if self.name else name

    def _follow(self, name: str, hops: int) -> Group | Dataset:
        import h5py

        inside = self._inside(name)
        with self._reading():
            link = self._node.get(name, getlink=True)
        if isinstance(link, h5py.SoftLink):
            return self._along(str(link.path), inside, hops - 1)
        if not isinstance(link, h5py.HardLink):
            raise self.unsafe("is a link to another file, and data of other files is not read", inside)
        with self._reading():
            node = self._node[name]
            if isinstance(node, h5py.Dataset):
                return Dataset(self._shared, node, inside)
            if not isinstance(node, h5py.Group):
                raise self.fail("is neither a group nor a data set", inside)
            if _address(node) in self._above:
                raise self.fail("is a group that contains itself", inside)
        return Group(self._shared, node, inside, self._above)

    def _along(self, path: str, inside: str, hops: int) -> Group | Dataset:
        """Where a link inside the file leads, one member after another."""
        if hops < 0:
            raise self.fail("is a link that leads to no end (damaged)", inside)
        place: Group | Dataset = self
        if path.startswith("/"):
            place = Group(self._shared, self._shared.file, "", ())
        for part in (p for p in path.split("/") if p not in ("", ".")):
            if not isinstance(place, Group) or part not in place:
                raise self.fail(f"is a link to '{shown(path, 80)}', which is not there", inside)
            place = place._follow(part, hops)
        return place


class Dataset(_Node):
    """An array that has not been read yet."""

    ALLOWED: ClassVar = {1: "gzip", 2: "shuffle", 3: "fletcher32"}

    def __init__(self, shared: _File, node: Any, inside: str) -> None:
        super().__init__(shared, node, inside)
        with self._reading():
            self.shape = tuple(int(n) for n in node.shape or ())
            self.dtype: np.dtype[Any] = node.dtype

    @property
    def ndim(self) -> int:
        """Number of axes."""
        return len(self.shape)

    def __getitem__(self, all_of_it: Any) -> NDArray[Any]:
        if all_of_it is not Ellipsis:
            raise TypeError("a data set is read as a whole")
        return self.read()

    def read(self) -> NDArray[Any]:
        """All of it.

        Raises
        ------
        FormatError
            It does not hold numbers, or holds them in another file; it is larger than the file can mean; it is damaged.
        """
        import h5py

        if self.dtype.kind not in "fiub" or self.dtype.itemsize > 16:
            raise self.fail(f"has to hold numbers, found {shown(self.dtype, 80)}")
        with self._reading():
            plan = self._node.id.get_create_plist()
            layout = plan.get_layout()
            if layout == h5py.h5d.VIRTUAL:
                raise self.unsafe("is a virtual data set: its numbers are in other files, which are not read")
            if plan.get_external_count():
                raise self.unsafe("is stored in another file, which is not read")
            # they are worked on as float64
            self._take(math.prod(self.shape) * max(self.dtype.itemsize, 8))
            if layout == h5py.h5d.CHUNKED:
                self._check_chunks(plan)
            elif self._node.id.get_storage_size() > self._shared.length:
                raise self.fail("is longer than the file")
            return np.asarray(self._node[...])

    def texts(self) -> tuple[str, ...]:
        """All of a list of texts.

        Raises
        ------
        FormatError
            It is no list of texts, or is longer than the file can mean; it is damaged.
        """
        import h5py

        found: list[str] = []
        with self._reading():
            plan = self._node.id.get_create_plist()
            if plan.get_layout() == h5py.h5d.VIRTUAL or plan.get_external_count():
                raise self.fail("is stored in other files, which are not read")
            if h5py.check_string_dtype(self.dtype) is None or self.ndim != 1 or self.shape[0] > MOST_NAMES:
                raise self.fail(f"has to be a list of texts, found {shown(self.dtype, 80)} {self.shape}")
            if plan.get_nfilters():
                self._check_chunks(plan)
            for i in range(self.shape[0]):
                text = self._node[i]
                self._take(len(text))
                found.append(text.decode("utf-8") if isinstance(text, bytes) else str(text))
        return tuple(found)

    def _take(self, size: int) -> None:
        if size > self._shared.room:
            raise self.unsafe(
                f"states {self.shape} numbers, more than {self._shared.room // 1_000_000} MB, the most that a file of "
                f"{self._shared.length} bytes is trusted with"
            )
        self._shared.room -= size

    def _check_chunks(self, plan: Any) -> None:
        """Each chunk lies in the file and holds what it should: counted, as a compressed one may be a trap."""
        filters = [int(plan.get_filter(i)[0]) for i in range(plan.get_nfilters())]
        if strange := [f for f in filters if f not in self.ALLOWED]:
            raise self.fail(f"is packed with the filter {strange[0]}; read are {', '.join(self.ALLOWED.values())}")
        if filters.count(1) > 1:
            raise self.unsafe("is compressed more than once")
        size = math.prod(plan.get_chunk()) * self.dtype.itemsize
        # a chunk may be larger than the array, and is decompressed as a whole
        if size > self._shared.room + math.prod(self.shape) * self.dtype.itemsize:
            raise self.unsafe(f"has chunks of {size} bytes, more than a file of {self._shared.length} bytes is trusted with")
        chunks: list[Any] = []
        self._node.id.chunk_iter(lambda chunk: True if len(chunks) > MOST_CHUNKS else chunks.append(chunk))
        if len(chunks) > MOST_CHUNKS:
            raise self.fail(f"has more than {MOST_CHUNKS} chunks")
        for chunk in chunks:
            if chunk.size > self._shared.length:
                raise self.fail("has a chunk that is longer than the file")
            if 1 in filters:
                self._check_inflated(self._node.id.read_direct_chunk(chunk.chunk_offset), filters, size)

    def _check_inflated(self, stored: tuple[int, bytes], filters: list[int], size: int) -> None:
        skipped, content = stored
        if skipped >> filters.index(1) & 1:
            return
        unpacking = zlib.decompressobj()
        # a checksum of 4 bytes may be inside
        found = unpacking.decompress(content, size + 5)
        if len(found) > size + 4:
            raise self.unsafe(f"has a chunk of {size} bytes that becomes longer when it is decompressed")


def _address(group: Any) -> int:
    import h5py

    return int(h5py.h5o.get_info(group.id).addr)
