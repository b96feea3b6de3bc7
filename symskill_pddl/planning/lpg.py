"""`lpg`: the planner LPG-td, a local search. It cannot prove that there is no plan; its seed is fixed, so its plans repeat."""

from __future__ import annotations

from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from symskill_pddl.errors import MissingDependencyError
from symskill_pddl.planning.process import last_line, run
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
            with TemporaryDirectory(prefix="symskill-") as name:
                at = Path(name)
                (at / "domain.pddl").write_text(domain, encoding="utf-8")
                (at / "problem.pddl").write_text(text.problem(problem), encoding="utf-8")
                words = [str(program), "-o", "domain.pddl", "-f", "problem.pddl", "-n", "1", "-out", "plan", "-seed", str(_SEED)]
                output = at / "output.txt"
                status = run([*words, "-cputime", f"{limits.time_s:g}"], at, output, limits, time_s=limits.time_s)
                plan = _plan(at)
                if plan:
                    return Answer(Status.SOLVED, plan)
                if status is None:
                    return Answer(Status.TIMEOUT)
                said = output.read_text(encoding="utf-8", errors="replace")
                if "Max time exceeded" in said or "max cpu" in said.lower():
                    return Answer(Status.TIMEOUT)
                if "the problem is unsolvable" in said.lower() or "No plan will solve it" in said:
                    return Answer(
                        Status.UNSOLVABLE, messages=("lpg says that the goals exclude one another or cannot be reached",)
                    )
                return Answer(
                    Status.FAILED, messages=(f"lpg ended with status {status} and no plan; it said last: {last_line(output)}",)
                )

        return ask


def _plan(folder: Path) -> str:
    """The plan's text; empty where LPG wrote none, or wrote that there is no solution."""
    for name in ("plan_1.SOL", "plan"):
        if (path := folder / name).exists():
            text = path.read_text(encoding="utf-8", errors="replace")
            if "no solution" not in text.lower():
                return text
    return ""
