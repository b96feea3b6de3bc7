"""Reads `NAME[:ARGUMENTS]@WHEN`."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from symskill_pddl.errors import InputError, alternatives, shown
from symskill_pddl.kitchen.disturbances.kind import Arguments, Kind
from symskill_pddl.kitchen.disturbances.kinds import KINDS
from symskill_pddl.reading import number, whole

UNITS: dict[str, tuple[str, float]] = {
    "mm": ("m", 1e-3),
    "cm": ("m", 1e-2),
    "m": ("m", 1.0),
    "deg": ("rad", math.pi / 180.0),
    "rad": ("rad", 1.0),
    "s": ("s", 1.0),
    "N": ("N", 1.0),
    "Nm": ("Nm", 1.0),
}
"""Unit as written to SI unit and factor."""
_NUMBER = re.compile(r"(\d+(?:\.\d+)?)([A-Za-z]+)")


@dataclass(frozen=True)
class When:
    """When it begins; one of the first three is given.

    Attributes
    ----------
    time_s : float or None
        At this time of the episode [s].
    step : int or None
        When the executor starts this operator, counted from 0.
    chance : float or None
        With this probability in every control step, again and again.
    times : int or None
        At most so often; None: without limit.
    """

    time_s: float | None = None
    step: int | None = None
    chance: float | None = None
    times: int | None = 1


@dataclass(frozen=True)
class Disturbance:
    """What is to go wrong, and when. Immutable: `running.Running` is one in action."""

    spec: str
    kind: Kind
    arguments: Arguments
    when: When

    def check(self, objects: dict[str, str]) -> None:
        """Refuse what the scene cannot have.

        Raises
        ------
        InputError
            An object that it needs is not in the scene; the message lists what is.
        """
        if missing := self.kind.lacks(objects):
            raise InputError(f"disturbance '{self.spec}': the scene has no {missing[0]}; it has: {alternatives(objects)}")
        about = self.arguments.about
        if about is not None and about not in objects:
            raise InputError(f"disturbance '{self.spec}': the scene has no '{about}'; it has: {alternatives(objects)}")


def parse_disturbance(spec: str) -> Disturbance:
    """A disturbance from its text.

    ARGUMENTS are numbers with units, separated by commas, and for some kinds the name of an object. WHEN is ``t=SECONDS``,
    ``op=NUMBER`` (when the operator starts) or ``p=PROBABILITY[xTIMES]`` (in every control step).

    Raises
    ------
    InputError
        The text is not understood; the message lists what exists.
    """
    head, _, when = spec.partition("@")
    name, _, arguments = head.partition(":")
    if name not in KINDS:
        raise InputError(f"disturbance '{shown(spec, 80)}': unknown name '{shown(name, 80)}'; there are: {alternatives(KINDS)}")
    kind = KINDS[name]
    return Disturbance(spec, kind, _arguments(spec, kind, arguments), _when(spec, name, when))


def _arguments(spec: str, kind: Kind, text: str) -> Arguments:
    values, about = dict(kind.defaults), None
    units = [unit for unit, (si, _) in UNITS.items() if si in kind.defaults]
    for word in (w.strip() for w in text.split(",") if text):
        match = _NUMBER.fullmatch(word)
        value = number(match[1]) if match is not None and match[2] in units else None
        if match is not None and value is not None:
            si, factor = UNITS[match[2]]
            values[si] = value * factor
        elif kind.nameable and about is None and re.fullmatch(r"[A-Za-z][\w-]*", word):
            about = word
        else:
            also = " or an object's name" if kind.nameable else ""
            raise InputError(
                f"disturbance '{shown(spec, 80)}': argument '{shown(word, 80)}' is not a number with one of the units "
                f"{alternatives(units)}{also}"
            )
    return Arguments(values, about)


def _when(spec: str, name: str, text: str) -> When:
    key, _, value = text.partition("=")
    seconds, step = number(value), whole(value)
    if key == "t" and seconds is not None and seconds >= 0.0:
        return When(time_s=seconds)
    if key == "op" and step is not None:
        return When(step=step)
    head, _, often = value.partition("x")
    chance, times = number(head), whole(often)
    if key == "p" and chance is not None and 0.0 < chance <= 1.0 and (times or not often) and not value.endswith("x"):
        return When(chance=chance, times=times)
    raise InputError(
        f"disturbance '{shown(spec, 80)}': say when, as '{name}@t=SECONDS', '{name}@op=NUMBER' or '{name}@p=PROBABILITY' "
        f"(up to 1, in every control step; '{name}@p=0.01x2' at most twice)"
    )
