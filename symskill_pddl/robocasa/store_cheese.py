"""A task that RoboCasa does not have: a cheese is taken out of a shut cabinet and put on the counter, and the cabinet shut again.

It is RoboCasa's own `PickPlaceCabinetToCounter` with a cheese, the door shut at first, and two of RoboCasa's judges: that of the
task, and the fixture's `is_closed`.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from symskill_pddl.robocasa.backend import load_robocasa


@lru_cache(maxsize=1)
def register() -> None:
    """Make the environment known to robosuite by its name, `StoreCheese`: RoboCasa does so when the class is made."""
    load_robocasa()
    from robocasa.environments.kitchen.atomic.kitchen_pick_place import PickPlaceCabinetToCounter
    from robocasa.models.fixtures import FixtureType

    class StoreCheese(PickPlaceCabinetToCounter):  # type: ignore[misc]
        def __init__(self, *args: Any, **options: Any) -> None:
            super().__init__(*args, **{"cab_id": FixtureType.CABINET_SINGLE_DOOR, "obj_groups": "cheese"} | options)

        def _setup_scene(self) -> None:
            super()._setup_scene()
            self.cab.close_door(env=self)

        def _check_success(self) -> bool:
            return bool(super()._check_success() and self.cab.is_closed(env=self))
