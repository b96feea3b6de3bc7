"""`warm`: compile before a robot moves, not while it does."""

from __future__ import annotations


def warm() -> None:
    """Get all that is compiled ready: half a minute in the first run after an installation, half a second later."""
    from symskill_pddl.skills import bending, hands, kernels  # noqa: F401
