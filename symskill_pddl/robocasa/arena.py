"""RoboCasa as an `Arena`: what an evaluation and the command line know of it. Importing it needs no simulator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from symskill_pddl.arena import Kind, Preset
from symskill_pddl.demos import Demo, Truth
from symskill_pddl.errors import InputError
from symskill_pddl.robocasa.tasks import TASKS

if TYPE_CHECKING:
    from symskill_pddl.robocasa.world import RoboCasaWorld


class RoboCasaArena:
    """`Arena`, `Provided` and `Recordable`: episodes in RoboCasa's target kitchens, demonstrations in its training kitchens."""

    name = "robocasa"
    presets: Mapping[str, Preset] = {}

    @property
    def tasks(self) -> Mapping[str, Kind]:
        """Its tasks, in the order of tables."""
        return {name: "composed" if spec.composed else "atomic" for name, spec in TASKS.items()}

    def check_disturbance(self, spec: str) -> None:
        """There are none."""
        raise InputError(f"disturbance '{spec}': nothing goes wrong on purpose in the world 'robocasa'")

    def check_ready(self) -> None:
        """RoboCasa and assets are there."""
        from symskill_pddl.robocasa.backend import assets_folder

        assets_folder()

    def open(self, task: str, seed: int, disturbances: Sequence[str] = ()) -> RoboCasaWorld:
        """An episode of a task."""
        for spec in disturbances:
            self.check_disturbance(spec)
        from symskill_pddl.robocasa.world import open_world

        return open_world(TASKS[task], seed)

    def record(self, task: str, n: int, seed: int) -> tuple[Sequence[Demo], Mapping[str, Truth]]:
        """Demonstrations; what really happened in them is not known."""
        from symskill_pddl.robocasa.record import record

        return record(task, n, seed), {}


ARENA = RoboCasaArena()
