"""Somebody's own planner: a class with the method `solve` of `planning.Planner`."""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any


def load(module: str, name: str, folder: str) -> Callable[..., tuple[str, Any, tuple[str, ...]]]:
    """Import the class and make one of it, without arguments; modules are looked for in `folder` too."""
    if folder not in sys.path:
        sys.path.append(folder)
    planner = getattr(import_module(module), name)()

    def ask(domain: Any, problem: Any, limits: Any, extra_costs: Any, **_: Any) -> tuple[str, Any, tuple[str, ...]]:
        found = planner.solve(domain, problem, limits, extra_costs)
        steps = None if found.plan is None else tuple((name, tuple(args)) for name, args in found.plan.steps)
        return found.status.value, steps, tuple(map(str, found.messages))

    return ask
