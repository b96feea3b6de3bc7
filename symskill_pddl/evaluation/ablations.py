"""Mechanisms that can be switched off, one table: what an evaluation may be compared against."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.evaluation.results import Settings
from symskill_pddl.evaluation.suite import Suite
from symskill_pddl.execution.config import ExecutionConfig


def _config(change: Callable[[ExecutionConfig], ExecutionConfig]) -> Callable[[Suite], Suite]:
    return lambda suite: replace(suite, config=change(suite.config))


ABLATIONS: dict[str, Callable[[Suite], Suite]] = {
    "monitor": lambda suite: replace(suite, monitor=False),
    "resampling": _config(lambda c: replace(c, resample=False)),
    "replanning": _config(lambda c: replace(c, replan=False)),
    "tracking": _config(lambda c: replace(c, motion=replace(c.motion, track=False))),
    "obstacles": _config(lambda c: replace(c, motion=replace(c.motion, avoid=False))),
}
"""By the name that `Settings` has for each."""


def without(suite: Suite, mechanism: str) -> Suite:
    """The same episodes with one mechanism switched off.

    Raises
    ------
    InputError
        It is unknown, or already off.
    """
    if mechanism not in ABLATIONS:
        raise InputError(f"unknown mechanism '{mechanism}'; there are: {alternatives(ABLATIONS)}")
    less = ABLATIONS[mechanism](suite)
    if less == suite:
        raise InputError(f"a comparison without {mechanism} needs an evaluation with it, and it is switched off")
    return less


def switched_off(settings: Settings) -> tuple[str, ...]:
    """The mechanisms that an evaluation did without."""
    return tuple(name for name in ABLATIONS if not getattr(settings, name))
