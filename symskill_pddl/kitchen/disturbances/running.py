"""A disturbance in action: when it begins, and what it does in each control period."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy.random import default_rng

from symskill_pddl.kitchen.disturbances.kind import Doing
from symskill_pddl.kitchen.disturbances.spec import Disturbance

if TYPE_CHECKING:
    from symskill_pddl.kitchen.world import Kitchen


class Running:
    """One disturbance of one episode.

    It begins at its time, or from then on as soon as it is possible: nothing can be dropped before something is held, and no
    door be shut before it is open. With a probability it is drawn again when the last one is over.

    Parameters
    ----------
    seed : int
        The episode's. All that is drawn (moments, directions, noise) comes from it, the spec and `number`.
    number : int
        Which of the episode's disturbances it is, for two of the same text are not to do the same.
    """

    def __init__(self, disturbance: Disturbance, seed: int, number: int = 0) -> None:
        self.disturbance = disturbance
        self._rng = default_rng([seed, number, *disturbance.spec.encode()])
        self._due = False
        self._count = 0
        self._effect: Doing | None = None

    def operator_started(self, k: int) -> None:
        """The executor starts its k-th operator."""
        self._due = self._due or (k == self.disturbance.when.step and self._left())

    def act(self, kitchen: Kitchen) -> None:
        """Do what is to be done in the coming control period."""
        if self._effect is None and self._begins(kitchen):
            self._effect = self.disturbance.kind.effect(kitchen, self.disturbance.arguments, self._rng)
            if self._effect is not None:
                self._due, self._count = False, self._count + 1
                kitchen.note(self.disturbance.spec)
        if self._effect is not None and next(self._effect, self) is self:
            self._effect = None

    def _left(self) -> bool:
        times = self.disturbance.when.times
        return times is None or self._count < times

    def _begins(self, kitchen: Kitchen) -> bool:
        when = self.disturbance.when
        if not self._due and self._left():
            if when.time_s is not None:
                self._due = kitchen.time >= when.time_s - 1e-9
            elif when.chance is not None:
                self._due = bool(self._rng.random() < when.chance)
        return self._due
