"""What a program without a terminal is told about the progress."""

import json
import time

import pytest

from symskill_pddl.cli import console


def test_what_is_done_at_once_is_not_announced(capsys: pytest.CaptureFixture[str]) -> None:
    with console.progress("baking"):
        pass
    assert capsys.readouterr().err == ""


def test_what_takes_long_is_announced_once(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(console, "PATIENCE_S", 0.01)
    with console.progress("baking") as advance:
        deadline = time.monotonic() + 10.0
        told = ""
        while not told and time.monotonic() < deadline:
            advance(1)
            told += capsys.readouterr().err
            time.sleep(0.01)
    assert told + capsys.readouterr().err == "baking\n"


def test_an_error_gets_through_without_an_announcement(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError, match="burnt"), console.progress("baking"):
        raise ValueError("burnt")
    assert capsys.readouterr().err == ""


UNSAFE = "\x1b]52;c;QUJD\x07\x9b31m\u202ename"


def test_nothing_is_printed_that_a_terminal_obeys(capsys: pytest.CaptureFixture[str]) -> None:
    console.say(UNSAFE)
    console.remark(UNSAFE)
    console.complain(UNSAFE)
    console.table(UNSAFE, [UNSAFE], [[UNSAFE]])
    with console.progress(UNSAFE) as advance:
        advance.remark(UNSAFE)
    console.emit_json({"name": UNSAFE})
    said = capsys.readouterr()
    assert not set("\x1b\x07\x9b\u202e") & set(said.out + said.err)
    assert json.loads(said.out[said.out.index("{") :]) == {"name": UNSAFE}


@pytest.mark.parametrize("name", ["x" * 100_000, "'" + "x y " * 50_000 + "'"])
def test_an_error_holds_little_of_somebody_elses_text(capsys: pytest.CaptureFixture[str], name: str) -> None:
    console.complain(f"there is no {name}; the reason comes last")
    line = capsys.readouterr().err
    assert line.count("x") < 300
    assert line.startswith("symskill: error: there is no")
    assert line.endswith("; the reason comes last\n")
