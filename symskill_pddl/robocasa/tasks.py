"""The tasks: which of RoboCasa's environments each is, and what it is about. Names are those of the paper. No simulator here."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

Split = Literal["target", "train"]
LAYOUTS: dict[Split, range] = {"target": range(1, 11), "train": range(11, 61)}
"""RoboCasa's own split of its kitchens: episodes are drawn from the first, demonstrations from the second."""
STYLES = tuple(range(1, 61))
BARS = tuple(style for style in STYLES if style not in (5, 11, 12, 15, 21, 32, 38, 41, 42, 44, 47, 51, 52, 55, 58, 60))
"""Styles whose handles are bars that a hand goes round. Others have plates, knobs, or bars flat on the panel: the meshes are
scaled to such boxes, and so is the bar of the small asset pack."""


@dataclass(frozen=True)
class TaskSpec:
    """A task.

    Attributes
    ----------
    name : str
    env : str
        RoboCasa's environment.
    about : str
        What kind of thing: a key of `tracking.FIXTURES` or `things.THINGS`.
    part : str
        The attribute of the environment that is the fixture.
    styles : tuple of int
        RoboCasa's styles that its kitchens are drawn from.
    focus : tuple of str
        The objects it is about, by our names.
    options : dict
        Arguments of the environment; texts that begin with 'FixtureType.' stand for RoboCasa's constants.
    carried : tuple of str
        RoboCasa's names of what is carried and of the dish it goes to: things that have to be within the arm's reach.
    closes : bool
        Whether a door is to be shut, so that the arm has to get to its outer side.
    composed : tuple
        The demonstrated tasks that make up its goal, if it is none itself.
    """

    name: str
    env: str
    about: str
    part: str
    focus: tuple[str, ...]
    styles: tuple[int, ...] = STYLES
    options: dict[str, Any] = field(default_factory=dict, hash=False)
    carried: tuple[str, ...] = ()
    closes: bool = False
    composed: tuple[tuple[str, tuple[str, ...]], ...] = ()

    @property
    def goals(self) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """The demonstrated tasks whose learned goals together are the goal, each with the objects it is about."""
        return self.composed or ((self.name, self.focus),)


_SINGLE = {"fixture_id": "FixtureType.CABINET_SINGLE_DOOR"}
_DOOR, _DRAWER, _KNOB, _LEVER = ("door", "cabinet"), ("drawer", "drawer-unit"), ("knob", "stove"), ("lever", "sink")
_FOOD = {"obj_groups": "food"}
_OUT, _IN = ("food", "cabinet", "counter"), ("food", "counter", "cabinet")
_SERVED, _COOKED, _DISHES = ("food", "pan", "plate"), ("food", "plate", "pan"), ("obj", "container")

TASKS = {
    spec.name: spec
    for spec in (
        TaskSpec("OpenSingleDoor", "OpenCabinet", "door", "fxtr", _DOOR, BARS, _SINGLE),
        TaskSpec("CloseSingleDoor", "CloseCabinet", "door", "fxtr", _DOOR, BARS, _SINGLE, closes=True),
        TaskSpec("PnPCabToCounter", "PickPlaceCabinetToCounter", "stored food", "cab", _OUT, BARS, _FOOD, carried=("obj",)),
        TaskSpec("PnPCounterToCab", "PickPlaceCounterToCabinet", "stored food", "cab", _IN, BARS, _FOOD, carried=("obj",)),
        TaskSpec("PnPStoveToCounter", "PickPlaceStoveToCounter", "cooked food", "stove", _SERVED, carried=_DISHES),
        TaskSpec("PnPCounterToStove", "PickPlaceCounterToStove", "cooked food", "stove", _COOKED, carried=_DISHES),
        TaskSpec("OpenDrawer", "OpenDrawer", "drawer", "drawer", _DRAWER, BARS),
        TaskSpec("CloseDrawer", "CloseDrawer", "drawer", "drawer", _DRAWER, BARS),
        TaskSpec("TurnOnStove", "TurnOnStove", "knob", "stove", _KNOB),
        TaskSpec("TurnOffStove", "TurnOffStove", "knob", "stove", _KNOB),
        TaskSpec("TurnOnSinkFaucet", "TurnOnSinkFaucet", "lever", "sink", _LEVER),
        TaskSpec("TurnOffSinkFaucet", "TurnOffSinkFaucet", "lever", "sink", _LEVER),
        TaskSpec(
            "StoreCheese",
            "StoreCheese",
            "stored cheese",
            "cab",
            ("cheese", "cabinet", "counter", "door"),
            BARS,
            carried=("obj",),
            closes=True,
            composed=(("PnPCabToCounter", ("cheese", "cabinet", "counter")), ("CloseSingleDoor", ("door", "cabinet"))),
        ),
    )
}
