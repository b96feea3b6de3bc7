"""What a recording told its gripper, in a column of its actions: which column that is, and which of its values closes.

Layouts and conventions differ from collection to collection, so nothing is believed: the fingers have to do what they were told.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from symskill_pddl.demos.demo import BoolArray, Demo
from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array

_STILL_M = 0.005
"""Fingers that travel less than this in all recordings of a file show nothing."""
_PLAY = 0.1
"""Part of the fingers' range that they may move without having been told."""
_AGREES, _SURE = 0.5, 0.8
"""Of the fingers' travel, the part that goes where they were told less the part that does not; 1 without any lag."""


@dataclass(frozen=True)
class Convention:
    """Which column of the actions is the gripper's, and how it is read.

    `middle` lies between opening and closing; on it the last command holds. `closes` is 1 if larger values close, else -1.
    """

    column: int
    middle: float = 0.0
    closes: int = 1

    def closed(self, actions: Array) -> BoolArray:
        """What the fingers were told (n,) by actions (n, m); open at first."""
        command = self.closes * (actions[:, self.column] - self.middle)
        last = np.maximum.accumulate(np.where(command != 0, np.arange(len(command)), -1))
        return np.asarray((last >= 0) & (command[np.maximum(last, 0)] > 0))


@dataclass(frozen=True, eq=False)
class Told:
    """A demonstration, the actions (n, m) it was driven by, and the convention of the layout they came in."""

    demo: Demo
    actions: Array
    convention: Convention


def agreement(told: Sequence[Told], convention: Convention) -> float | None:
    """From -1 to 1, how far the fingers do what they are told; None if they hardly move."""
    return following([(one.demo.aperture, convention.closed(one.actions)) for one in told])


def following(recorded: Sequence[tuple[Array, BoolArray]]) -> float | None:
    """From -1 to 1, how far openings (n,) [m] follow the commands (n,) to close; None if they hardly move."""
    slack = _PLAY * max(float(np.ptp(aperture)) for aperture, _ in recorded)
    right, travel = 0.0, 0.0
    for aperture, closed in recorded:
        step = np.diff(_played(aperture, slack))
        right += float(np.where(closed[1:], -step, step).sum())
        travel += float(np.abs(step).sum())
    return right / travel if travel > _STILL_M else None


def _played(aperture: Array, slack: float) -> Array:
    """An opening (n,) as somebody follows it who does not mind `slack`: what is held gives, and fingers tremble."""
    out, at = np.empty_like(aperture), float(aperture[0])
    for i, value in enumerate(aperture.tolist()):
        at = min(max(at, value - slack), value + slack)
        out[i] = at
    return out


def with_commands(
    told: Sequence[Told], where: str, remark: Callable[[str], object], *, column: int | None = None, opens: float | None = None
) -> tuple[Demo, ...]:
    """The demonstrations of one file with what their grippers were told.

    Parameters
    ----------
    told : sequence of Told
    where : str
        The file, for messages.
    remark : callable
        Is told what a person should know.
    column : int, optional
        The gripper's column, in place of the layout's; negative ones count from the end.
    opens : float, optional
        The value of that column that opens.

    Raises
    ------
    InputError
        If there is no such column, or the fingers do not do what they are told.
    """
    width = min(one.actions.shape[1] for one in told)
    wanted = told[0].convention
    if column is not None:
        if not -width <= column < width:
            raise InputError(f"{where}: an action has {width} numbers, there is no column {column}")
        wanted = replace(wanted, column=column)
    wanted = replace(wanted, column=wanted.column % width)
    if opens is not None:
        wanted = _opening(told, wanted.column, opens, where)
    found = agreement(told, wanted)
    if found is None:
        if len({bool(c) for one in told for c in wanted.closed(one.actions)}) > 1:
            remark(f"{where}: the fingers do not move although column {wanted.column} of the actions tells them to")
    elif found < _AGREES:
        wanted = _other(told, wanted, found, where, remark, free=column is None and opens is None)
    return tuple(replace(one.demo, gripper_closed=wanted.closed(one.actions)) for one in told)


def _opening(told: Sequence[Told], column: int, opens: float, where: str) -> Convention:
    values = np.concatenate([one.actions[:, column] for one in told])
    far = float(max(values.min(), values.max(), key=lambda v: abs(v - opens)))
    if far == opens:
        return Convention(column, opens, 1)
    if not values.min() <= opens <= values.max():
        raise InputError(
            f"{where}: column {column} of the actions goes from {values.min():g} to {values.max():g}, it never opens at {opens:g}"
        )
    return Convention(column, 0.5 * (far + opens), 1 if far > opens else -1)


def _other(
    told: Sequence[Told], wanted: Convention, found: float, where: str, remark: Callable[[str], object], *, free: bool
) -> Convention:
    """The one other reading that the fingers follow, unless somebody has chosen; else an error that says what would fit."""
    width = min(one.actions.shape[1] for one in told)
    values = np.concatenate([one.actions[:, wanted.column] for one in told])
    readings = {
        f"--gripper-open {v:g}": _opening(told, wanted.column, v, where) for v in (float(values.min()), float(values.max()))
    }
    readings |= {f"--gripper-column {c}": Convention(c) for c in range(width) if c != wanted.column and _two_sided(told, c)}
    fits = {option: agreement(told, reading) or 0.0 for option, reading in readings.items()}
    fits = {option: value for option, value in fits.items() if value >= _AGREES}
    disagree = (
        f"{where}: by column {wanted.column} of the {width} of the actions the gripper is told to close "
        f"{np.mean([wanted.closed(one.actions).mean() for one in told]):.0%} of the time, and the fingers do not follow it "
        f"({found:.0%} of their travel)"
    )
    if free and len(fits) == 1 and max(fits.values()) >= _SURE:
        (option,) = fits
        remark(f"{disagree}; taken as if {option} had been given, which they follow ({fits[option]:.0%})")
        return readings[option]
    ways = [f"{option} ({value:.0%})" for option, value in fits.items()]
    raise InputError(f"{disagree}; {' or '.join(ways) or '--gripper-column N or --gripper-open VALUE'} says otherwise")


def _two_sided(told: Sequence[Told], column: int) -> bool:
    """Whether a column's values are those of a switch: mostly near their two ends, both of them used."""
    values = np.concatenate([one.actions[:, column] for one in told])
    low, high = float(values.min()), float(values.max())
    near = 0.1 * (high - low)
    return low < 0 < high and bool(np.mean((values < low + near) | (values > high - near) | (values == 0)) > 0.9)
