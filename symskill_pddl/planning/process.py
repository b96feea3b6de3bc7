"""Running a planner that is a program: no shell, bounds on time, memory, processes, disk and output, and nothing of it is left.

Between us and the program stands `supervisor.py`, a process of its own, so that the program ends with us whatever ends us.
"""

from __future__ import annotations

import os
import re
import secrets
import shutil
import signal
import stat
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import mkdtemp

from symskill_pddl.errors import InputError, shown
from symskill_pddl.planning.protocol import Limits

_GRACE_S = 0.5
_GRACE_PART = 0.05
"""Between asking a program to end and ending it: this part of its time, and so many seconds at most."""
_PATIENCE_S, _LONG_S = 10.0, 1e6
"""With the process that watches, after its time; a call of so many seconds is waited for without end."""
_PROCESSES = 256
_FILE_BYTES = 50_000_000
_FOLDER_BYTES = 200_000_000
_TEXT_BYTES = 1_000_000
"""Of what is printed the last, and of a plan file the first: a plan of that length has more than ten thousand steps."""
_PLANS = 20
"""Of numbered plan files the last."""
_SUPERVISOR = (sys.executable, "-I", "-S", str(Path(__file__).with_name("supervisor.py")))
_MARK = "SYMSKILL_PLANNER"
"""In the environment of a program and of all that it starts, with a value of the call's own."""


@dataclass(frozen=True)
class Ended:
    """How a program ended.

    Attributes
    ----------
    status : int or None
        Exit status, the negative number of a signal; None where it was ended for passing a bound.
    stopped : str
        The bound that it passed, in words; empty where it ended by itself.
    output : str
        What it printed, errors included; of more than a million bytes the last.
    printed : int
        How much it printed [bytes].
    """

    status: int | None
    stopped: str
    output: str
    printed: int = 0

    @property
    def out_of_time(self) -> bool:
        return self.stopped.startswith("the time limit")

    @property
    def last_line(self) -> str:
        """What it said last, for a message."""
        return shown((self.output.strip().splitlines() or ["nothing"])[-1])


@contextmanager
def work_folder() -> Iterator[Path]:
    """A temporary folder for a program, removed afterwards whatever the program made in it."""
    try:
        folder = Path(mkdtemp(prefix="symskill-")).resolve()
    except OSError as error:
        raise InputError(f"cannot make a temporary folder for a planner: {error.strerror or error}") from None
    try:
        yield folder
    finally:
        try:
            shutil.rmtree(folder, onerror=_open_and_remove)
        except (OSError, RecursionError):  # folders a thousand deep
            subprocess.run(["rm", "-rf", "--", str(folder)], stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)


def run(words: Sequence[str], folder: Path, limits: Limits, *, time_s: float, stdin: Path | None = None) -> Ended:
    """Run a program in a folder until it ends or passes a bound; then end whatever it started that still runs.

    Parameters
    ----------
    folder : Path
        From `work_folder`; also for the program's temporary files. It is removed where this process is ended meanwhile.
    time_s : float
        Wall-clock time [s]; of `limits` only the memory is used, for each process and for all together.

    Raises
    ------
    InputError
        The program cannot be started.
    """
    out_of_time = f"the time limit of {limits.time_s:g} s passed"
    if time_s <= 0.0:
        return Ended(None, out_of_time, "")
    if os.name != "posix":
        raise InputError(f"cannot run the planner '{words[0]}': planners that are programs need Linux or macOS")
    memory = limits.memory_mb * 1024 * 1024
    grace_s = min(_GRACE_S, _GRACE_PART * time_s)
    bounds = (os.getpid(), time.monotonic() + time_s, grace_s, memory, _PROCESSES, _FILE_BYTES, _FOLDER_BYTES, _TEXT_BYTES)
    call = [*map(str, bounds), str(folder), str(stdin or os.devnull), *words]
    what, number, printed, output = _supervised(call, folder, 1.1 * time_s + _PATIENCE_S if time_s < _LONG_S else None)
    if what == "refused":
        raise InputError(f"cannot run the planner '{words[0]}': {os.strerror(number)}")
    stopped = {
        "ended": "",
        "time": out_of_time,
        "memory": f"its processes used more than {limits.memory_mb} MiB of memory",
        "processes": f"it ran more than {_PROCESSES} processes at once",
        "disk": f"it wrote more than {_FOLDER_BYTES // 1_000_000} MB or ten thousand files",
        "lost": "the process that watched it was ended",
    }[what]
    return Ended(None if stopped else number, stopped, output.decode("utf-8", errors="replace"), printed)


