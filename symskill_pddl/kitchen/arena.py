"""The kitchen as an `Arena`: what an evaluation and the command line know of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

from numpy.random import default_rng

from symskill_pddl.arena import Kind as TaskKind
from symskill_pddl.arena import OpenEpisode, Preset
from symskill_pddl.demos import Demo, Truth
from symskill_pddl.kitchen import TASKS, make, parse_disturbance
from symskill_pddl.kitchen.disturbances import ANY, KINDS, Kind

if TYPE_CHECKING:
    from symskill_pddl.kitchen.film import Film
    from symskill_pddl.kitchen.world import Kitchen


class KitchenArena:
    """Implements `Arena`, `Recordable` and `Filmable`."""

    name = "kitchen"

    @property
    def tasks(self) -> Mapping[str, TaskKind]:
        """Its tasks, in the order of tables."""
        return {name: spec.kind for name, spec in TASKS.items()}

    @cached_property
    def presets(self) -> Mapping[str, Preset]:
        """Suites with disturbances."""
        return {
            # when the fifth step starts the door has just been opened, and the hand is about to reach inside
            "disturbed": Preset(("StoreCheese",), ("close-door@op=4",)),
            # each disturbance once, at a moment that is drawn, in every task that it concerns
            **{name: Preset(_concerned(kind), (f"{name}@p=0.02x1",)) for name, kind in KINDS.items() if name != ANY},
            # one of all, every ten seconds on average
            "mixed": Preset(_concerned(KINDS[ANY]), (f"{ANY}@p=0.005",)),
        }

    def check_disturbance(self, spec: str) -> None:
        """Raise `InputError` if there is no such disturbance."""
        parse_disturbance(spec)

    def open(self, task: str, seed: int, disturbances: Sequence[str] = ()) -> Kitchen:
        """An episode; see `symskill_pddl.kitchen.make`."""
        return make(task, seed, disturbances)

    def record(self, task: str, n: int, seed: int) -> tuple[Sequence[Demo], Mapping[str, Truth]]:
        """Demonstrations; see `symskill_pddl.kitchen.record`."""
        from symskill_pddl.kitchen.record import record_with_truth

        return record_with_truth(task, n, seed)

    def check_film(self) -> None:
        """Find out before the work that a film could not be made."""
        from symskill_pddl.kitchen.film import check_film

        check_film()

    def film(self, episode: OpenEpisode) -> Film:
        """Watches an episode from now on."""
        from symskill_pddl.kitchen.film import Film
        from symskill_pddl.kitchen.world import Kitchen

        assert isinstance(episode, Kitchen), "an episode of another arena"
        return Film(episode)


def _concerned(kind: Kind) -> tuple[str, ...]:
    """The tasks that a kind of disturbance concerns, as far as one episode tells; of play only if it concerns no others."""

    def found(*kinds: TaskKind) -> tuple[str, ...]:
        tasks = [spec for spec in TASKS.values() if spec.kind in kinds]
        return tuple(spec.name for spec in tasks if kind.concerns(spec.draw(default_rng(0)).focus))

    return found("atomic", "composed") or found("play goal")


ARENA = KitchenArena()
