"""The command line: the only room that prints, exits or reads argv."""

from symskill_pddl.cli.app import main

__all__ = ["main"]
