"""Errors a user can act on.

Every message names the thing, where it is, and what exists instead, in one line. The command line prints it and exits with
`exit_status`; a library caller catches `SymSkillError`.
"""

from collections.abc import Iterable


class SymSkillError(Exception):
    """Base of all errors this package raises on purpose. One line, exit status 2."""

    exit_status = 2


class InputError(SymSkillError):
    """A file, name or argument given by the user is wrong."""


class FormatError(InputError):
    """A file exists but does not hold what its format asks for (damaged, truncated, another version)."""


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


def alternatives(names: Iterable[str]) -> str:
    """The declared names, sorted, for the end of a message: ``"a, b, c"``, or ``"none"``."""
    return ", ".join(sorted(names)) or "none"
