"""The kinematic world of `fake_world` as an `Arena` without physics, demonstrator, disturbances or films, and its library."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from fake_world import CABINET, COUNTER, FakeWorld, at, make_library

from symskill_pddl.arena import Kind, Preset
from symskill_pddl.errors import InputError
from symskill_pddl.library import Goal, Library
from symskill_pddl.symbols import Atom, Parameter

OPEN = 1.5
"""The angle of an open door [rad]."""
GOALS = {"OpenUp": (("OpenUp", ("door", "cabinet")),), "PutIn": (("PutIn", ("cheese", "cabinet")),)}
GOALS["StoreIt"] = GOALS["OpenUp"] + GOALS["PutIn"]


class ToyEpisode(FakeWorld):
    """The cheese lies somewhere on the counter; the door is open where the task begins so."""

    def __init__(self, task: str, seed: int) -> None:
        aside = np.random.default_rng(seed).uniform(-0.02, 0.02)
        super().__init__(cheese=at(COUNTER[0] + aside, COUNTER[1], 0.03), angle=OPEN if task == "PutIn" else 0.0)
        self.task, self.goals = task, GOALS[task]
        self.placements: tuple[tuple[str, str], ...] = ()
        self.extents: dict[str, tuple[float, float, float]] = {}

    def succeeded(self) -> bool:
        opened = self.angle > OPEN - 0.2
        inside = self.grasp is None and bool(np.linalg.norm(self.cheese.p - CABINET) < 0.1)
        return {"OpenUp": opened, "PutIn": inside, "StoreIt": opened and inside}[self.task]


class ToyArena:
    """All that an arena has to have."""

    name = "toy"
    tasks: Mapping[str, Kind] = {"OpenUp": "atomic", "PutIn": "atomic", "StoreIt": "composed"}
    presets: Mapping[str, Preset] = {"both": Preset(("OpenUp", "PutIn"))}

    def check_disturbance(self, spec: str) -> None:
        raise InputError(f"disturbance '{spec}': nothing goes wrong in the toy world")

    def open(self, task: str, seed: int, disturbances: Sequence[str] = ()) -> ToyEpisode:
        return ToyEpisode(task, seed)


ARENA = ToyArena()
NO_ARENA = FakeWorld


def toy_library() -> Library:
    """The hand-made library of the fake world, with the goals that demonstrations of the tasks would have had."""
    door, cabinet, food = (Parameter(f"?{kind}", kind) for kind in ("door", "cabinet", "food"))
    opened, inside = Atom("door-open", ("?door", "?cabinet")), Atom("food-in-cabinet", ("?food", "?cabinet"))
    goals = (Goal("OpenUp", (door, cabinet), frozenset({opened})), Goal("PutIn", (food, cabinet), frozenset({inside})))
    return replace(make_library(), goals=goals)
