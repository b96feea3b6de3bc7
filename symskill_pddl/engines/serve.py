"""The loop of a process that an engine runs in: requests on standard input, answers on standard output.

A frame is eight bytes with a length, and that many bytes of pickled plain values; both ends are the same version of this file.
The process ends with its standard input. While it works, the kernel's timer is set to end it a little after the time limit, so
that an engine that does not look at the clock is not left behind, whatever becomes of the process that asked.
"""

from __future__ import annotations

import os
import pickle
import signal
import struct
import sys
import time
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any, NamedTuple

START_S = 120.0
"""How long an engine may take to be imported [s]."""
_LENGTH = struct.Struct("!Q")


class Request(NamedTuple):
    """One question."""

    handle: int
    """Of what was loaded."""
    load: Mapping[str, Any] | None
    """Arguments of the engine's `load`, where the handle is new."""
    ask: Mapping[str, Any]
    """Arguments of the function that `load` gave."""
    time_s: float
    memory_mb: int | None
    """Address space [MiB]; None does not limit it."""
    forget: int | None = None
    """A handle that is not used any more."""


class Reply(NamedTuple):
    """The answer, in plain values: the process that asks need not have the engine's classes."""

    status: str
    """A value of `planning.Status`."""
    plan: Any
    messages: tuple[str, ...]
    processor_s: float


def send(to: int, message: Any) -> None:
    """Write a frame to a file descriptor."""
    data = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    view = memoryview(_LENGTH.pack(len(data)) + data)
    while view:
        view = view[os.write(to, view) :]


def receive(source: int, ready: Callable[[], None] = lambda: None) -> Any:
    """Read a frame; `ready` is called before each part is read. Raises `EOFError` where the other end is closed."""

    def exactly(count: int) -> bytes:
        parts = []
        while count:
            ready()
            if not (part := os.read(source, count)):
                raise EOFError
            parts.append(part)
            count -= len(part)
        return b"".join(parts)

    return pickle.loads(exactly(_LENGTH.unpack(exactly(_LENGTH.size))[0]))


def main(engine: str) -> None:
    """Serve until standard input ends; `engine` is the module to import."""
    source, to = os.dup(0), os.dup(1)
    nowhere = os.open(os.devnull, os.O_RDWR)
    for number in (0, 1, 2):  # what an engine prints is nobody's answer
        os.dup2(nowhere, number)
    os.close(nowhere)
    _alarm(START_S)
    load = import_module(engine).load
    loaded: dict[int, Callable[..., tuple[str, Any, tuple[str, ...]]]] = {}
    send(to, "ready")
    while True:
        _alarm(0.0)
        try:
            request = receive(source)
        except EOFError:
            return
        _alarm(1.2 * request.time_s + 1.0)
        begin = time.process_time()
        loaded.pop(request.forget, None)
        try:
            _memory(request.memory_mb)
            if request.load is not None:
                loaded[request.handle] = load(**request.load)
            status, plan, messages = loaded[request.handle](time_s=request.time_s, **request.ask)
        except MemoryError:
            status, plan, messages = "failed", None, (f"ran out of memory, {request.memory_mb} MiB",)
        except (Exception, SystemExit) as error:  # noqa: BLE001 - engines raise whatever they like
            status, plan, messages = "failed", None, (f"{type(error).__name__}: {' '.join(str(error).split())}",)
        _memory(None)
        send(to, Reply(status, plan, messages, time.process_time() - begin))


def _alarm(seconds: float) -> None:
    """The kernel ends this process after so many seconds, though all of it be busy in compiled code; 0 is never."""
    if hasattr(signal, "setitimer"):
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, seconds)


def _memory(mebibytes: int | None) -> None:
    """Bound the address space, as far as the system knows how."""
    try:
        import resource
    except ImportError:
        return
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    bound = hard if mebibytes is None else mebibytes * 1024 * 1024
    if hard != resource.RLIM_INFINITY:
        bound = min(bound, hard)
    resource.setrlimit(resource.RLIMIT_AS, (bound, hard))


if __name__ == "__main__":
    main(sys.argv[1])
