"""What a kind of disturbance is."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from numpy import random

if TYPE_CHECKING:
    from symskill_pddl.kitchen.world import Kitchen


@dataclass(frozen=True)
class Arguments:
    """Numbers by SI unit, and the object it is about, if one was named."""

    values: Mapping[str, float]
    about: str | None = None

    def __getitem__(self, unit: str) -> float:
        return self.values[unit]


Doing = Generator[None, None, None]
"""What is done, one item per control period; what was set up for it is taken away when it is exhausted or closed."""
Effect = Callable[["Kitchen", Arguments, random.Generator], Doing | None]
"""Called before a control period. None: not possible now."""


@dataclass(frozen=True)
class Kind:
    """A kind of disturbance.

    Attributes
    ----------
    effect : Effect
    defaults : mapping of str to float
        Its arguments: SI unit to default.
    needs : tuple of str
        Types of which the scene has to have an object each.
    part : str or None
        A part, by its name, that the scene has to have.
    nameable : bool
        Whether an argument may name the object that it is about.
    adds : mapping of str to str
        Objects, with their types, that are in the scene because of it.
    concerns : callable
        Whether a task about these objects (its focus) is disturbed by it at all.
    """

    effect: Effect
    defaults: Mapping[str, float] = field(default_factory=dict)
    needs: tuple[str, ...] = ()
    part: str | None = None
    nameable: bool = False
    adds: Mapping[str, str] = field(default_factory=dict)
    concerns: Callable[[tuple[str, ...]], bool] = lambda _: True

    def lacks(self, objects: Mapping[str, str]) -> list[str]:
        """What it needs and is not among the objects, given by name with their types."""
        # by its name: other things share the types of parts
        part = [self.part] if self.part is not None and self.part not in objects else []
        return part + [t for t in self.needs if t not in objects.values()]


def periods(kitchen: Kitchen, seconds: float) -> Doing:
    """One item for every control period within a time [s]; without end if it is infinite."""
    start = kitchen.time
    while kitchen.time - start < seconds - 1e-9:
        yield
