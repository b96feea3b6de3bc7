"""Ways to spoil a file that is right: bytes, words, values of JSON, members of HDF5 and NumPy's archives, kinds of file."""

from __future__ import annotations

import gzip
import io
import json
import math
import os
import re
import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import h5py
import numpy as np

SECRET = "/etc/hostname"
"""Nothing may open this file because an input names it."""
NUMBERS = (
    "nan",
    "NaN",
    "-Infinity",
    "1e999",
    "-0",
    "-1",
    "1.2.3",
    "9" * 25,
    "9" * 5000,
    "1e-400",
    "0x10",
    "²",
    "1_000",
    "18446744073709551616",
)
WORDS = (
    *NUMBERS,
    *(
        "",
        " ",
        "?",
        "=",
        "(",
        ")",
        "(= )",
        "( )",
        "()",
        ";",
        "-",
        "- -",
        ":",
        "object",
        "either",
        "not",
        "at",
        "at-1",
        "and",
        "or",
        "forall",
        "when",
    ),
    *("\x1b]52;c;QUJD\x07", "\x9b2J", "\u202e", "\0", "\ufeff", "\r", "\r\n", "\x0b", "\u2028", "\ud800", "é", "𝔞", "İ", "ß"),
    *(
        "../x",
        SECRET,
        f"file://{SECRET}",
        "http://[::1",
        "a" * 5000,
        "{}",
        "%s%n",
        "{0}",
        "null",
        "true",
        "[",
        "]",
        '"',
        "\\",
        "\\ud800",
        "\\u0000",
    ),
    *(
        "(" * 300,
        "[" * 5000,
        '{"a":' * 3000,
        "<include file='/etc/hostname'/>",
        "<!DOCTYPE x>",
        "&x;",
        "<body>" * 300,
        "cost",
        "[D:1.00; C:0.10]",
    ),
)
VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, 1, -1, 10**17, -(10**17), 2**63, 10**30, 0.5, -1e308, 1e308, 5e-324, math.nan, math.inf),
    *(
        "",
        " ",
        ".",
        "a" * 5000,
        "\x1b[2J",
        "\0",
        "\ud800",
        "?",
        "/",
        "../../etc/passwd",
        [],
        {},
        [[]],
        [{}],
        [None],
        {"": ""},
        [0] * 1000,
        "1",
    ),
)
# what a library raises of a file that is spoilt already
_SPOILT = (OSError, ValueError, LookupError, RuntimeError, TypeError, ArithmeticError, MemoryError, EOFError, zipfile.BadZipFile)
TEXTS = (".toml", ".json", ".jsonl", ".pddl", ".txt", ".xml")


def spoil(rng: Random, folder: Path) -> None:
    """Change one or a few of the files in a folder."""
    files = sorted(p for p in folder.rglob("*") if p.is_file())
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        path = rng.choice(files)
        if path.is_file() and not path.is_symlink():
            _spoil_kind(rng, path) if rng.random() < 0.04 else _spoil_file(rng, path)


def _spoil_kind(rng: Random, path: Path) -> None:
    """Something else where a file is expected."""
    content = path.read_bytes()
    path.unlink()
    match rng.randrange(8):
        case 0:
            path.mkdir()
        case 1:
            os.mkfifo(path)
        case 2:
            path.symlink_to(path.name)
        case 3:
            path.symlink_to("/dev/zero")
        case 4:
            path.write_bytes(b"")
        case 5:
            path.write_bytes(content * 20)
        case 6:
            path.write_bytes(content.decode("latin-1").encode("utf-16"))
        case _:
            pass  # it is gone


def _spoil_file(rng: Random, path: Path) -> None:
    content = path.read_bytes()
    by_suffix: dict[str, tuple[Callable[[Random, bytes], bytes], ...]] = {
        ".json": (_json, _json, _text, _bytes),
        ".jsonl": (_json_line, _json_line, _text, _bytes),
        ".hdf5": (_hdf5, _hdf5, _hdf5, _bytes),
        ".npz": (_npz, _npz, _bytes),
        ".gz": (_gz, _gz, _bytes),
        ".parquet": (_bytes,),
    }
    ways = by_suffix.get(path.suffix, (_text, _text, _text, _bytes) if path.suffix in TEXTS else (_bytes,))
    # bytes come last: the libraries that change what is inside do not survive every file themselves
    for way in sorted(rng.choices(ways, k=rng.choice((1, 1, 2, 4))), key=lambda way: way is _bytes):
        try:
            content = way(rng, content)
        except _SPOILT:
            content = _bytes(rng, content)  # already too far gone for its own kind
    path.write_bytes(content)


