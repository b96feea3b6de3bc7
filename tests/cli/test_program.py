"""What holds for the program as a whole."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from symskill_pddl import __version__
from symskill_pddl.cli import app as program
from symskill_pddl.errors import InputError, NoPlanError

COMMANDS = (
    "quickstart",
    "record",
    "import",
    "learn",
    "show",
    "export",
    "problem",
    "planners",
    "plan",
    "check",
    "run",
    "evaluate",
    "replay",
    "report",
)


def test_help_lists_every_command() -> None:
    done = subprocess.run([sys.executable, "-m", "symskill_pddl.cli", "--help"], capture_output=True, text=True, check=True)
    listed = [line.split()[0] for line in done.stdout.splitlines() if line.startswith("  ") and line.split()]
    assert [name for name in COMMANDS if name not in listed] == []


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys; from symskill_pddl.cli import main; print([m for m in ('numpy', 'jinja2', 'pydantic') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help(symskill: Callable[..., Any], command: str) -> None:
    done = symskill(command, "--help")
    assert done.status == 0
    assert "Usage: symskill" in done.out


def test_version(symskill: Callable[..., Any]) -> None:
    assert symskill("--version").out == f"symskill {__version__}\n"


@pytest.mark.parametrize(
    "arguments", [("nonsense",), ("plan",), ("plan", "--nonsense"), ("record", "T", "-n", "many", "-o", "f")]
)
def test_usage_errors_exit_with_2(symskill: Callable[..., Any], arguments: tuple[str, ...]) -> None:
    done = symskill(*arguments)
    assert done.status == 2
    assert done.out == ""


@pytest.mark.parametrize(("error", "status"), [(InputError("a\n  b"), 2), (NoPlanError("a b"), 1)])
def test_errors_are_one_line_and_set_the_status(
    symskill: Callable[..., Any], monkeypatch: pytest.MonkeyPatch, error: Exception, status: int
) -> None:
    def fail(**_: object) -> None:
        raise error

    monkeypatch.setattr(program, "app", fail)
    done = symskill("show", "x")
    assert done.status == status
    assert done.err == "symskill: error: a b\n"


@pytest.fixture
def bug(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """An error in the program, which quotes the user's key."""

    def fail(**_: object) -> None:
        raise ZeroDivisionError("with sk-MADE-UP-123")

    monkeypatch.setattr(program, "app", fail)
    monkeypatch.setenv("SOME_API_KEY", "sk-MADE-UP-123")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))


@pytest.mark.usefixtures("bug")
def test_a_bug_is_one_line_with_the_call_and_the_place_of_its_traceback(symskill: Callable[..., Any], tmp_path: Path) -> None:
    done = symskill("show", "some library")
    assert done.status == 3
    assert "symskill show 'some library'" in done.error
    assert "ZeroDivisionError: with ***" in done.error
    (report,) = tmp_path.glob("symskill-error-*.txt")
    assert str(report) in done.error
    text = report.read_text()
    assert "Traceback" in text
    assert "MADE-UP" not in text
    assert report.stat().st_mode & 0o077 == 0


@pytest.mark.usefixtures("bug")
def test_a_bug_where_nothing_can_be_written_says_how_to_see_it(
    symskill: Callable[..., Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "gone"))
    monkeypatch.setenv("HOME", str(tmp_path / "gone"))
    assert "SYMSKILL_TRACEBACK=1" in symskill("show", "x").error
    monkeypatch.setenv("SYMSKILL_TRACEBACK", "1")
    done = symskill("show", "x")
    assert "Traceback" in done.err
    assert done.error


def test_ctrl_c_is_one_line(symskill: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(**_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(program, "app", fail)
    done = symskill("show", "x")
    assert (done.status, done.error) == (130, "interrupted")


@pytest.mark.parametrize(("where", "status", "said"), [("pipe", 141, ""), ("/dev/full", 2, "No space left"), ("closed", 0, "")])
def test_output_that_goes_nowhere(where: str, status: int, said: str) -> None:
    if where == "/dev/full" and not Path(where).exists():
        pytest.skip("this system has no /dev/full")
    # what --help prints is kept back until the end, the interpreter's own end included
    call = [sys.executable, "-m", "symskill_pddl.cli", "--version"]
    if where == "pipe":
        reading, writing = os.pipe()
        os.close(reading)
        done = subprocess.run(call, stdout=writing, stderr=subprocess.PIPE, text=True, check=False)
        os.close(writing)
    else:
        to = "1>&-" if where == "closed" else f"> {where}"
        done = subprocess.run(
            ["sh", "-c", f'"$@" {to}', "sh", *call], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, check=False
        )
    assert done.returncode == status
    assert said in done.stderr
    assert len(done.stderr.splitlines()) == bool(said)


def test_small_linear_algebra_runs_on_one_thread(tmp_path: Path) -> None:
    code = "import os; from symskill_pddl.cli import main\ntry: main()\nexcept SystemExit: print(os.environ['OMP_NUM_THREADS'])"
    environment = {"PATH": str(Path(sys.executable).parent), "HOME": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", code, "--version"], capture_output=True, text=True, check=True, env=environment)
    assert done.stdout.split()[-1] == "1"


def test_planners_as_json_is_one_document(symskill: Callable[..., Any]) -> None:
    done = symskill("planners", "--json")
    listed = json.loads(done.out)
    assert {"builtin", "pyperplan"} <= {p["name"] for p in listed}
    assert next(p for p in listed if p["name"] == "pyperplan")["licence"] == "GPL-3.0-or-later"


def test_planners_that_are_not_installed_are_named(symskill: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("symskill_pddl.planning.kairos.Kairos.installed", classmethod(lambda cls: False))
    done = symskill("planners")
    assert done.out.split()[4] == "auto"
    assert "kairos; pip install 'symskill-pddl[planners]'" in done.err.replace("not installed: ", "")
