"""Errors a user can act on.

Every message names the thing, where it is, and what exists instead, in one line. The command line prints it and exits with
`exit_status`; a library caller catches `SymSkillError`.
"""

import re
from collections.abc import Iterable

QUOTED = 300
"""Characters of somebody else's text that a message holds at most."""


class SymSkillError(Exception):
    """Base of all errors this package raises on purpose. One line, exit status 2."""

    exit_status = 2


class InputError(SymSkillError):
    """A file, name or argument given by the user is wrong."""


class FormatError(InputError):
    """A file exists but does not hold what its format asks for (damaged, truncated, another version)."""


class UnsafeError(FormatError):
    """A file that reaches for other files, or states what it cannot hold: no part of it is used."""


class ParseError(InputError):
    """A text (PDDL, plan) does not follow its grammar; carries line and column, counted from 1."""

    def __init__(self, message: str, *, source: str = "<text>", line: int = 0, column: int = 0) -> None:
        self.source, self.line, self.column = source, line, column
        where = f"{source}:{line}:{column}" if line else source
        super().__init__(f"{where}: {message}")


class LearningError(SymSkillError):
    """The demonstrations do not determine what was asked for (no motion, no grasp, no stable fit)."""


class CertificateError(LearningError):
    """A fitted motion field could not be certified stable; the message names the condition and by how much it failed."""


class MissingDependencyError(SymSkillError):
    """An optional package or system library is not installed; the message says what to install."""


class NoPlanError(SymSkillError):
    """The goal cannot be reached, or the planner gave up. Exit status 1, for it is an answer and not a bad input."""

    exit_status = 1


# C0 and C1 controls, marks that turn or hide what stands beside them, halves of characters
_UNSAFE = re.compile(
    "[\x00-\x1f\x7f-\x9f\xad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb\ud800-\udfff"
    "\U000e0000-\U000e0fff]"
)


def escaped(text: str, keep: str = "\n\t") -> str:
    """A text that does nothing to a terminal: control characters (those of `keep` apart), bidirectional and invisible marks
    are written as ``\\x1b``."""
    return _UNSAFE.sub(lambda found: found[0] if found[0] in keep else ascii(found[0])[1:-1], text)


def shown(text: object, limit: int = QUOTED) -> str:
    """Somebody else's text as a message may hold it: one line, `escaped`, of a long one the beginning and the end."""
    raw = str(text)
    # what is far too long is cut before it is worked on
    raw = raw if len(raw) <= 20 * limit else f"{raw[: 10 * limit]} {raw[-10 * limit :]}"
    line = escaped(" ".join(raw.split()), "")
    if len(line) <= limit:
        return line
    tail = limit // 4
    return f"{line[: limit - tail - 5]} ... {line[-tail:]}"


def alternatives(names: Iterable[str]) -> str:
    """The declared names, sorted, for the end of a message: ``"a, b, c"``, or ``"none"``; of very many, the first."""
    known = sorted(names)
    joined: list[str] = []
    length = 0
    for name in known:
        length += len(name) + 2
        if length > QUOTED and joined:
            return f"{', '.join(joined)}, ... ({len(known)} in all)"
        joined.append(name)
    return ", ".join(joined) or "none"
