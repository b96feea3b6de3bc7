"""Worlds by name: the one place that lists them. Each is imported when it is asked for, and knows nothing of the others."""

from __future__ import annotations

from functools import lru_cache
from importlib import import_module
from typing import TYPE_CHECKING

from symskill_pddl.errors import InputError, alternatives

if TYPE_CHECKING:
    from symskill_pddl.arena import Arena

ARENAS = {"kitchen": "symskill_pddl.kitchen.arena:ARENA", "robocasa": "symskill_pddl.robocasa.arena:ARENA"}
"""Where each is: the module, and what the arena is called there."""
DEFAULT = "kitchen"
"""Where nothing else is said."""
MAX_SEED = 2**31 - 1
"""What the random generators of every world take."""


@lru_cache
def arena_named(name: str) -> Arena:
    """An arena of the table, or of somebody else, as ``MODULE:NAME``.

    Raises
    ------
    InputError
        There is none of that name, or what is there is no arena.
    MissingDependencyError
        It needs something that is not installed.
    """
    from symskill_pddl.arena import Arena

    where = ARENAS.get(name, name)
    module, colon, attribute = where.partition(":")
    # a leading dot would be relative to a package, and there is none here
    if not (module and colon and attribute) or module.startswith("."):
        raise InputError(f"unknown world '{name}'; there are: {alternatives(ARENAS)}; or say MODULE:NAME for one of your own")
    try:
        found = getattr(import_module(module), attribute)
    except (ImportError, AttributeError) as error:
        raise InputError(f"world '{name}': {error}") from error
    if not isinstance(found, Arena):
        members = alternatives(member for member in vars(Arena) if not member.startswith("_"))
        raise InputError(f"world '{name}': what is there is no arena, which has: {members}")
    return found


def check_seed(seed: int) -> None:
    """Raise `InputError` for a seed that no world takes."""
    if seed < 0:
        raise InputError(f"a seed is at least 0, got {seed}")
    if seed > MAX_SEED:
        raise InputError(f"a seed is at most {MAX_SEED}, got {seed}")


def ready(name: str, task: str | None = None) -> Arena:
    """An arena that has what it needs to open an episode, of a task that it has.

    Raises
    ------
    InputError
        As `arena_named`; no such task; or something is not where the user says.
    MissingDependencyError
        The world needs something that is not installed.
    """
    from symskill_pddl.arena import Provided

    arena = arena_named(name)
    if task is not None:
        check_task(arena, task)
    if isinstance(arena, Provided):
        arena.check_ready()
    return arena


def check_task(arena: Arena, task: str) -> None:
    """Raise `InputError` if the arena has no such task."""
    if task not in arena.tasks:
        raise InputError(f"unknown task '{task}'; the world '{arena.name}' has: {alternatives(arena.tasks)}")
