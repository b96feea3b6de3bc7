"""What a program without a terminal is told about the progress."""

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
