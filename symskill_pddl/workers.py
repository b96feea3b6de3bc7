"""Worker processes that end with the process that started them, whatever ends it."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_all_start_methods, get_context
from threading import Thread
from typing import Any

_LOOK_S = 0.5
_PR_SET_PDEATHSIG = 1


def can_fork() -> bool:
    """Whether processes of this system may start as copies of this one."""
    return "fork" in get_all_start_methods()


def pool(jobs: int, method: str, begin: Callable[..., object] | None = None, args: tuple[Any, ...] = ()) -> ProcessPoolExecutor:
    """A pool of worker processes; without more, those of a process that was killed would wait for work for ever.

    Parameters
    ----------
    method : str
        How they start: ``fork`` (a copy of this process, with what it has loaded) or ``spawn`` (a fresh one).
    begin : callable, optional
        Called once in each, with `args`.
    """
    return ProcessPoolExecutor(jobs, get_context(method), initializer=_begin, initargs=(os.getpid(), begin, args))


def end_with(parent: int) -> None:
    """From now on this process ends when its parent, the process of that number, is no more."""
    if sys.platform == "linux":  # at once, and in the middle of compiled code too, where no thread gets its turn
        import ctypes

        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    Thread(target=_watch, args=(parent,), daemon=True, name="parent").start()


def _begin(parent: int, begin: Callable[..., object] | None, args: tuple[Any, ...]) -> None:
    end_with(parent)
    if begin is not None:
        begin(*args)


def _watch(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(_LOOK_S)
    os._exit(1)
