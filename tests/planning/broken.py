"""Engines that break in every way an engine can, for `planning.worker`."""

import ctypes
import os
import time


def load(how):
    """What `symskill_pddl.engines` modules have; breaks while it loads, or when it is asked."""
    if how == "load":
        raise ValueError("cannot\nload")

    def ask(time_s, **question):
        if how == "raise":
            raise RuntimeError("Expecting: ground_literal\n here")
        if how == "exit":
            raise SystemExit(3)
        if how == "crash":
            ctypes.string_at(0)
        if how == "vanish":
            os._exit(7)
        if how == "sleep":
            time.sleep(600)
        if how == "busy":  # compiled code that keeps the interpreter's lock
            sum(range(10**12))
        if how == "hoard":
            return "solved", bytearray(64 * 1024**3), ()
        if how == "talk":
            os.write(1, b"nonsense" * 1000)
        return "solved", (("step", (how, *question.get("args", ()))),), (str(os.getpid()),)

    return ask
