"""``--video``: a film of a run, drawn when the run is over."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from symskill_pddl.cli.console import progress, remark
from symskill_pddl.cli.options import require_folder
from symskill_pddl.errors import InputError

if TYPE_CHECKING:
    from symskill_pddl.kitchen.film import Film
    from symskill_pddl.kitchen.world import Kitchen


def check_video(path: Path | None) -> None:
    """Find out before the work, not after it, that there could be no film."""
    if path is None:
        return
    from symskill_pddl.kitchen.film import check_film

    if path.suffix != ".mp4":
        raise InputError(f"--video '{path}': a film is an MP4 file, give a name that ends in .mp4")
    require_folder(path)
    check_film()


@contextmanager
def filmed(kitchen: Kitchen, path: Path | None) -> Iterator[Film | None]:
    """Film what happens in the kitchen, if there is a path to write it to."""
    if path is None:
        yield None
        return
    from symskill_pddl.kitchen.film import Film

    with Film(kitchen) as film:
        yield film
        with progress(f"drawing {len(film)} pictures", total=len(film)) as advance:
            film.save(path, advance)
    remark(f"{path}: written")
