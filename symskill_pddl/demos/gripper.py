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
_AGREES = 0.5
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
    right, travel = 0.0, 0.0
    for one in told:
        step = np.diff(one.demo.aperture)
        right += float(np.where(convention.closed(one.actions)[:-1], -step, step).sum())
        travel += float(np.abs(step).sum())
    return right / travel if travel > _STILL_M else None


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
    """The one other column that the fingers follow, unless somebody has chosen; else an error that names what would fit."""
    width = min(one.actions.shape[1] for one in told)
    follows = {c: agreement(told, Convention(c)) or 0.0 for c in range(width) if c != wanted.column}
    fits = [c for c, value in follows.items() if value >= _AGREES and _two_sided(told, c)]
    if free and len(fits) == 1 and found > -_AGREES:
        remark(
            f"{where}: the gripper's command is column {fits[0]} of the actions, which the fingers follow "
            f"({follows[fits[0]]:.0%}); they do not follow column {wanted.column}, where this layout has it ({found:.0%})"
        )
        return Convention(fits[0])
    values = np.concatenate([one.actions[:, wanted.column] for one in told])
    far = float(values.max() if wanted.closes > 0 else values.min())
    ways = [f"--gripper-open {far:g} if that value opens"] if found < -_AGREES else []
    ways += [f"--gripper-column {c} if that is the gripper's ({follows[c]:.0%})" for c in fits]
    share = np.mean([wanted.closed(one.actions).mean() for one in told])
    raise InputError(
        f"{where}: by column {wanted.column} of the {width} of the actions the gripper is told to close {share:.0%} of the time, "
        f"and the fingers do not follow it ({found:.0%} of their travel); "
        f"{' or '.join(ways) or 'say otherwise with --gripper-column N and --gripper-open VALUE'}"
    )


def _two_sided(told: Sequence[Told], column: int) -> bool:
    """Whether a column's values are those of a switch: mostly near their two ends, both of them used."""
    values = np.concatenate([one.actions[:, column] for one in told])
    low, high = float(values.min()), float(values.max())
    near = 0.1 * (high - low)
    return low < 0 < high and bool(np.mean((values < low + near) | (values > high - near) | (values == 0)) > 0.9)
