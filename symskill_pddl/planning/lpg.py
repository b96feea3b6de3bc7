"""`lpg`: the planner LPG-td, a local search. It cannot prove that there is no plan; its seed is fixed, so its plans repeat."""

from __future__ import annotations

from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path

from symskill_pddl.errors import MissingDependencyError
from symskill_pddl.planning.process import plan_files, run, work_folder
from symskill_pddl.planning.protocol import Limits, Status
from symskill_pddl.planning.text import Answer, Ask, Reader, Text
from symskill_pddl.symbols import Problem

_SEED = 1


@dataclass(frozen=True)
class LPG(Reader):
    """The program of up-lpg, asked for one plan."""

    family: str = field(default="lpg", init=False, repr=False)
    package: str = field(default="up-lpg", init=False, repr=False)
    module: str = field(default="up_lpg", init=False, repr=False)
    licence: str = field(default="Apache-2.0", init=False, repr=False)
    dialects: tuple[str, ...] = field(default=("negative", "costs", "strips"), init=False, repr=False)
    shorten: bool = field(default=True, init=False, repr=False)

    def load(self, text: Text) -> Ask:
        found = find_spec(self.module)
        if found is None or found.origin is None:
            raise MissingDependencyError("the planner 'lpg' is not installed; pip install 'symskill-pddl[planners]'")
        program = Path(found.origin).parent / "lpg"
        domain = text.domain

        def ask(problem: Problem, limits: Limits) -> Answer:
            with work_folder() as at:
                (at / "domain.pddl").write_text(domain, encoding="utf-8")
                (at / "problem.pddl").write_text(text.problem(problem), encoding="utf-8")
                words = [str(program), "-o", "domain.pddl", "-f", "problem.pddl", "-n", "1", "-out", "plan", "-seed", str(_SEED)]
                ended = run([*words, "-cputime", f"{limits.time_s:g}"], at, limits, time_s=limits.time_s)
                plans = [plan for plan in plan_files(at, "plan") if "no solution" not in plan.lower()]
            if plans:
                return Answer(Status.SOLVED, plans[-1])
            said = ended.output.lower()
            if ended.out_of_time or "max time exceeded" in said or "max cpu" in said:
                return Answer(Status.TIMEOUT)
            if ended.stopped:
                return Answer(Status.FAILED, messages=(f"lpg was ended: {ended.stopped}",))
            if "the problem is unsolvable" in said or "no plan will solve it" in said:
                return Answer(Status.UNSOLVABLE, messages=("lpg says that the goals exclude one another or cannot be reached",))
            return Answer(
                Status.FAILED, messages=(f"lpg ended with status {ended.status} and no plan; it said last: {ended.last_line}",)
            )

        return ask
