"""The tasks: which of RoboCasa's environments each is, and what it is about. Names are those of the paper. No simulator here."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

Split = Literal["target", "train"]
LAYOUTS: dict[Split, range] = {"target": range(1, 11), "train": range(11, 61)}
"""RoboCasa's own split of its kitchens: episodes are drawn from the first, demonstrations from the second."""
STYLES = range(1, 61)


@dataclass(frozen=True)
class TaskSpec:
    """A task.

    Attributes
    ----------
    name : str
    env : str
        RoboCasa's environment.
    about : str
        What kind of thing: a key of `tracking.TRACKED`.
    part : str
        The attribute of the environment that is the fixture.
    focus : tuple of str
        The objects it is about, by our names.
    options : dict
        Arguments of the environment; texts that begin with 'FixtureType.' stand for RoboCasa's constants.
    composed : tuple
        The demonstrated tasks that make up its goal, if it is none itself.
    """

    name: str
    env: str
    about: str
    part: str
    focus: tuple[str, ...]
    options: dict[str, Any] = field(default_factory=dict, hash=False)
    composed: tuple[tuple[str, tuple[str, ...]], ...] = ()

    @property
    def goals(self) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """The demonstrated tasks whose learned goals together are the goal, each with the objects it is about."""
        return self.composed or ((self.name, self.focus),)


_SINGLE = {"fixture_id": "FixtureType.CABINET_SINGLE_DOOR"}
_DOOR, _DRAWER, _KNOB, _LEVER = ("door", "cabinet"), ("drawer", "drawer-unit"), ("knob", "stove"), ("lever", "sink")

TASKS = {
    spec.name: spec
    for spec in (
        TaskSpec("OpenSingleDoor", "OpenCabinet", "door", "fxtr", _DOOR, _SINGLE),
        TaskSpec("CloseSingleDoor", "CloseCabinet", "door", "fxtr", _DOOR, _SINGLE),
        TaskSpec("OpenDrawer", "OpenDrawer", "drawer", "drawer", _DRAWER),
        TaskSpec("CloseDrawer", "CloseDrawer", "drawer", "drawer", _DRAWER),
        TaskSpec("TurnOnStove", "TurnOnStove", "knob", "stove", _KNOB),
        TaskSpec("TurnOffStove", "TurnOffStove", "knob", "stove", _KNOB),
        TaskSpec("TurnOnSinkFaucet", "TurnOnSinkFaucet", "lever", "sink", _LEVER),
        TaskSpec("TurnOffSinkFaucet", "TurnOffSinkFaucet", "lever", "sink", _LEVER),
    )
}
