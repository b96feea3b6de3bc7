"""`fast-downward`: the planner Fast Downward; its translator and its search, each a process of its own, without the driver.

Lazy greedy search with FF's heuristic and preferred operators; ``fast-downward:optimal`` is A* with LM-cut.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path

from symskill_pddl.errors import MissingDependencyError
from symskill_pddl.planning.process import Ended, plan_files, run, work_folder
from symskill_pddl.planning.protocol import Limits, Status
from symskill_pddl.planning.text import Answer, Ask, Reader, Text
from symskill_pddl.symbols import Problem

_GREEDY = "let(hff,ff(),lazy_greedy([hff],preferred=[hff],cost_type=plusone,reopen_closed=false))"
_OPTIMAL = "astar(lmcut())"
_UNSOLVABLE = frozenset({10, 11})
_EXHAUSTED = frozenset({12})
"""Exit status of a search that has seen every state it could, under a heuristic that may be wrong about dead ends."""
_OUT_OF_TIME = frozenset({21, 23})
_UNSUPPORTED = 34
_TRANSLATE = (
    "import runpy, sys; sys.path.insert(0, sys.argv.pop(1)); runpy.run_module('fast_downward.translate', run_name='__main__')"
)


@dataclass(frozen=True)
class FastDownward(Reader):
    """The search programs of up-fast-downward under limits of time and memory."""

    optimal: bool = False
    family: str = field(default="fast-downward", init=False, repr=False)
    package: str = field(default="up-fast-downward", init=False, repr=False)
    module: str = field(default="up_fast_downward", init=False, repr=False)
    licence: str = field(default="GPL-3.0-only", init=False, repr=False)

    @property
    def name(self) -> str:
        return f"{super().name}:optimal" if self.optimal else super().name

    def load(self, text: Text) -> Ask:
        folder, site = self._places()
        search = folder / "downward" / "builds" / "release" / "bin" / "downward"
        domain = text.domain

        def ask(problem: Problem, limits: Limits) -> Answer:
            deadline = time.monotonic() + limits.time_s
            with work_folder() as at:
                (at / "domain.pddl").write_text(domain, encoding="utf-8")
                (at / "problem.pddl").write_text(text.problem(problem), encoding="utf-8")
                translate = [sys.executable, "-I", "-S", "-c", _TRANSLATE, str(site), "domain.pddl", "problem.pddl"]
                ended = run([*translate, "--sas-file", "task.sas"], at, limits, time_s=limits.time_s)
                if ended.status == 0:
                    config = _OPTIMAL if self.optimal else _GREEDY
                    words = [str(search), "--search", config, "--internal-plan-file", "plan.txt"]
                    ended = run(words, at, limits, time_s=deadline - time.monotonic(), stdin=at / "task.sas")
                plans = plan_files(at, "plan.txt") if ended.status == 0 else ()
            return Answer(Status.SOLVED, plans[-1]) if plans else _no_plan(ended, axioms="(forall" in domain)

        return ask

    def _places(self) -> tuple[Path, Path]:
        """The folder of the search, and the one that holds the translator."""
        found, translator = find_spec(self.module), find_spec("fast_downward")
        if found is None or found.origin is None or translator is None or not translator.submodule_search_locations:
            raise MissingDependencyError("the planner 'fast-downward' is not installed; pip install 'symskill-pddl[planners]'")
        return Path(found.origin).parent, Path(next(iter(translator.submodule_search_locations))).parent


def _no_plan(ended: Ended, *, axioms: bool) -> Answer:
    status = ended.status
    if ended.out_of_time or status in _OUT_OF_TIME:
        return Answer(Status.TIMEOUT)
    if ended.stopped:
        return Answer(Status.FAILED, messages=(f"fast-downward was ended: {ended.stopped}",))
    if status in _UNSOLVABLE or (status in _EXHAUSTED and not axioms):
        # FF's heuristic is infinite only where the relaxed problem has no plan; with axioms, which `forall` becomes, it may err
        return Answer(Status.UNSOLVABLE, messages=(f"fast-downward ended with status {status}: no plan exists",))
    if status == _UNSUPPORTED:
        return Answer(
            Status.FAILED, messages=("this search of fast-downward does not support the domain's quantified conditions",)
        )
    return Answer(Status.FAILED, messages=(f"fast-downward ended with status {status}; it said last: {ended.last_line}",))