def _bytes(rng: Random, content: bytes) -> bytes:
    if not content:
        return rng.randbytes(rng.randrange(1, 100))
    changed = bytearray(content)
    at, n = rng.randrange(len(changed)), rng.choice((1, 1, 2, 4, 8, 64))
    match rng.randrange(6):
        case 0:
            changed[at] ^= 1 << rng.randrange(8)
        case 1:
            changed[at : at + n] = rng.randbytes(n)
        case 2:
            changed[at : at + n] = rng.choice((b"\xff", b"\0", b"\x7f", b"\x80")) * n
        case 3:
            del changed[at : at + n]
        case 4:
            changed[at:at] = changed[at : at + 8 * n]
        case _:
            del changed[at:]
    return bytes(changed)


def _text(rng: Random, content: bytes) -> bytes:
    text = content.decode("utf-8", "replace")
    tokens = re.findall(r"[\w.?:-]+|\s+|.", text, re.DOTALL) or [""]
    at = rng.randrange(len(tokens))
    match rng.randrange(7):
        case 0:
            tokens[at] = rng.choice(WORDS)
        case 1:
            tokens.insert(at, rng.choice(WORDS))
        case 2:
            del tokens[at : at + rng.choice((1, 1, 2, 8, 40))]
        case 3:
            tokens[at:at] = tokens[at : at + rng.choice((1, 4, 16, 64))]
        case 4:
            tokens[at] = rng.choice(tokens)
        case 5:
            words = [i for i, token in enumerate(tokens) if token.strip()]
            tokens[rng.choice(words or [0])] = rng.choice(WORDS)
        case _:
            numbers = [i for i, token in enumerate(tokens) if token[:1].isdigit()]
            tokens[rng.choice(numbers or [at])] = rng.choice(NUMBERS)
    return "".join(tokens).encode("utf-8", "surrogatepass")


def _json(rng: Random, content: bytes) -> bytes:
    return json.dumps(_changed(rng, json.loads(content)), ensure_ascii=rng.random() < 0.5).encode("utf-8", "surrogatepass")


def _json_line(rng: Random, content: bytes) -> bytes:
    lines = content.split(b"\n")
    at = rng.randrange(len(lines))
    match rng.randrange(6):
        case 0:
            lines[at:at] = lines[at : at + 2]
        case 1:
            del lines[at]
        case 2:
            rng.shuffle(lines)
        case _:
            lines[at] = _json(rng, lines[at])
    return b"\n".join(lines)


def _changed(rng: Random, value: Any) -> Any:
    """The value with something changed somewhere in it."""
    if isinstance(value, dict) and value and rng.random() < 0.9:
        key = rng.choice(list(value))
        match rng.randrange(8):
            case 0:
                return {k: v for k, v in value.items() if k != key}
            case 1:
                return {**value, rng.choice(("", "a" * 300, "\x1b", "x")): value[key]}
            case _:
                return {**value, key: _changed(rng, value[key])}
    if isinstance(value, list) and value and rng.random() < 0.9:
        at = rng.randrange(len(value))
        match rng.randrange(8):
            case 0:
                return value[:at] + value[at + 1 :]
            case 1:
                return value[: at + 1] + value[at:]
            case _:
                return [*value[:at], _changed(rng, value[at]), *value[at + 1 :]]
    if isinstance(value, str) and rng.random() < 0.5:
        return _text(rng, value.encode("utf-8", "replace")).decode("utf-8", "surrogatepass")
    return rng.choice(VALUES)


def _gz(rng: Random, content: bytes) -> bytes:
    inside = gzip.decompress(content)
    return gzip.compress(_text(rng, inside) if rng.random() < 0.9 else inside + bytes(100_000_000), 1)


