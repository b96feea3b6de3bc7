"""What somebody else wrote, read within bounds: bytes, text, JSON and numbers.

Every reader of the package begins here, so that a folder, a pipe nobody writes to, a file without end, another encoding, a number
of thousands of digits, brackets without end or a NaN is one clear error, whichever file it stands in.
"""

from __future__ import annotations

import codecs
import json
import math
import os
import re
import select
import stat
import time
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

from symskill_pddl.errors import FormatError, InputError, SymSkillError, shown

T = TypeVar("T")

LIMIT = 64_000_000
"""Bytes of a file that is read as a whole; a text takes about ten times as much memory when it is understood."""
PIPE_BEGIN_S, PIPE_SILENCE_S = 1.0, 60.0
"""How long a pipe may be without a writer, and how long a writer may say nothing."""
_DIGITS = 18
"""A whole number of more digits is no count of anything here, and would not fit into 64 bits."""
_FLOAT = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,4})?")
_SURROGATE = re.compile(r"\\u[dD][89a-fA-F]")


def read_bytes(path: str | Path, what: str, *, limit: int = LIMIT) -> bytes:
    """The content of a file that a user named, or of a pipe.

    Parameters
    ----------
    path : str or Path
    what : str
        What the file is to be, for the error: ``domain``.
    limit : int
        Bytes it may have at most.

    Raises
    ------
    InputError
        There is no such file, it is a folder or a device, a pipe without a writer, cannot be read, or is longer than `limit`.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    except FileNotFoundError:
        raise InputError(f"there is no {what} '{path}'") from None
    except IsADirectoryError:
        raise InputError(f"'{path}' is a folder, a {what} is needed") from None
    except (OSError, ValueError) as error:
        raise InputError(f"cannot read the {what} '{path}': {getattr(error, 'strerror', None) or error}") from None
    try:
        mode = os.fstat(descriptor).st_mode
        if stat.S_ISDIR(mode):
            raise InputError(f"'{path}' is a folder, a {what} is needed")
        if not stat.S_ISREG(mode) and not stat.S_ISFIFO(mode):
            raise InputError(f"'{path}' is a device, a {what} is needed")
        content = _piped(descriptor, path, what, limit) if stat.S_ISFIFO(mode) else _whole(descriptor, limit)
    except OSError as error:
        raise InputError(f"cannot read the {what} '{path}': {error.strerror or error}") from None
    finally:
        os.close(descriptor)
    if len(content) > limit:
        raise InputError(f"'{path}' is longer than {limit} bytes, a {what} is not")
    return content


def _whole(descriptor: int, limit: int) -> bytes:
    with os.fdopen(os.dup(descriptor), "rb") as file:
        return file.read(limit + 1)


def _piped(descriptor: int, path: str | Path, what: str, limit: int) -> bytes:
    """All that comes through a pipe; one that nobody has open for writing gives nothing, and would be waited for without end."""
    parts: list[bytes] = []
    begin = time.monotonic()
    while sum(map(len, parts)) <= limit:
        try:
            part = os.read(descriptor, 1 << 20)
        except BlockingIOError:
            if not select.select([descriptor], [], [], PIPE_SILENCE_S)[0]:
                raise InputError(f"'{path}' is a pipe through which no {what} came for {PIPE_SILENCE_S:g} s") from None
            continue
        if part:
            parts.append(part)
        elif parts:
            break
        elif time.monotonic() - begin < PIPE_BEGIN_S:
            time.sleep(0.02)
        else:
            raise InputError(f"'{path}' is a pipe that nobody writes to, a {what} is needed")
    return b"".join(parts)


def read_text(path: str | Path, what: str, *, limit: int = LIMIT) -> str:
    """The text of a file that a user named: UTF-8, with or without a byte order mark, line ends of any system as ``\\n``.

    Raises
    ------
    InputError
        As `read_bytes`; it is in another encoding, or holds a NUL character.
    """
    content = read_bytes(path, what, limit=limit)
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise InputError(f"'{path}' is UTF-16 and not UTF-8 text, a {what} is needed")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"'{path}' is not UTF-8 text (byte {error.start}), a {what} is needed") from None
    if "\0" in text:
        raise InputError(f"'{path}' holds a NUL character, a {what} is needed")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def parse_json(text: str | bytes, where: str) -> Any:
    """The value of a JSON document, all of whose numbers are finite.

    Parameters
    ----------
    text : str or bytes
    where : str
        Stands at the head of an error: ``'results.json'``.

    Raises
    ------
    FormatError
        It is no JSON, nested too deeply, or holds NaN, infinity, a number of very many digits, or half a character.
    """
    try:
        value = json.loads(
            text.decode("utf-8-sig") if isinstance(text, bytes) else text,
            parse_constant=_no_constant,
            parse_float=_finite,
            parse_int=_integer,
        )
        # a lone surrogate could be printed and written nowhere
        if _SURROGATE.search(text if isinstance(text, str) else text.decode("latin-1")):
            json.dumps(value, ensure_ascii=False).encode()
    except json.JSONDecodeError as error:
        raise FormatError(f"{where}: is no JSON: {error.msg} (line {error.lineno}, column {error.colno})") from None
    except RecursionError:
        raise FormatError(f"{where}: is nested too deeply") from None
    except UnicodeError:
        raise FormatError(f"{where}: holds a text that is no Unicode") from None
    except _NumberError as error:
        raise FormatError(f"{where}: {error}") from None
    return value


def parse_toml(text: str, where: str) -> dict[str, Any]:
    """The tables of a TOML document, all of whose numbers are finite; raises `FormatError` as `parse_json`."""
    try:
        found = tomllib.loads(text, parse_float=lambda digits: _finite(digits.replace("_", "")))
        if any(abs(n) >= 10**_DIGITS for n in _whole_numbers(found)):
            raise _NumberError(f"a number has more than {_DIGITS} digits")
        return found
    except RecursionError:
        raise FormatError(f"{where}: is nested too deeply") from None
    except (ValueError, _NumberError) as error:  # also what int() says of thousands of digits
        raise FormatError(f"{where}: is no TOML: {shown(error, 160)}") from None


def _whole_numbers(value: Any) -> Iterator[int]:
    if isinstance(value, int):
        yield value
    elif isinstance(value, dict | list):
        for part in value.values() if isinstance(value, dict) else value:
            yield from _whole_numbers(part)


def validated(valid: Callable[[Any], T], text: str | bytes, where: str) -> T:
    """A JSON document as `valid` has it, which is a pydantic model's or adapter's function.

    Raises
    ------
    FormatError
        As `parse_json`; a field is missing or wrong, and named.
    """
    from pydantic import ValidationError

    value = parse_json(text, where)
    try:
        return valid(value)
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False, include_input=False)[0]
        at = shown(".".join(map(str, first["loc"])), 100)
        raise FormatError(f"{where}: {at}{': ' if at else ''}{first['msg']}") from None
    except SymSkillError as error:
        raise FormatError(f"{where}: {error}") from None
    except RecursionError:
        raise FormatError(f"{where}: is nested too deeply") from None


def number(text: str) -> float | None:
    """The finite number that a text is, in decimal or scientific notation; None if it is none."""
    value = float(text) if len(text) <= 400 and _FLOAT.fullmatch(text) else math.inf
    return value if math.isfinite(value) else None


def whole(text: str) -> int | None:
    """The number, not negative and of at most 18 digits, that a text is; None if it is none."""
    return int(text) if len(text) <= _DIGITS and text.isascii() and text.isdigit() else None


class _NumberError(Exception):
    pass


def _no_constant(text: str) -> Any:
    raise _NumberError(f"{text} is no number of JSON")


def _finite(text: str) -> float:
    value = number(text)
    if value is None:
        raise _NumberError(f"the number {shown(text, 40)} is out of range")
    return value


def _integer(text: str) -> int:
    if len(text) > _DIGITS + 1:
        raise _NumberError(f"a number has {len(text)} digits")
    return int(text)
