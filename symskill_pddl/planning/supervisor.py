"""A program of its own that runs one planner, bounds what it uses, and leaves no process of it behind.

It is started by `process.run` with a bare interpreter and imports nothing of this package. It stands between us and the planner
because only a process apart outlives ours for the moment that it takes to clear up: whatever ends us, this notices (its control
pipe closes, its parent changes), ends the planner with all its descendants, and removes the planner's folder.

On Linux orphans of the planner become children of this process (a child subreaper), so that a descendant which left the session
with `setsid` is found too. On other systems only the planner's process group is ended. Asked for by position:

    run PARENT DEADLINE GRACE_S MEMORY PROCESSES FILE_BYTES FOLDER_BYTES OUTPUT_BYTES FOLDER STDIN WORD...
    keep PARENT WORD...

`run` says on standard output in a line what happened, a number and the bytes printed, then the last of what the planner printed.
`keep` sets no bounds and leaves its standard streams to the program; all ends on SIGTERM, with the program, or with its parent.
"""

from __future__ import annotations

import os
import resource
import select
import signal
import stat
import sys
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

_LINUX = sys.platform == "linux"
_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36
_LOOK_S = 0.1
"""Between two looks at processes and files; longer where a look takes long, so that looking takes a twentieth of a processor."""
_PATIENCE_S = 5.0
"""For processes that cannot be ended (another user's, or caught in the kernel)."""
_FILES = 10_000


class Job(NamedTuple):
    """What to run, and the bounds."""

    parent: int
    deadline: float
    """On `time.monotonic` [s], which all processes of a machine share."""
    grace_s: float
    memory: int
    """Address space of one process, and resident memory of all of them [bytes]."""
    processes: int
    file_bytes: int
    folder_bytes: int
    output_bytes: int
    folder: str
    stdin: str
    words: list[str]

    @classmethod
    def read(cls, argv: list[str]) -> Job:
        parent, memory, processes, file, folder, output = (int(word) for word in (argv[0], *argv[3:8]))
        deadline, grace_s = float(argv[1]), float(argv[2])
        return cls(parent, deadline, grace_s, memory, processes, file, folder, output, argv[8], argv[9], argv[10:])


