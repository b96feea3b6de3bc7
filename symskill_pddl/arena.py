"""`Arena`: a world with tasks, in which demonstrations are recorded and episodes run and evaluated.

An evaluation knows a world by these protocols only. What not every world can do is a protocol of its own, and whether one can
is found out with `isinstance`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Literal, Protocol, Self, runtime_checkable

from symskill_pddl.demos import Demo, Truth
from symskill_pddl.scene import World

Kind = Literal["atomic", "composed", "play", "play goal"]
"""Of a task. 'atomic': there are demonstrations, and its goal is learned from them. 'composed': none; its goal is those of atomic
tasks together. 'play': demonstrated without a goal. 'play goal': not demonstrated; its goal is stated."""


@dataclass(frozen=True)
class Preset:
    """Tasks and disturbances that go by one name."""

    tasks: tuple[str, ...]
    disturbances: tuple[str, ...] = ()


class OpenEpisode(World, Protocol):
    """A world in which an episode of a task begins."""

    @property
    def task(self) -> str:
        """Name of the task."""

    @property
    def goals(self) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """The demonstrated tasks whose learned goals together are the goal, each with the objects that it is about."""

    @property
    def placements(self) -> tuple[tuple[str, str], ...]:
        """Of a task of kind 'play goal', instead: what is to be where."""

    @property
    def extents(self) -> Mapping[str, tuple[float, float, float]]:
        """Half sizes per type [m]; what has none is no obstacle."""

    def succeeded(self) -> bool:
        """The judge, who may look at more than `observe` shows. Asked once, when the run is over."""


@runtime_checkable
class Disturbed(Protocol):
    """An episode in which something can go wrong on purpose."""

    @property
    def events(self) -> Sequence[tuple[float, str]]:
        """What was done to the scene so far, and when it began [s]."""

    @property
    def touched_s(self) -> float:
        """How long the robot has touched an obstacle that was put in its way [s]."""

    def notify_step(self, k: int) -> None:
        """The executor starts its k-th operator (from 0): a disturbance may wait for it."""


@runtime_checkable
class Arena(Protocol):
    """A world with tasks. To make one costs nothing: a simulator is imported when an episode is opened."""

    @property
    def name(self) -> str:
        """How messages call it."""

    @property
    def tasks(self) -> Mapping[str, Kind]:
        """Its tasks, in the order of tables."""

    @property
    def presets(self) -> Mapping[str, Preset]:
        """Suites by name, besides those of all tasks of a kind."""

    def check_disturbance(self, spec: str) -> None:
        """Raise `InputError` if there is no such disturbance; an arena without any refuses them all."""

    def open(self, task: str, seed: int, disturbances: Sequence[str] = ()) -> OpenEpisode:
        """An episode of one of `tasks`, drawn from the seed; the same arguments give the same one.

        Raises
        ------
        InputError
            There is no such episode, or a disturbance is not possible in it.
        MissingDependencyError
            The simulator is not installed.
        """


@runtime_checkable
class Provided(Protocol):
    """An arena that needs what not everybody has: a simulator, its files."""

    def check_ready(self) -> None:
        """Find out before the work that no episode could be opened.

        Raises
        ------
        MissingDependencyError
            Something is not installed.
        InputError
            It is not where the user says.
        """


@runtime_checkable
class Recordable(Protocol):
    """An arena with a demonstrator."""

    def record(self, task: str, n: int, seed: int) -> tuple[Sequence[Demo], Mapping[str, Truth]]:
        """`n` demonstrations of a task, in episodes from `seed` on; and by their names what really happened, where that is known.

        Raises
        ------
        InputError
            A count below 1 or a negative seed, or too many episodes failed.
        """


class Film(Protocol):
    """A film that is being shot; a context."""

    caption: str
    """What stands below the coming pictures."""

    def __len__(self) -> int:
        """How many pictures there are."""

    def save(self, path: Path, advance: Callable[[int], object] = ...) -> None:
        """Draw them and write the film; `advance(1)` is called after each."""

    def __enter__(self) -> Self: ...

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None: ...


@runtime_checkable
class Filmable(Protocol):
    """An arena whose episodes can be filmed."""

    def check_film(self) -> None:
        """Find out before the work that a film could not be made."""

    def film(self, episode: OpenEpisode) -> Film:
        """Watches an episode of this arena from now on."""
