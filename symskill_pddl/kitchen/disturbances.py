"""What may go wrong on purpose: `name[:args]@key=value`, for example `close-door@op=2` or `push:20N,0.5s@t=3`."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from symskill_pddl.errors import InputError, alternatives

if TYPE_CHECKING:
    from symskill_pddl.kitchen.world import Kitchen


@dataclass
class Disturbance:
    """One thing that happens once, for a while, from a moment on.

    Attributes
    ----------
    spec : str
        The text it was made from.
    effect : callable
        `effect(kitchen, seconds since it began) -> bool`: acts for the coming control period and says whether it goes on.
    at_time : float or None
        It begins at this time of the episode [s].
    at_step : int or None
        It begins when the executor starts this operator, counted from 0.
    """

    spec: str
    effect: Callable[[Kitchen, float], bool]
    at_time: float | None = None
    at_step: int | None = None
    began: float | None = field(default=None, init=False)
    done: bool = field(default=False, init=False)
    _due: bool = field(default=False, init=False)

    def operator_started(self, k: int) -> None:
        """The executor starts its k-th operator."""
        self._due = self._due or k == self.at_step

    def act(self, kitchen: Kitchen) -> None:
        """Do what is to be done in the coming control period."""
        if self.done:
            return
        if self.began is None:
            if not (self._due or (self.at_time is not None and kitchen.time >= self.at_time - 1e-9)):
                return
            self.began = kitchen.time
        self.done = not self.effect(kitchen, kitchen.time - self.began)


def _close_door(arguments: dict[str, float]) -> Callable[[Kitchen, float], bool]:
    """A person shuts the door with a torque that grows, up to a bound, until the door moves gently; ends when shut or in time."""
    strongest, seconds = arguments["Nm"], arguments["s"]

    def effect(kitchen: Kitchen, elapsed: float) -> bool:
        physics = kitchen.physics
        going = elapsed < seconds and physics.door_angle > math.radians(0.3)
        wanted = -1.2 if physics.door_angle > 0.3 else -0.6
        # the step is small for the inertia and damping of a door, as the torque lasts a whole control period
        torque = float(np.clip(physics.door_torque + 0.5 * (wanted - physics.door_speed), -strongest, 0.0))
        physics.door_torque = torque if going else 0.0
        return going

    return effect


def _push(arguments: dict[str, float]) -> Callable[[Kitchen, float], bool]:
    """Someone bumps into the hand, sideways."""
    force, seconds = arguments["N"], arguments["s"]

    def effect(kitchen: Kitchen, elapsed: float) -> bool:
        going = elapsed < seconds - 1e-9
        kitchen.physics.hand_force = np.array([0.0, force if going else 0.0, 0.0])
        return going

    return effect


def _drop(arguments: dict[str, float]) -> Callable[[Kitchen, float], bool]:
    """The fingers lose what they hold: they are forced open for a moment, whatever the command."""
    seconds = arguments["s"]

    def effect(kitchen: Kitchen, elapsed: float) -> bool:
        kitchen.forced_open = elapsed < seconds - 1e-9
        return kitchen.forced_open

    return effect


KINDS: dict[str, tuple[Callable[[dict[str, float]], Callable[[Kitchen, float], bool]], dict[str, float]]] = {
    "close-door": (_close_door, {"Nm": 10.0, "s": 5.0}),
    "push": (_push, {"N": 20.0, "s": 0.5}),
    "drop": (_drop, {"s": 0.5}),
}
"""Maker and arguments (unit to default) of every kind. A new one is a new line."""

_NUMBER = re.compile(r"([+-]?\d+(?:\.\d+)?)([A-Za-z]+)")


def parse_disturbance(spec: str) -> Disturbance:
    """A disturbance from its text.

    `NAME[:ARGS]@t=SECONDS` or `NAME[:ARGS]@op=K`, with ARGS numbers and units, separated by commas.

    Raises
    ------
    InputError
        The text is not understood; the message lists what exists.
    """
    head, at, when = spec.partition("@")
    name, _, argument_text = head.partition(":")
    if name not in KINDS:
        raise InputError(f"disturbance '{spec}': unknown name '{name}'; there are: {alternatives(KINDS)}")
    make, defaults = KINDS[name]
    key, equals, value = when.partition("=")
    if not (at and equals and key in ("t", "op") and re.fullmatch(r"\d+(\.\d+)?" if key == "t" else r"\d+", value)):
        raise InputError(f"disturbance '{spec}': say when, as '{name}@t=SECONDS' or '{name}@op=NUMBER'")
    arguments = dict(defaults)
    for text in argument_text.split(",") if argument_text else ():
        match = _NUMBER.fullmatch(text.strip())
        if match is None or match[2] not in defaults:
            raise InputError(
                f"disturbance '{spec}': argument '{text}' is not a number with one of the units {alternatives(defaults)}"
            )
        arguments[match[2]] = float(match[1])
    effect = make(arguments)
    return Disturbance(spec, effect, at_time=float(value)) if key == "t" else Disturbance(spec, effect, at_step=int(value))
