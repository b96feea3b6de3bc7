"""The demonstrator: does a task of the kitchen as a person would, from what is seen and the geometry of the fixtures.

Everything goes through `World.step`, within the limits of `demonstrator.hand`. Whoever records asks the judge, at the end only.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.human import Faults, Person
from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.kitchen import demo_door, demo_drawer, demo_food, demo_play, demo_turn
from symskill_pddl.scene import Scene

if TYPE_CHECKING:
    from symskill_pddl.kitchen.world import Kitchen

WAYS: dict[str, Callable[[Hand, str], object]] = {
    "OpenSingleDoor": demo_door.open_door,
    "CloseSingleDoor": demo_door.close_door,
    "PnPCabToCounter": demo_food.to_counter,
    "PnPCounterToCab": demo_food.to_cabinet,
    "PnPStoveToCounter": demo_food.to_plate,
    "PnPCounterToStove": demo_food.to_pan,
    "OpenDrawer": demo_drawer.open_drawer,
    "CloseDrawer": demo_drawer.close_drawer,
    "TurnOnStove": demo_turn.turn_knob_on,
    "TurnOffStove": demo_turn.turn_knob_off,
    "TurnOnSinkFaucet": demo_turn.turn_lever_on,
    "TurnOffSinkFaucet": demo_turn.turn_lever_off,
    "Play": demo_play.play,
}
"""How each task is done: what the hand does, given the object that is to be moved."""


def demonstrate(
    kitchen: Kitchen, rng: np.random.Generator, *, person: Person | None = None, faults: Faults | None = None
) -> tuple[Scene, ...]:
    """One demonstration of the kitchen's task, at 20 Hz, from the start pose back to about there.

    Parameters
    ----------
    kitchen : Kitchen
        A fresh episode; it is played through.
    rng : numpy.random.Generator
        Decides on everything that people do differently.
    person, faults : optional
        Whose hand it is and what goes wrong; drawn when not given.

    Returns
    -------
    tuple of Scene
        Whether it worked is for the kitchen's judge to say.

    Raises
    ------
    InputError
        Nobody knows how to do this task.
    """
    try:
        way = WAYS[kitchen.task]
    except KeyError:
        raise InputError(f"task '{kitchen.task}' cannot be demonstrated; there are: {alternatives(WAYS)}") from None
    hand = Hand(kitchen, person or Person.draw(rng), faults or Faults.draw(rng), rng)
    hand.rest(float(rng.uniform(0.3, 0.8)))
    way(hand, kitchen.focus[0])
    return tuple(hand.scenes)