def main(argv: list[str]) -> int:
    """Run the program that is asked for; exit status."""
    if _LINUX:
        _prctl(_PR_SET_CHILD_SUBREAPER, 1)
        _prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
    woken, waker = os.pipe()
    for end in (woken, waker):
        os.set_blocking(end, False)
    signal.set_wakeup_fd(waker, warn_on_full_buffer=False)
    for number in (signal.SIGCHLD, signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
        signal.signal(number, lambda *_: None)  # to wake up; the loop looks what it was
    if argv[1] == "keep":
        return keep(int(argv[2]), argv[3:], woken)
    report(Job.read(argv[2:]), woken)
    return 0


def keep(parent: int, words: list[str], woken: int) -> int:
    """Run a program that has its own limits, until it ends or is no longer wanted."""
    program, refused = _start(words, lambda: None)
    if refused:
        return 127
    for stream in (0, 1):  # the program's: who holds the other ends sees when it is gone
        os.close(stream)
    status = None
    while status is None and os.getppid() == parent:
        if select.select([woken], [], [], 5 * _LOOK_S)[0] and signal.SIGTERM in os.read(woken, 4096):
            break
        status = _reaped(program)
    end_all(program)
    if status is not None and status < 0:  # it ended by a signal: so do we
        signal.signal(-status, signal.SIG_DFL) if -status not in (signal.SIGKILL, signal.SIGSTOP) else None
        os.kill(os.getpid(), -status)
    return status or 0


def report(job: Job, woken: int) -> None:
    """Run a planner within its bounds, and say how it went."""
    printed, mouth = os.pipe()
    os.set_blocking(printed, False)
    program, refused = _start(job.words, lambda: _prepare(job, mouth))
    os.close(mouth)
    if refused:
        said = b"refused %d 0\n" % refused
    else:
        watch = Watch(job, program, printed, woken)
        what, status = watch.run()
        end_all(program)
        watch.listen()
        said = b"%s %d %d\n" % (what.encode(), status, watch.total) + b"".join(watch.tail)[-job.output_bytes :]
        if what == "parent":
            _remove(job.folder)
            return
    with suppress(OSError):
        while said:
            said = said[os.write(1, said) :]


class Watch:
    """The planner while it runs: what it prints, and whether it keeps within its bounds."""

    def __init__(self, job: Job, program: int, printed: int, woken: int) -> None:
        self._job, self._program, self._printed, self._woken = job, program, printed, woken
        self._open = [0, woken, printed]
        self.tail: deque[bytes] = deque()
        self.total = self._kept = 0

    def run(self) -> tuple[str, int]:
        """Why it is over, and the exit status (of a planner that ended by itself, or when it was asked to)."""
        job, reason, due, look = self._job, "ended", self._job.deadline, time.monotonic() + _LOOK_S
        while True:
            now = time.monotonic()
            ready = select.select(self._open, [], [], max(0.0, min(due, look) - now))[0]
            if 0 in ready or os.getppid() != job.parent:
                return "parent", 0
            if self._printed in ready and not self._read():
                self._open.remove(self._printed)  # closed: that says nothing about its end
            if self._woken in ready:
                os.read(self._woken, 4096)
            if (status := _reaped(self._program)) is not None:
                return reason, status
            now = time.monotonic()
            if now >= due and reason == "time":
                return reason, 0
            if now >= due:
                reason, due = "time", now + job.grace_s
                with suppress(OSError):
                    os.killpg(self._program, signal.SIGTERM)
            if now >= look:
                if over := beyond(job):
                    return over, 0
                look = time.monotonic() + max(_LOOK_S, 20 * (time.monotonic() - now))

    def listen(self) -> None:
        """What is left in the pipe when all who could write to it have ended."""
        with suppress(BlockingIOError):
            while self._read():
                pass

    def _read(self) -> bool:
        data = os.read(self._printed, 1 << 16)
        self.total += len(data)
        self._kept += len(data)
        self.tail.append(data)
        while self._kept - len(self.tail[0]) >= self._job.output_bytes:
            self._kept -= len(self.tail.popleft())
        return bool(data)


def _start(words: list[str], prepare: Callable[[], None]) -> tuple[int, int]:
    """The program's process number, and the error number where it cannot be started."""
    told, teller = os.pipe()  # closed by a successful exec
    me = os.getpid()
    program = os.fork()
    if program == 0:
        error = 0
        try:
            os.setsid()
            if _LINUX:
                _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
                if os.getppid() != me:
                    os._exit(1)
            for number in (signal.SIGPIPE, signal.SIGXFSZ):
                signal.signal(number, signal.SIG_DFL)
            prepare()
            os.execvp(words[0], words)
        except OSError as failed:
            error = failed.errno or 0
        finally:
            os.write(teller, b"%d" % error)
            os._exit(127)
    os.close(teller)
    said = os.read(told, 20)
    os.close(told)
    return program, int(said or b"0")


def _prepare(job: Job, mouth: int) -> None:
    """In the planner's process: its streams, its folder, its limits."""
    os.dup2(os.open(job.stdin, os.O_RDONLY), 0)
    os.dup2(mouth, 1)
    os.dup2(mouth, 2)
    os.chdir(job.folder)
    _limit(resource.RLIMIT_AS, job.memory)
    _limit(resource.RLIMIT_FSIZE, job.file_bytes)
    _limit(resource.RLIMIT_CORE, 0)


def _limit(kind: int, bound: int) -> None:
    hard = resource.getrlimit(kind)[1]
    least = bound if hard == resource.RLIM_INFINITY else min(bound, hard)
    with suppress(OSError, ValueError):  # a system may know a limit and not take it
        resource.setrlimit(kind, (least, least))


def beyond(job: Job) -> str:
    """Which bound the planner has passed, all of its processes together; empty where none."""
    mine = descendants()
    if len(mine) > job.processes:
        return "processes"
    page = os.sysconf("SC_PAGE_SIZE")
    resident = orphaned = 0
    for pid in mine:
        with suppress(OSError, ValueError, IndexError):
            with open(f"/proc/{pid}/statm") as file:
                whole, shared = map(int, file.read().split()[1:3])
            resident += (whole - shared) * page
        orphaned += _nameless(pid)
    if resident > job.memory:
        return "memory"
    return "disk" if orphaned + _used(job.folder, job.folder_bytes) > job.folder_bytes else ""


def _nameless(pid: int) -> int:
    """Bytes on disk of files that a process holds open and has no name for any more."""
    found = 0
    with suppress(OSError):
        for name in os.listdir(f"/proc/{pid}/fd"):
            with suppress(OSError):
                about = os.stat(f"/proc/{pid}/fd/{name}")
                if stat.S_ISREG(about.st_mode) and about.st_nlink == 0:
                    found += 512 * about.st_blocks
    return found


def _used(folder: str, enough: int) -> int:
    """Bytes on disk under a folder; more than `enough` as soon as it is that, or there are too many files."""
    waiting, found, files = [folder], 0, 0
    while waiting and found <= enough:
        with suppress(OSError), os.scandir(waiting.pop()) as entries:
            for entry in entries:
                files += 1
                if files > _FILES:
                    return enough + 1
                with suppress(OSError):
                    found += 512 * entry.stat(follow_symlinks=False).st_blocks
                    if entry.is_dir(follow_symlinks=False):
                        waiting.append(entry.path)
    return found


def descendants() -> set[int]:
    """Process numbers of all that come from this process; empty where the system has no /proc."""
    children: dict[int, list[int]] = {}
    names: list[str] = []
    with suppress(OSError):
        names = os.listdir("/proc")
    for name in names:
        if name.isdigit():
            with suppress(OSError, ValueError, IndexError):
                with open(f"/proc/{name}/stat", "rb") as file:
                    parent = int(file.read().rpartition(b")")[2].split()[1])
                children.setdefault(parent, []).append(int(name))
    found: set[int] = set()
    waiting = [os.getpid()]
    while waiting:
        for child in children.get(waiting.pop(), ()):
            if child not in found:
                found.add(child)
                waiting.append(child)
    return found


def end_all(program: int) -> None:
    """End the planner and all its descendants. They are stopped before they are killed, so that none starts another meanwhile."""
    patience = time.monotonic() + _PATIENCE_S
    if not _LINUX:  # without a subreaper no children are left when the planner has ended, and its group may still be there
        with suppress(OSError):
            os.killpg(program, signal.SIGKILL)
    while _children() and time.monotonic() < patience:
        seen: set[int] = set()
        while (new := descendants() - seen) and time.monotonic() < patience:
            _signal(new, signal.SIGSTOP)
            seen |= new
        _signal(seen, signal.SIGKILL)
        if not seen:  # no /proc here
            with suppress(OSError):
                os.killpg(program, signal.SIGKILL)
        time.sleep(0.002)


def _signal(pids: set[int], number: int) -> None:
    for pid in pids:
        with suppress(OSError):
            os.kill(pid, number)


def _reaped(program: int) -> int | None:
    """Ask for the status of all that have ended; that of the planner, or None where it still runs."""
    found = None
    with suppress(ChildProcessError):
        while (ended := os.waitpid(-1, os.WNOHANG))[0]:
            if ended[0] == program:
                found = os.waitstatus_to_exitcode(ended[1])
    return found


def _children() -> bool:
    """Whether a child is left, after those that have ended were asked for their status."""
    try:
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    except ChildProcessError:
        return False
    return True


def _remove(folder: str) -> None:
    import shutil  # only here: it takes as long to import as the rest

    shutil.rmtree(folder, ignore_errors=True)


def _prctl(option: int, value: int) -> None:
    import ctypes

    ctypes.CDLL(None).prctl(option, value, 0, 0, 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv))
