"""Planner classes as somebody may write them."""

import time
from dataclasses import replace

from symskill_pddl.planning import Builtin, PlanResult, Status
from symskill_pddl.symbols import Plan


class Good:
    def solve(self, domain, problem, limits, extra_costs):
        return replace(Builtin().solve(domain, problem, limits, extra_costs), planner="good")


class Liar:
    def solve(self, domain, problem, limits, extra_costs):
        return PlanResult(Status.SOLVED, Plan())


class Raises:
    def solve(self, domain, problem, limits, extra_costs):
        raise KeyError("egg")


class Sleeps:
    def solve(self, domain, problem, limits, extra_costs):
        time.sleep(600)


class Nothing:
    def solve(self, domain, problem, limits, extra_costs):
        return None
