"""``--video``: a film of a run, drawn when the run is over."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from symskill_pddl.cli.console import progress, remark
from symskill_pddl.cli.options import output
from symskill_pddl.errors import InputError
from symskill_pddl.files import FILM

if TYPE_CHECKING:
    from symskill_pddl.arena import Film, Filmable, OpenEpisode


def check_video(path: Path | None, world: str, *, force: bool) -> None:
    """Find out before the work, not after it, that there could be no film."""
    if path is None:
        return
    arena = _filmable(world)
    if path.suffix != ".mp4":
        raise InputError(f"--video '{path}': a film is an MP4 file, give a name that ends in .mp4")
    output(path, FILM, force=force)
    arena.check_film()


@contextmanager
def filmed(episode: OpenEpisode, path: Path | None, world: str) -> Iterator[Film | None]:
    """Film what happens in an episode of a world, if there is a path to write it to."""
    if path is None:
        yield None
        return
    with _filmable(world).film(episode) as film:
        yield film
        with progress(f"drawing {len(film)} pictures", total=len(film)) as advance:
            film.save(path, advance)
    remark(f"{path}: written")


def _filmable(world: str) -> Filmable:
    from symskill_pddl.arena import Filmable
    from symskill_pddl.worlds import arena_named

    arena = arena_named(world)
    if not isinstance(arena, Filmable):
        raise InputError(f"--video: the world '{world}' cannot be filmed")
    return arena
