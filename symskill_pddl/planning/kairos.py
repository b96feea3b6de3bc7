"""`kairos`: the planner Kairos, in a process of its own. Fast on large problems; it proves unsolvability where it can."""

from __future__ import annotations

from dataclasses import dataclass, field

from symskill_pddl.planning.protocol import Limits
from symskill_pddl.planning.text import Answer, Ask, Reader, Text, answered
from symskill_pddl.planning.worker import Remote
from symskill_pddl.symbols import Problem


@dataclass(frozen=True)
class Kairos(Reader):
    """The first plan that Kairos finds, cleared of detours."""

    search: str = "auto"
    """One of Kairos's own names for a way to search."""
    family: str = field(default="kairos", init=False, repr=False)
    package: str = field(default="kairos-planner", init=False, repr=False)
    module: str = field(default="kairos", init=False, repr=False)
    licence: str = field(default="Apache-2.0", init=False, repr=False)
    dialects: tuple[str, ...] = field(default=("negative", "costs", "strips", "temporal"), init=False, repr=False)
    shorten: bool = field(default=True, init=False, repr=False)

    def load(self, text: Text) -> Ask:
        self.required()
        remote = Remote("symskill_pddl.engines.kairos", {"domain": text.domain})

        def ask(problem: Problem, limits: Limits) -> Answer:
            written = text.problem(problem)
            return answered(remote.ask(limits.time_s, limits.memory_mb, problem=written, search=self.search))

        return ask
