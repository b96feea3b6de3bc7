"""Kairos: the first plan that it finds. An anytime planner, which it is by default, would use up the time on better ones."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import kairos

_STATUS = {"UNSOLVABLE": "unsolvable", "TIMEOUT": "timeout", "CANCELLED": "timeout"}


def load(domain: str) -> Callable[..., tuple[str, Any, tuple[str, ...]]]:
    """Read a domain."""
    try:
        parsed = kairos.parse_domain(domain)
    except kairos.PddlError as refused:
        why = f"kairos does not read the domain: {_line(refused)}"
        return lambda **_: ("failed", None, (why,))

    def ask(problem: str, time_s: float, search: str = "auto") -> tuple[str, Any, tuple[str, ...]]:
        """One problem; `search` is one of Kairos's own names for a way to search."""
        try:
            posed = kairos.parse_problem(problem, parsed)
        except kairos.PddlError as refused:
            return "failed", None, (f"kairos does not read the problem: {_line(refused)}",)
        # `start` and `wait_first` wake up at once; `solve` looks every five milliseconds
        planner: Any = kairos.Planner
        running = planner().start(posed, timeout=time_s, anytime=False, threads=1, search=search)
        plan = running.wait_first(time_s)
        if plan is None:  # not `if not plan`: a plan without steps is false
            running.stop()
            found = running.wait()
            plan = found.plan
            if plan is None:
                name = found.status.name
                said = tuple(_line(d) for d in found.diagnostics)
                return _STATUS.get(name, "failed"), None, (f"kairos says '{name.lower()}'", *said)
        if plan.temporal:
            return "solved", "".join(map(_timed, sorted(plan.steps, key=lambda step: step.time))), ()
        return "solved", tuple((step.name, tuple(step.args)) for step in plan.steps), ()

    return ask


def _timed(step: Any) -> str:
    length = "" if step.duration is None else f" [{step.duration:.6f}]"
    return f"{step.time:.6f}: ({' '.join((step.name, *step.args))}){length}\n"


def _line(said: object) -> str:
    return " ".join(str(said).split())