def _npz(rng: Random, content: bytes) -> bytes:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    name = rng.choice(sorted(members))
    match rng.randrange(5):
        case 0:
            del members[name]
        case 1:
            members[name] = _bytes(rng, members[name])
        case 2:
            members[name] = members[name][:128].replace(b"(", rng.choice((b"(9", b"(-", b"((", b"(1,"))) + members[name][128:]
        case _:
            array = np.load(io.BytesIO(members[name]), allow_pickle=False)
            buffer = io.BytesIO()
            np.save(buffer, _array(rng, array))
            members[name] = buffer.getvalue()
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", rng.choice((0, 0, 8, 14))) as archive:
        for key, value in members.items():
            archive.writestr(key, value)
    return out.getvalue()


def _array(rng: Random, array: Any) -> Any:
    changed = np.array(array)
    match rng.randrange(8):
        case 0 if changed.size and changed.dtype.kind == "f":
            changed.flat[rng.randrange(changed.size)] = rng.choice((math.nan, math.inf, -1e308, 0.0, 5e-324, -1.0, 1e12))
        case 1:
            changed = changed[..., :-1] if changed.ndim else changed.reshape(1)
        case 2:
            changed = np.repeat(changed, 2, axis=0) if changed.ndim else changed
        case 3:
            changed = changed * 0 if changed.dtype.kind in "fiu" else changed
        case 4:
            changed = (
                changed.astype(rng.choice(("f2", "i1", "u8", "c16", "S3", "U2"))) if changed.dtype.kind in "fiu" else changed
            )
        case 5:
            changed = changed.reshape(-1)
        case 6:
            changed = changed[:0] if changed.ndim else changed
        case _:
            changed = -changed if changed.dtype.kind == "f" else changed
    return changed


def _hdf5(rng: Random, content: bytes) -> bytes:
    buffer = io.BytesIO(content)
    with h5py.File(buffer, "r+") as file:
        names: list[str] = []
        file.visit(names.append)
        name = rng.choice(names)
        node = file[name]
        way = rng.randrange(10)
        if way < 4 and len(node.attrs):
            key = rng.choice(sorted(node.attrs))
            old = node.attrs[key]
            del node.attrs[key]
            if way == 0 or not isinstance(old, str):
                node.attrs[key] = rng.choice(
                    ("", "{}", "[]", "é", -1, 1e308, math.nan, [1, 2], 2**60, b"\xff", "a" * 3000, h5py.Empty("f8"))
                )
            elif way < 3:
                changed = (_json if old[:1] in ("{", "[") else _text)(rng, old.encode())
                node.attrs[key] = changed.decode("utf-8", "replace").replace("\0", "")
        elif way < 7 and isinstance(node, h5py.Dataset):
            if node.size > 1_000_000:
                return content
            array, attributes = node[...], dict(node.attrs)
            del file[name]
            made = file.create_dataset(name, data=_array(rng, array), **rng.choice(({}, {"compression": "gzip", "chunks": True})))
            made.attrs.update(attributes)
        else:
            _link(rng, file, name)
    return buffer.getvalue()


def _link(rng: Random, file: Any, name: str) -> None:
    above = file[name].parent
    other = rng.choice(("x", "demo_9", "demo_²", "demo_" + "9" * 5000, "a b", "\x1b", ".", "é"))
    match rng.randrange(7):
        case 0:
            del file[name]
        case 1:
            above[other] = h5py.SoftLink(rng.choice((f"/{name}", "/", ".", "..", other, "/gone")))
        case 2:
            above[other] = h5py.ExternalLink(SECRET, "/")
        case 3:
            above[other] = above
        case 4:
            above[other] = file[name]
        case 5:
            above.move(name.rsplit("/", 1)[-1], other)
        case _:
            del file[name]
            file.create_dataset(name, rng.choice(((10**9, 7), (10**6,), (0, 7), (3, 7), ())), rng.choice(("f8", "i1", "f4")))


def copy(seed: Path, folder: Path) -> None:
    """A fresh copy of the files that are right."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(seed, folder, symlinks=True)
