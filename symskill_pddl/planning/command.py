"""`command:TEMPLATE`: any planner that is a program, like ``command:popf {domain} {problem}``.

The program is run without a shell, in a folder of its own, with limits on time, memory, processes, disk and output; when it
ends, or we do, so does every process it started. Its plan is read from the file that `{plan}` names or the last of its numbered
ones, or from what it prints. A plan is only believed after it was run by our own semantics.
"""

from __future__ import annotations

import re
import shlex
import time
from collections.abc import Collection
from dataclasses import dataclass

from symskill_pddl.errors import InputError
from symskill_pddl.pddl.export import write_domain, write_problem
from symskill_pddl.pddl.names import Names
from symskill_pddl.pddl.plan import read_plans
from symskill_pddl.pddl.printed import holds_plan
from symskill_pddl.planning.engine import Engine, proven
from symskill_pddl.planning.process import plan_files, run, work_folder
from symskill_pddl.planning.protocol import Limits, PlanResult, Status
from symskill_pddl.planning.text import Answer
from symskill_pddl.symbols import Domain, Plan, Problem, validate

_UNSOLVABLE = re.compile(
    r"\bunsolvable\b|no plan exists|provably no solution|explored state space\W+no solution|no plan will solve it", re.IGNORECASE
)
_DOUBT = re.compile(
    r"\b(?:not|cannot|isn't|whether|if|may|might|maybe|probably|possibly|unknown|could|assum\w*)\b", re.IGNORECASE
)
"""In a line with one of these words nothing is proved."""
_INCOMPLETE = 12
"""With which Fast Downward ends where its search has left something out."""


@dataclass(frozen=True)
class Command(Engine):
    """A program with `{domain}` and `{problem}` in its arguments, and `{plan}` if it writes the plan to a file."""

    template: str
    dialect: str = "negative"
    version: str = "unknown"
    licence: str = "unknown"

    def __post_init__(self) -> None:
        if "{domain}" not in self.template or "{problem}" not in self.template:
            raise InputError(f"a planner command needs {{domain}} and {{problem}} in it, got '{self.template}'")
        try:
            words = shlex.split(self.template)
        except ValueError as error:
            raise InputError(f"the planner command '{self.template}' cannot be split into words: {error}") from None
        if unknown := sorted(set(re.findall(r"{(\w*)}", " ".join(words))) - {"domain", "problem", "plan"}):
            raise InputError(f"the planner command has the unknown field '{{{unknown[0]}}}'; there are: domain, plan, problem")

    @property
    def name(self) -> str:
        return f"command:{self.template}"

    @property
    def dialects(self) -> tuple[str, ...]:
        return (self.dialect,)

    def plan(self, domain: Domain, problem: Problem, limits: Limits) -> PlanResult:
        """Plan; raises `InputError` also where the domain does not fit the dialect, or the program does not exist."""
        begin = time.monotonic()

        def result(status: Status, plan: Plan | None = None, *messages: str) -> PlanResult:
            return PlanResult(status, plan, time.monotonic() - begin, messages, self.name)

        names = Names.of(domain, problem.object_types)
        written, posed = names.domain(domain), names.problem(problem)
        texts = (write_domain(written, dialect=self.dialect), write_problem(posed, written, dialect=self.dialect))
        answer = self.answer(*texts, limits, [op.name for op in written.operators])
        if answer.status is not Status.SOLVED:
            if problem.goal <= problem.init:
                return result(Status.SOLVED, Plan((), 0.0), "the goal holds already")
            return proven(result(answer.status, None, *answer.messages), domain, self.dialect)
        program = shlex.split(self.template)[0]
        try:
            read = read_plans(str(answer.plan), written, posed.object_types, program)
            plan = names.inverse().plan(read[-1].plan)
            validate(domain, problem, plan)
        except InputError as error:
            return result(Status.FAILED, None, f"what '{program}' gives is not a plan: {error}")
        cost = sum(step.cost for step in plan.ground(domain, problem.object_types))
        return result(Status.SOLVED, Plan(plan.steps, cost), *read[-1].remarks)

    def answer(self, domain: str, problem: str, limits: Limits, actions: Collection[str]) -> Answer:
        """What the program says about two texts, which it is given as they are.

        Parameters
        ----------
        actions : collection of str
            Names of the domain's actions, by which a plan is told from the talk around it.
        """
        texts = {"domain": domain, "problem": problem}
        with work_folder() as folder:
            files = {field: folder / f"{field}.pddl" for field in texts} | {"plan": folder / "plan.txt"}
            for field, text in texts.items():
                files[field].write_text(text, encoding="utf-8", newline="")
            words = [re.sub(r"{(\w+)}", lambda m: str(files[m[1]]), word) for word in shlex.split(self.template)]
            ended = run(words, folder, limits, time_s=limits.time_s)
            text = next(reversed(plan_files(folder, "plan.txt")), "")
        if not text and "{plan}" not in self.template and holds_plan(ended.output, actions):
            text = ended.output
        if text:
            return Answer(Status.SOLVED, text)
        if ended.out_of_time:
            return Answer(Status.TIMEOUT, messages=(ended.stopped,))
        if ended.stopped:
            return Answer(Status.FAILED, messages=(f"'{words[0]}' was ended: {ended.stopped}",))
        if said := proof(ended.output, ended.status):
            return Answer(Status.UNSOLVABLE, messages=(f"'{words[0]}' says '{said}'",))
        said = f"'{words[0]}' ended with status {ended.status} and no plan; it said last: {ended.last_line}"
        return Answer(Status.FAILED, messages=(said,))


def proof(output: str, status: int | None) -> str:
    """The words in which a program says that it proved that there is no plan; empty where it does not."""
    if status == _INCOMPLETE:
        return ""
    for line in output.splitlines():
        if (found := _UNSOLVABLE.search(line)) and not _DOUBT.search(line):
            return found[0]
    return ""
