"""The demonstrator: does a task as a person would, from what is seen and the joint of the part it is about."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.human import Faults, Person
from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.robocasa import demo_door, demo_drawer, demo_food, demo_turn
from symskill_pddl.robocasa.world import RoboCasaWorld
from symskill_pddl.scene import Scene

WAYS: dict[str, Callable[[Hand, RoboCasaWorld], object]] = {
    "OpenSingleDoor": lambda hand, world: demo_door.open_door(hand, world.part("door")),
    "CloseSingleDoor": lambda hand, world: demo_door.close_door(hand, world.part("door")),
    "PnPCabToCounter": demo_food.to_counter,
    "PnPCounterToCab": demo_food.to_cabinet,
    "PnPStoveToCounter": demo_food.to_plate,
    "PnPCounterToStove": demo_food.to_pan,
    "OpenDrawer": lambda hand, world: demo_drawer.open_drawer(hand, world.part("drawer"), world.travel("drawer")),
    "CloseDrawer": lambda hand, world: demo_drawer.close_drawer(hand, world.part("drawer")),
    "TurnOnStove": lambda hand, world: demo_turn.turn_knob_on(hand, world.part("knob"), world.travel("knob")),
    "TurnOffStove": lambda hand, world: demo_turn.turn_knob_off(hand, world.part("knob")),
    "TurnOnSinkFaucet": lambda hand, world: demo_turn.turn_lever_on(hand, world.part("lever"), world.travel("lever")),
    "TurnOffSinkFaucet": lambda hand, world: demo_turn.turn_lever_off(hand, world.part("lever")),
}


def demonstrate(
    world: RoboCasaWorld, rng: np.random.Generator, *, person: Person | None = None, faults: Faults | None = None
) -> tuple[Scene, ...]:
    """One demonstration of the world's task, at 20 Hz, from the start pose back to about there.

    Parameters
    ----------
    world : RoboCasaWorld
        A fresh episode; it is played through.
    rng : numpy.random.Generator
        Decides on everything that people do differently.
    person, faults : optional
        Whose hand it is and what goes wrong; drawn when not given.

    Raises
    ------
    InputError
        Nobody knows how to do this task.
    """
    try:
        way = WAYS[world.task]
    except KeyError:
        raise InputError(f"task '{world.task}' cannot be demonstrated; there are: {alternatives(WAYS)}") from None
    hand = Hand(world, person or Person.draw(rng), faults or Faults.draw(rng), rng)
    hand.rest(float(rng.uniform(0.3, 0.8)))
    way(hand, world)
    return tuple(hand.scenes)
