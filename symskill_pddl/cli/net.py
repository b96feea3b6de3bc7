"""The last net under every command: whatever happens ends in one line and an exit status, never in a wall of text.

Exit statuses: those of `SymSkillError`; 2 for a wrong call; 3 for an error of ours, whose traceback is in a file that the line
names; 130 after Ctrl-C; 141 where nobody reads our output any more, as a program that the system ends for it.
"""

from __future__ import annotations

import os
import platform
import re
import shlex
import sys
import tempfile
import traceback
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import typer

from symskill_pddl.cli.console import ClosedError, OutputError, complain, remark
from symskill_pddl.errors import SymSkillError, shown

BUG, INTERRUPTED, CLOSED = 3, 130, 141
SHOW = "SYMSKILL_TRACEBACK"
"""Environment variable: if it is set, the traceback of an error of ours is also shown."""
_SECRET = re.compile(r"KEY|TOKEN|SECRET|PASSWORD")
# typer has click inside and does not export the base of what a wrong call raises
_WrongCallError: type[Exception] = typer.BadParameter.__mro__[2]


def caught(command: Callable[[], object]) -> int:
    """Run a command to its exit status; what it raises becomes one line."""
    _open_streams()
    try:
        status = command()
        _flush()
        return status if isinstance(status, int) else 0
    except SymSkillError as error:
        complain(str(error))
        return error.exit_status
    except _WrongCallError as error:
        _say_wrong_call(error)
        return 2
    except (KeyboardInterrupt, typer.Abort):
        complain("interrupted")
        return INTERRUPTED
    except (ClosedError, BrokenPipeError):
        return CLOSED
    except Exception as error:  # noqa: BLE001 - this is the net
        return _bug(error)
    finally:
        _forget_output()


def _say_wrong_call(error: Any) -> None:
    """What is wrong with the call, and how to learn what is right; to one without any argument, all that can be called."""
    if "\n" in (message := error.format_message()):
        remark(message)
    else:
        path = error.ctx.command_path if error.ctx is not None else "symskill"
        complain(f"{message} (see {path} --help)")


def _bug(error: Exception) -> int:
    """An error that nothing here expects: the line says of what call, and where the traceback is."""
    call = shown(shlex.join(["symskill", *sys.argv[1:]]), 200)
    text = "".join(traceback.format_exception(error))
    report = _without_secrets(f"{call}\nPython {platform.python_version()}, {platform.platform()}\n\n{text}")
    if os.environ.get(SHOW):
        remark(report)
    place = _kept(report)
    told = f"the traceback is in {place}" if place else f"set {SHOW}=1 to see the traceback"
    what = _without_secrets(f"{type(error).__name__}: {shown(error, 160)}")
    complain(f"{call}: an error of ours, please report it ({told}): {what}")
    return BUG


def _kept(report: str) -> str | None:
    """Path of a new file, readable by its owner alone, with the report; None where nothing can be written."""
    for folder in (None, os.environ.get("HOME")):
        with suppress(OSError):
            descriptor, path = tempfile.mkstemp(prefix="symskill-error-", suffix=".txt", dir=folder)
            with os.fdopen(descriptor, "w", encoding="utf-8", errors="backslashreplace") as file:
                file.write(report)
            return path
    return None


def _without_secrets(text: str) -> str:
    """The text without the values of environment variables that are called keys."""
    for name, value in os.environ.items():
        if _SECRET.search(name) and len(value) >= 6:
            for form in (value, ascii(value)[1:-1], value.encode("unicode_escape").decode()):
                text = text.replace(form, "***")
    return text


def _open_streams() -> None:
    """Standard streams that were closed lead nowhere, and no character makes one fail."""
    for name in ("stdin", "stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, Path(os.devnull).open("r" if name == "stdin" else "w", encoding="utf-8"))  # noqa: SIM115
        elif name != "stdin" and hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


def _flush() -> None:
    """Find out while it can be told that the output did not get where it should."""
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        raise ClosedError from None
    except OSError as error:
        raise OutputError(f"cannot write to standard output: {error.strerror or error}") from None


def _forget_output() -> None:
    """What cannot be written goes nowhere, else the interpreter would complain of it at its end."""
    try:
        sys.stdout.flush()
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
