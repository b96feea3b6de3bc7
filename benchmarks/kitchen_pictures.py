"""Pictures of how every task of the kitchen starts and ends, for docs/kitchen.md.

    python benchmarks/kitchen_pictures.py [TASK ...] [-o docs/kitchen]

A task ends as the demonstrator leaves it; a composed one is done piece by piece, in an order that people would choose. Goals in
the scene of play are set up as they should end. Says of each whether its judge accepts it. Needs EGL or OSMesa.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image

from symskill_pddl.demonstrator.hand import Hand
from symskill_pddl.demonstrator.human import Faults, Person
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import TASKS, make, task_named
from symskill_pddl.kitchen.demonstrator import WAYS, demonstrate
from symskill_pddl.kitchen.loose import Lid, Vessel
from symskill_pddl.kitchen.render import Camera
from symskill_pddl.kitchen.world import Kitchen

SEED = 0
OPEN, SHUT = ("OpenSingleDoor", "door"), ("CloseSingleDoor", "door")
PIECES = {
    "StoreCheese": (OPEN, ("PnPCabToCounter", "cheese"), SHUT),
    "PutCheeseAway": (OPEN, ("PnPCounterToCab", "cheese"), SHUT),
    "MakeBreakfast": (
        ("OpenDrawer", "drawer"),
        ("PnPCounterToStove", "bread"),
        ("TurnOnStove", "knob"),
        OPEN,
        ("PnPCabToCounter", "cheese"),
    ),
    "CookDinner": (
        ("TurnOnSinkFaucet", "lever"),
        ("OpenDrawer", "drawer"),
        ("PnPStoveToCounter", "can"),
        ("PnPCounterToStove", "butter"),
        ("PnPCounterToStove", "bread", "pan-2"),
        ("TurnOnStove", "knob"),
        ("TurnOnStove", "knob-2"),
        OPEN,
        ("PnPCabToCounter", "cheese"),
        SHUT,
    ),
}


def piece_by_piece(kitchen: Kitchen, rng: np.random.Generator) -> None:
    """One after the other, by one unhurried person."""
    hand = Hand(kitchen, Person(), Faults(), rng)
    for task, *names in PIECES[kitchen.task]:
        WAYS[task](hand, *names)


def arrange(kitchen: Kitchen) -> None:
    """Put what is to be where there."""
    physics = kitchen.physics
    for name, where in kitchen.spec.goal_at:
        thing = physics.scene.loose[name]
        place = physics.scene.loose[where].shape
        assert isinstance(place, Vessel)
        z = place.rim_z - thing.shape.seat_z if isinstance(thing.shape, Lid) else place.floor_z + thing.half[2]
        physics.set_loose(name, physics.T_world(where) @ Pose(np.array([0.0, 0.0, z]), np.array([1.0, 0.0, 0.0, 0.0])))
    physics.forward()


def ways() -> dict[str, Callable[[Kitchen], object]]:
    """What leads from the start of each kind of task to its end."""
    return {
        "atomic": lambda kitchen: demonstrate(kitchen, np.random.default_rng([SEED, 1])),
        "composed": lambda kitchen: piece_by_piece(kitchen, np.random.default_rng([SEED, 1])),
        "play goal": arrange,
        # free play has no end of its own
        "play": arrange,
    }


def picture(task: str, folder: Path, size: tuple[int, int] = (400, 300)) -> bool:
    """Start and end side by side; whether the judge accepts the end."""
    kitchen = make(task, SEED)
    # the knob and the lever are small, and on the right
    view = Camera(kitchen, "right" if {"knob", "lever"} & {kitchen.focus[0]} else "close", *size)
    start = view.image()
    ways()[kitchen.spec.kind](kitchen)
    both = np.concatenate([start, np.full((size[1], 6, 3), 255, np.uint8), view.image()], axis=1)
    view.close()
    Image.fromarray(both).save(folder / f"{task}.jpg", quality=82)
    return kitchen.succeeded()


def main() -> None:
    """Read the arguments and draw."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("tasks", nargs="*", default=list(TASKS), metavar="TASK")
    parser.add_argument("-o", "--output", type=Path, default=Path("docs/kitchen"))
    arguments = parser.parse_args()
    for task in arguments.tasks:
        task_named(task)
    arguments.output.mkdir(parents=True, exist_ok=True)
    for task in arguments.tasks:
        print(f"{task}: {'success' if picture(task, arguments.output) else 'no success'}", flush=True)


if __name__ == "__main__":
    main()