def watched(words: Sequence[str]) -> list[str]:
    """A call of a program that asks and answers through pipes, such that all that it starts ends with it, and it with us.

    The process that is started is not the program but watches it: `terminate` ends both, `kill` leaves what the program started.
    """
    return [*_SUPERVISOR, "keep", str(os.getpid()), *words]


def _supervised(call: list[str], folder: Path, patience_s: float | None) -> tuple[str, int, int, bytes]:
    """The supervisor's report: what happened, a number, the bytes printed and the last of them."""
    mark = f"{os.getpid()}-{secrets.token_hex(8)}"
    control, held = os.pipe()
    try:
        process = subprocess.Popen(
            [*_SUPERVISOR, "run", *call],
            stdin=control,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            env={**os.environ, "TMPDIR": str(folder), _MARK: mark},
        )
    except OSError as error:
        os.close(held)
        raise InputError(f"cannot start the process that watches a planner: {error.strerror}") from None
    finally:
        os.close(control)
    report = b""
    overdue = False
    try:
        report, _ = process.communicate(timeout=patience_s)
    except subprocess.TimeoutExpired:  # it was stopped, or the machine is very busy
        overdue = True
    finally:
        os.close(held)  # the supervisor ends at that, if it has not ended already
        if process.poll() is None:
            with suppress(subprocess.TimeoutExpired):
                process.wait(1.0)
        if process.returncode != 0 or not report:  # the planner may have ended or stopped it
            process.kill()
            process.wait()
            _sweep(f"{_MARK}={mark}".encode())
        if process.stdout is not None:
            process.stdout.close()
    first, _, output = report.partition(b"\n")
    if overdue:
        return "time", 0, 0, b""
    if process.returncode != 0 or not first:
        return "lost", 0, 0, b""
    what, number, printed = first.split()
    return what.decode(), int(number), int(printed), output


def _sweep(mark: bytes) -> None:
    """End every process with a mark in its environment, where the system shows environments."""
    for _ in range(100):
        found = [path for path in Path("/proc").glob("[0-9]*/environ") if mark in _environment(path).split(b"\0")]
        if not found:
            return
        for path in found:
            with suppress(OSError):
                os.kill(int(path.parent.name), signal.SIGKILL)
        time.sleep(0.02)


def _environment(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError:
        return b""


def plan_files(folder: Path, name: str) -> tuple[str, ...]:
    """Texts of the plan files in a program's folder: the one of that name first, then those with numbers, the newest last.

    A program may make anything there. Only regular files are read, and links to them within the folder; FIFOs, devices, folders
    and links that lead elsewhere are passed over.
    """
    stem = name.partition(".")[0]
    numbered = re.compile(rf"{re.escape(name)}|({re.escape(name)}|{re.escape(stem)})[._-]?(?P<number>[0-9].*)")
    with suppress(OSError):  # the program may have locked its folder, or removed it
        folder.chmod(0o700)
    found = (
        ([int(digits) for digits in re.findall(r"[0-9]{1,18}", match["number"] or "")], path.name, text)
        for path in _within(folder)
        if (match := numbered.fullmatch(path.name)) and (text := _text(path, folder))
    )
    return tuple(text for _, _, text in sorted(found)[-_PLANS:])


def _within(folder: Path) -> list[Path]:
    try:
        return list(folder.iterdir())
    except OSError:
        return []


def _text(path: Path, folder: Path) -> str:
    """The beginning of a regular file; empty where it is none."""
    try:
        path = path.resolve(strict=True)
        if not path.is_relative_to(folder.resolve()):
            return ""
        # not blocking, for a FIFO that takes the file's place between two looks
        with open(os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW), "rb") as file:  # noqa: PTH123
            regular = stat.S_ISREG(os.fstat(file.fileno()).st_mode)
            return file.read(_TEXT_BYTES).decode("utf-8", errors="replace") if regular else ""
    except (OSError, RuntimeError):  # RuntimeError: a loop of links
        return ""


def _open_and_remove(_function: object, path: str, _error: object) -> None:
    """For `rmtree`: what a program made unreadable is made readable, and removed."""
    with suppress(OSError):
        Path(path).parent.chmod(0o700)
        if Path(path).is_dir() and not Path(path).is_symlink():
            Path(path).chmod(0o700)
            shutil.rmtree(path, ignore_errors=True)
        else:
            Path(path).unlink()
