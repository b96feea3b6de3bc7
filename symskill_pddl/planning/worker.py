"""Engines that are libraries run in a process of ours, which can be ended: one that hangs or crashes takes nothing along.

A process is started at the first question to its engine, and kept for the next ones; what a session has loaded stays loaded in
it. Asked questions cost a tenth of a millisecond more than in this process, and threads of this process run meanwhile.
"""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import select
import signal
import subprocess
import sys
import time
from collections import OrderedDict, defaultdict
from collections.abc import Mapping
from itertools import count
from pathlib import Path
from threading import Lock
from typing import Any

from symskill_pddl.engines import serve

_BOOT = "import json, sys; sys.path[:] = json.loads(sys.argv[1]); from symskill_pddl.engines.serve import main; main(sys.argv[2])"
_IDLE = 2
"""Processes kept for one engine while nobody asks."""
_LOADED = 8
"""Domains kept in one process; the one that was not used for longest is dropped first."""
_LONGEST_S = 1e6
"""Longer than anybody waits [s]; what an engine's own clock, an alarm or `select` takes as a limit ends somewhere."""
_handles = count(1)


class OverdueError(Exception):
    """No answer in time."""


class Worker:
    """One process with one engine."""

    def __init__(self, engine: str) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-c", _BOOT, json.dumps([p or str(Path.cwd()) for p in sys.path]), engine],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._to, self._from = self._process.stdin.fileno(), self._process.stdout.fileno()
        self._ready = False
        self.loaded: OrderedDict[int, None] = OrderedDict()
        """Handles, the least recently used first."""

    def start(self, deadline: float) -> None:
        """Wait until the engine is imported; on `OverdueError` it goes on and can be asked later."""
        if not self._ready:
            self._receive(deadline)
            self._ready = True

    def ask(
        self, handle: int, load: Mapping[str, Any], ask: Mapping[str, Any], time_s: float, memory_mb: int | None
    ) -> serve.Reply:
        """The engine's answer; raises `OverdueError` a little after the time limit, and `EOFError` where the process ends."""
        deadline = time.monotonic() + 1.1 * time_s + 0.05
        new = handle not in self.loaded
        forget = next(iter(self.loaded)) if new and len(self.loaded) >= _LOADED else None
        try:
            serve.send(self._to, serve.Request(handle, load if new else None, ask, time_s, memory_mb, forget))
        except BrokenPipeError:
            raise EOFError from None
        reply: serve.Reply = self._receive(deadline)
        if forget is not None:
            del self.loaded[forget]
        if reply.status == "failed":  # what is loaded may be broken too
            self.loaded.pop(handle, None)
        else:
            self.loaded[handle] = None
            self.loaded.move_to_end(handle)
        return reply

    def _receive(self, deadline: float) -> Any:
        def ready() -> None:
            if not select.select([self._from], [], [], max(0.0, deadline - time.monotonic()))[0]:
                raise OverdueError

        return serve.receive(self._from, ready)

    def end(self) -> str:
        """End it, and whatever it started; how it ended, if it had by itself."""
        status = self._process.poll()
        if status is None:  # its pipe may be closed a moment before it is gone
            with contextlib.suppress(subprocess.TimeoutExpired):
                status = self._process.wait(0.05)
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.communicate()
        if status is None or status >= 0:
            return f"with status {status}" if status else "by itself"
        return f"by the signal {signal.Signals(-status).name}"

    def leave(self) -> None:
        """In a copy of this process: it is the original's."""
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                stream.close()
        self._process.returncode = 0


class Pool:
    """The processes of this one that nobody asks at the moment, by engine."""

    def __init__(self) -> None:
        self._idle: dict[str, list[Worker]] = defaultdict(list)
        self._lock = Lock()
        self.processor_s = 0.0
        """Processor time of all answers so far [s], for who measures."""

    def take(self, engine: str, handle: int) -> Worker:
        """A process of the engine, if there is one with the handle loaded."""
        with self._lock:
            idle = self._idle[engine]
            if not idle:
                return Worker(engine)
            return idle.pop(next((i for i, w in enumerate(idle) if handle in w.loaded), len(idle) - 1))

    def give_back(self, engine: str, worker: Worker) -> None:
        with self._lock:
            self._idle[engine].append(worker)
            surplus = self._idle[engine][:-_IDLE]
            del self._idle[engine][:-_IDLE]
        for each in surplus:
            each.end()

    def end(self) -> None:
        """End all that are idle."""
        with self._lock:
            workers = [w for idle in self._idle.values() for w in idle]
            self._idle.clear()
        for worker in workers:
            worker.end()

    def forked(self) -> None:
        """This process is a copy: nothing in the pool is its own."""
        self._lock = Lock()
        for worker in (w for idle in self._idle.values() for w in idle):
            worker.leave()
        self._idle = defaultdict(list)


POOL = Pool()
atexit.register(POOL.end)
os.register_at_fork(after_in_child=POOL.forked)


class Remote:
    """Something loaded into an engine's process, which may be another process with every question.

    Parameters
    ----------
    engine : str
        The module with the function `load`; its name is what messages call it by.
    load : mapping
        Arguments of `load`: plain values.
    """

    def __init__(self, engine: str, load: Mapping[str, Any]) -> None:
        self._engine, self._load, self._handle = engine, load, next(_handles)

    def ask(self, time_s: float, memory_mb: int | None, **question: Any) -> serve.Reply:
        """Ask; never later than a fifth more than the limit, nor by more than a twentieth of a second where that is longer."""
        begin, time_s = time.monotonic(), min(time_s, _LONGEST_S)
        name = self._engine.rpartition(".")[2]
        worker = POOL.take(self._engine, self._handle)
        try:
            worker.start(begin + time_s)
        except OverdueError:
            POOL.give_back(self._engine, worker)
            return serve.Reply("timeout", None, (f"{name} was still being loaded",), 0.0)
        except EOFError:
            return serve.Reply("failed", None, (f"the process of {name} ended {worker.end()} while it was started",), 0.0)
        left = max(1e-3, begin + time_s - time.monotonic())
        try:
            reply = worker.ask(self._handle, self._load, question, left, memory_mb)
        except OverdueError:
            worker.end()
            return serve.Reply("timeout", None, (f"{name} did not look at the clock and was ended",), 0.0)
        except EOFError:
            return serve.Reply("failed", None, (f"the process of {name} ended {worker.end()}",), 0.0)
        except BaseException:
            worker.end()  # somewhere within a frame
            raise
        POOL.give_back(self._engine, worker)
        POOL.processor_s += reply.processor_s
        return reply
