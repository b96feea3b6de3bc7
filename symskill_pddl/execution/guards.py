"""What stands between a run and the world: a scene that cannot be trusted ends the run, with the robot told to stay where it is.

Every limit of a run reads the world's clock, and every twist is aimed with the world's poses. So a clock that stands, a time that
is no number, a hand without a pose or a world that raises are not something to wait out: `WorldFailedError` ends the run.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from math import isfinite
from types import FrameType
from typing import NoReturn

from symskill_pddl.errors import SymSkillError, shown
from symskill_pddl.scene import Command, Live, Scene, Timed, World

STALE_STEPS = 2
"""So many steps may show the same moment, as of a camera that is slower than the control; then the robot is held."""
STALE_S = 1.0
"""A clock that stands for steps of so much time is given up."""
STOP_SIGNALS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))


class WorldFailedError(SymSkillError):
    """The world no longer tells what can be acted on; the message says what is wrong and when."""


class GuardedWorld:
    """A world whose scenes are checked, and which is told to stay where it is while its clock stands."""

    def __init__(self, world: World) -> None:
        self._world = world
        self.period_s = world.period_s
        self.live = isinstance(world, Live) and world.live
        """Whether the world goes on while nobody steps it."""
        self._stale, self._moving, self._closing = 0, False, False
        self._last = self._sound(world.observe(), None)

    @property
    def last(self) -> Scene:
        """The latest scene."""
        return self._last

    @property
    def ms(self) -> dict[str, float]:
        """What the last step spent on the robot's own business [ms]."""
        return dict(self._world.ms) if isinstance(self._world, Timed) else {}

    def step(self, command: Command) -> Scene:
        """One control period.

        Raises
        ------
        WorldFailedError
            If the world raises, or shows what cannot be acted on.
        """
        if self._stale >= STALE_STEPS:
            command = Command.hold(command.close_gripper)
        # before the call: whatever happens in it, the twist has been sent
        self._moving, self._closing = bool(command.twist.any()), command.close_gripper
        try:
            scene = self._world.step(command)
        except Exception as error:  # whatever breaks in a driver, the robot has to be stopped and the run to be told
            why = f"{type(error).__name__}: {shown(str(error))}"
            raise WorldFailedError(f"after {self._last.time:g} s the world raised {why}") from error
        scene = self._sound(scene, self._last)
        self._stale = self._stale + 1 if scene.time == self._last.time else 0
        if self._stale * self.period_s >= STALE_S and self._stale > STALE_STEPS:
            raise WorldFailedError(f"the world's clock stands at {scene.time:g} s, for {self._stale} steps by now")
        self._last = scene
        return scene

    def stop(self) -> None:
        """Take back a twist that was commanded last: nothing moves on while nobody looks. A world may fail in that, too."""
        if self._moving:
            with suppress(Exception):
                self._world.step(Command.hold(self._closing))
            self._moving = False

    def _sound(self, scene: Scene, before: Scene | None) -> Scene:
        """The scene, if a robot can be moved by it."""
        if not isfinite(scene.time):
            since = "at its start" if before is None else f"after {before.time:g} s"
            raise WorldFailedError(f"the world's time {since} is {scene.time}, no number of seconds")
        # poses are finite by construction
        if not isfinite(scene.aperture):
            raise WorldFailedError(
                f"the world's scene at {scene.time:g} s: the aperture is {scene.aperture}, no number of metres"
            )
        if before is None:
            return scene
        if scene.time < before.time:
            raise WorldFailedError(f"the world's time went back from {before.time:g} s to {scene.time:g} s")
        if scene.objects != before.objects or list(scene.objects) != list(before.objects):
            lost, new = before.objects.keys() - scene.objects.keys(), scene.objects.keys() - before.objects.keys()
            what = f"'{min(lost)}' has vanished" if lost else f"'{min(new)}' has come" if new else "types or order have changed"
            raise WorldFailedError(
                f"the world's scene at {scene.time:g} s: {what}; a world shows the same objects all the time, "
                "and says in `unseen` which of them are out of sight"
            )
        return scene


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """While it lasts, SIGTERM and SIGHUP raise `SystemExit` in the main thread, so that a run stops its robot before it ends.

    Signals that somebody else handles already, and other threads than the main one, are left alone.
    """
    main = threading.current_thread() is threading.main_thread()
    mine = [s for s in STOP_SIGNALS if main and signal.getsignal(s) is signal.SIG_DFL]

    def stop(number: int, frame: FrameType | None) -> NoReturn:  # noqa: ARG001
        raise SystemExit(128 + number)

    for number in mine:
        signal.signal(number, stop)
    try:
        yield
    finally:
        for number in mine:
            signal.signal(number, signal.SIG_DFL)
