"""Running a planner that is a program: no shell, limits on time, memory and output, and no process of it left behind."""

from __future__ import annotations

import contextlib
import os
import resource
import select
import signal
import subprocess
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from symskill_pddl.errors import InputError
from symskill_pddl.planning.protocol import Limits

_GRACE_S = 0.5
"""Between asking a program to end and ending it."""
_OUTPUT_BYTES = 50_000_000


def run(
    words: Sequence[str], folder: Path, output: Path, limits: Limits, *, time_s: float, stdin: Path | None = None
) -> int | None:
    """Exit status, or None where the time ran out.

    The program gets a session of its own, and whatever still runs in it when the program ends is ended with it: killing only
    the program that was started would leave the search of a driver running.

    Parameters
    ----------
    output : Path
        Takes what the program prints, errors included.
    time_s : float
        Wall-clock time [s]; of `limits` only the memory is used.

    Raises
    ------
    InputError
        The program cannot be started.
    """
    if time_s <= 0.0:
        return None
    with output.open("wb") as stream, (stdin or Path(os.devnull)).open("rb") as source:
        try:
            process = subprocess.Popen(
                words,
                cwd=folder,
                stdin=source,
                stdout=stream,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                # before the program begins: set from outside, the limits came too late for a quick one
                preexec_fn=partial(_limit, limits.memory_mb * 1024 * 1024),
            )
        except OSError as error:
            raise InputError(f"cannot run the planner '{words[0]}': {error.strerror}") from None
        try:
            try:
                return _wait(process, time_s)
            except subprocess.TimeoutExpired:
                _signal(process.pid, signal.SIGTERM)
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(_GRACE_S)
                return None
        finally:
            _signal(process.pid, signal.SIGKILL)
            process.wait()


def _limit(memory_bytes: int) -> None:
    """In the child: bounds on the address space and on what is written."""
    for kind, bound in ((resource.RLIMIT_AS, memory_bytes), (resource.RLIMIT_FSIZE, _OUTPUT_BYTES)):
        hard = resource.getrlimit(kind)[1]
        least = bound if hard == resource.RLIM_INFINITY else min(bound, hard)
        resource.setrlimit(kind, (least, least))


def _wait(process: subprocess.Popen[bytes], time_s: float) -> int:
    """As `process.wait`, which looks every 50 ms; where the kernel can tell, this wakes up at once."""
    if not hasattr(os, "pidfd_open"):
        return process.wait(time_s)
    try:
        ended = os.pidfd_open(process.pid)
    except OSError:
        return process.wait(time_s)
    try:
        if not select.select([ended], [], [], time_s)[0]:
            raise subprocess.TimeoutExpired(process.args, time_s)
    finally:
        os.close(ended)
    return process.wait()


def last_line(output: Path) -> str:
    """What the program said last, for a message."""
    printed = output.read_text(encoding="utf-8", errors="replace") if output.exists() else ""
    return (printed.strip().splitlines() or ["nothing"])[-1].strip()


def _signal(group: int, number: signal.Signals) -> None:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(group, number)
