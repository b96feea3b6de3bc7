"""What holds for the program as a whole."""

import json
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


def test_a_bug_is_not_hidden(symskill: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(**_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(program, "app", fail)
    with pytest.raises(ZeroDivisionError):
        symskill("show", "x")


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
