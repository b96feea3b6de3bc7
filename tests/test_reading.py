"""Somebody else's files: bounded, and one clear error for each kind of fault."""

import json
import math
import os
import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel

from symskill_pddl.errors import FormatError, InputError
from symskill_pddl.reading import number, parse_json, parse_toml, read_bytes, read_text, validated, whole


@pytest.mark.parametrize(
    ("content", "text"),
    [(b"\xef\xbb\xbfa\r\nb\rc\n", "a\nb\nc\n"), (b"", ""), ("é".encode(), "é")],
)
def test_a_text_without_its_mark_and_with_one_kind_of_line_end(tmp_path, content, text):
    (tmp_path / "file").write_bytes(content)
    assert read_text(tmp_path / "file", "domain") == text


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("text".encode("utf-16"), "UTF-16"),
        (b"ab\xff", r"not UTF-8 text \(byte 2\)"),
        (b"ab\0c", "NUL"),
        (b"12345678901", "longer than 10 bytes"),
    ],
)
def test_a_text_that_is_none(tmp_path, content, message):
    (tmp_path / "file").write_bytes(content)
    with pytest.raises(InputError, match=f"file.*{message}"):
        read_text(tmp_path / "file", "domain", limit=10)


def test_what_is_no_file(tmp_path):
    (tmp_path / "loop").symlink_to("loop")
    for path, message in (
        (tmp_path / "none", "there is no domain"),
        (tmp_path, "is a folder"),
        (tmp_path / "loop", "cannot read the domain"),
        (tmp_path / ("a" * 300), "cannot read the domain"),
        ("/dev/zero", "is a device"),
        (f"{tmp_path}/a\0b", "cannot read the domain"),
    ):
        with pytest.raises(InputError, match=message):
            read_bytes(path, "domain")


def test_a_file_that_may_not_be_read(tmp_path, monkeypatch):
    def refused(*_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "open", refused)
    with pytest.raises(InputError, match=r"cannot read the domain .*Permission denied"):
        read_bytes(tmp_path / "file", "domain")


def test_a_pipe_without_a_writer_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("symskill_pddl.reading.PIPE_BEGIN_S", 0.0)
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match="nobody writes to"):
        read_bytes(tmp_path / "pipe", "domain")


def test_a_pipe_with_a_writer_is_read_to_its_end(tmp_path):
    reading, writing = os.pipe()

    def write():
        with os.fdopen(writing, "wb") as end:
            end.write(b"x" * 300_000)

    writer = threading.Thread(target=write)
    writer.start()
    assert read_bytes(f"/dev/fd/{reading}", "domain") == b"x" * 300_000
    writer.join()
    os.close(reading)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[" * 100_000, "nested too deeply"),
        ('{"a":' * 100_000, "nested too deeply"),
        ("9" * 5000, "5000 digits"),
        ("[NaN]", "NaN is no number"),
        ("[-Infinity]", "-Infinity is no number"),
        ("1e999", "out of range"),
        ("1." + "0" * 10_000, "out of range"),
        ('"\\ud800"', "no Unicode"),
        ("", "is no JSON: .*line 1, column 1"),
        (b"\xff", "no Unicode"),
    ],
)
def test_json_that_is_none(text, message):
    with pytest.raises(FormatError, match=f"^some file: .*{message}") as caught:
        parse_json(text, "some file")
    assert len(str(caught.value)) < 200


@given(
    st.recursive(
        st.none() | st.booleans() | st.integers(-(10**17), 10**17) | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
        lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    )
)
def test_json_that_is_one_is_read_as_it_was_written(value):
    assert parse_json(json.dumps(value), "x") == value
    assert parse_json(json.dumps(value).encode(), "x") == value


class _Part(BaseModel):
    n: int


def test_a_field_that_is_wrong_is_named():
    assert validated(_Part.model_validate, '{"n": 1}', "file") == _Part(n=1)
    with pytest.raises(FormatError, match=r"^file: n: Input should be"):
        validated(_Part.model_validate, '{"n": []}', "file")


@given(st.text())
def test_number_and_whole_never_raise(text):
    for read in (number, whole):
        value = read(text)
        assert value is None or math.isfinite(value)


@given(st.floats(allow_nan=False, allow_infinity=False), st.integers(0, 10**18 - 1))
def test_numbers_are_read_as_they_were_written(real, count):
    assert number(repr(real)) == real
    assert whole(str(count)) == count


@pytest.mark.parametrize("text", ["", "1.2.3", "nan", "inf", "1e999", "9" * 500, "²", "٣", "1_0", " 1", "0x1"])
def test_what_is_no_number(text):
    assert number(text) is None
    assert whole(text) is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a =", "is no TOML"),
        ("a = " + "[" * 5000, "is nested too deeply|is no TOML"),
        ("a = " + "9" * 5000, "is no TOML"),
        ("a = 99999999999999999999", "more than 18 digits"),
        ("a = nan", "the number nan is out of range"),
        ("a = 1e999", "out of range"),
    ],
)
def test_toml_that_is_none(text, message):
    with pytest.raises(FormatError, match=f"^some file: .*({message})") as caught:
        parse_toml(text, "some file")
    assert len(str(caught.value)) < 300
    assert parse_toml("a = 1_000\nb = 1.5", "x") == {"a": 1000, "b": 1.5}
