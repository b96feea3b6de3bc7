"""What `symskill plan` says: one answer, every planner's, or several plans; as text or as JSON (docs/planning.md)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from symskill_pddl.cli.console import progress, remark, say, table
from symskill_pddl.pddl.plan import write_plan
from symskill_pddl.pddl.task import Task
from symskill_pddl.planning import Limits, Planner, PlanResult, planners
from symskill_pddl.planning.diverse import diverse
from symskill_pddl.planning.foreign import explained, solve
from symskill_pddl.symbols import Plan

FORMAT, VERSION = "symskill-plan", 1


@dataclass(frozen=True)
class Answers:
    """Results, and how to show them."""

    results: tuple[PlanResult, ...]
    why: tuple[str, ...] = ()
    kind: str = "one"
    """"one", "engines" or "plans"."""

    @property
    def best(self) -> Plan | None:
        """The plan to be written: of several planners the cheapest, else the first."""
        plans = [r.plan for r in self.results if r.plan is not None]
        if self.kind != "engines":
            return plans[0] if plans else None
        return min(plans, key=lambda p: (float("inf") if p.cost is None else p.cost, len(p)), default=None)

    @property
    def status(self) -> str:
        """Of what has no plan."""
        if self.kind == "engines":
            return ", ".join(f"{r.planner} {r.status.value}" for r in self.results)
        return f"{self.results[0].status.value} (planner {self.results[0].planner})"

    def document(self) -> dict[str, Any]:
        """One JSON object."""
        head = {"format": FORMAT, "version": VERSION}
        if self.kind == "one":
            return {**head, **_document(self.results[0], self.why)}
        return {**head, self.kind: [_document(result, ()) for result in self.results]}

    def show(self) -> None:
        """Print what was asked for: a plan, a table, or plans one after another."""
        if self.kind == "engines":
            table("", ("planner", "status", "steps", "cost", "seconds"), [_row(result) for result in self.results])
            return
        for number, result in enumerate(self.results, start=1):
            if len(self.results) > 1:
                say(f"; plan {number}")
            if result.plan is not None:
                say(write_plan(result.plan).rstrip("\n"))

    def tell(self) -> None:
        """Remarks: how long it took, by whom, and what was said."""
        if self.kind == "engines":
            for result in (r for r in self.results if r.plan is None and r.messages):
                remark(f"{result.planner}: {result.messages[0]}")
            return
        for result in self.results:
            if result.plan is not None:
                count = len(result.plan)
                remark(f"{count} step{'' if count == 1 else 's'} in {result.seconds:.3f} s (planner {result.planner})")
        for line in (*self.results[0].messages, *self.why):
            remark(line)


def one(planner: Planner, task: Task, limits: Limits, *, any_plan: bool) -> Answers:
    """One planner's answer."""
    with progress(f"planning with {planner.name}"):
        result = solve(planner, task, limits, any_plan=any_plan)
    return Answers((result,), explained(task, result))


def of_all(task: Task, limits: Limits, *, any_plan: bool) -> Answers:
    """Every installed planner's answer, but `auto`'s, which is one of theirs."""
    found = []
    for planner in (p for p in planners() if p.name != "auto"):
        with progress(f"planning with {planner.name}"):
            found.append(solve(planner, task, limits, any_plan=any_plan))
    return Answers(tuple(found), kind="engines")


def several(planner: Planner, task: Task, count: int, limits: Limits) -> Answers:
    """Plans that differ in a step."""
    with progress(f"planning with {planner.name}"):
        return Answers(tuple(diverse(planner, task, count, limits)), kind="plans")


def _document(result: PlanResult, why: Sequence[str]) -> dict[str, Any]:
    plan = result.plan
    return {
        "status": result.status.value,
        "planner": result.planner,
        "seconds": round(result.seconds, 4),
        "steps": None if plan is None else [[name, *args] for name, args in plan.steps],
        "cost": None if plan is None else plan.cost,
        "times": None if plan is None or plan.times is None else [[start, length] for start, length in plan.times],
        "messages": list(result.messages),
        "why_not": list(why),
    }


def _row(result: PlanResult) -> tuple[str, str, str, str, str]:
    plan = result.plan
    length, cost = ("-", "-") if plan is None else (str(len(plan)), "-" if plan.cost is None else f"{plan.cost:g}")
    return result.planner, result.status.value, length, cost, f"{result.seconds:.2f}"
