"""All that is written to disk goes through here: a write is whole or not there, and nothing that is not ours is lost by it."""

from symskill_pddl.files.atomic import draft, make_folder, open_locked, write_atomic
from symskill_pddl.files.folder import Shape, Writer, remove_empty, writing
from symskill_pddl.files.output import (
    DEMOS,
    DOMAIN,
    DRAWING,
    FILM,
    NAMES,
    PAGE,
    PICTURE,
    PLAN,
    PROBLEM,
    RESULTS,
    TRACE,
    Kind,
    Output,
    Replace,
    sealed,
)

__all__ = [
    "DEMOS",
    "DOMAIN",
    "DRAWING",
    "FILM",
    "NAMES",
    "PAGE",
    "PICTURE",
    "PLAN",
    "PROBLEM",
    "RESULTS",
    "TRACE",
    "Kind",
    "Output",
    "Replace",
    "Shape",
    "Writer",
    "draft",
    "make_folder",
    "open_locked",
    "remove_empty",
    "sealed",
    "write_atomic",
    "writing",
]
