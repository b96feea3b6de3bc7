"""What is compiled, and how often."""

from __future__ import annotations

from symskill_pddl import control
from symskill_pddl.skills import bending, hands, kernels


def forms() -> dict[str, int]:
    """How many forms there are of everything that is compiled."""
    everything = [value for module in (kernels, bending, hands, control) for value in vars(module).values()]
    return {f"{f.__module__}.{f.__name__}": len(f.signatures) for f in everything if hasattr(f, "signatures")}
