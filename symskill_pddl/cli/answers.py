"""What `symskill plan` says, as JSON; docs/planning.md describes the documents."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from symskill_pddl.planning.protocol import PlanResult
from symskill_pddl.symbols import Plan


def document(result: PlanResult, why: Sequence[str]) -> dict[str, Any]:
    """One planner's answer."""
    plan = result.plan
    return {
        "status": result.status.value,
        "planner": result.planner,
        "seconds": round(result.seconds, 4),
        "steps": None if plan is None else steps(plan),
        "cost": None if plan is None else plan.cost,
        "times": None if plan is None or plan.times is None else [[start, length] for start, length in plan.times],
        "messages": list(result.messages),
        "why_not": list(why),
    }


def steps(plan: Plan) -> list[list[str]]:
    """Each step as a list of words."""
    return [[name, *args] for name, args in plan.steps]


def rows(results: Iterable[PlanResult]) -> list[tuple[str, str, str, str, str]]:
    """One line of a table for each planner."""
    found = []
    for result in results:
        plan = result.plan
        length, cost = ("-", "-") if plan is None else (str(len(plan)), "-" if plan.cost is None else f"{plan.cost:g}")
        said = result.messages[0] if result.messages and plan is None else ""
        found.append((result.planner, result.status.value, length, cost, f"{result.seconds:.2f} {said}".strip()))
    return found
