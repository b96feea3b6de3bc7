"""A task as somebody wrote it, before any planner: the texts go byte for byte to the engines that read PDDL.

Planners that work on our own model get the model that `pddl.compiled` makes of the texts, where it can hold them. Whoever
planned, the plan is believed after `pddl.validate_plan` ran it by the meaning of the texts; what that cannot evaluate is said.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

from symskill_pddl.errors import InputError, MissingDependencyError, ParseError
from symskill_pddl.pddl.compiled import Compiled, compiled
from symskill_pddl.pddl.evaluate import NotEvaluatedError, Semantics
from symskill_pddl.pddl.plan import printed_plans
from symskill_pddl.pddl.symbolic import BeyondModelError
from symskill_pddl.pddl.task import Task
from symskill_pddl.pddl.timed import known_action
from symskill_pddl.pddl.validate import validate_plan
from symskill_pddl.planning.auto import Auto
from symskill_pddl.planning.command import Command
from symskill_pddl.planning.downward import FastDownward
from symskill_pddl.planning.explain import why_not
from symskill_pddl.planning.kairos import Kairos
from symskill_pddl.planning.lpg import LPG
from symskill_pddl.planning.mimir import Mimir
from symskill_pddl.planning.protocol import Limits, Planner, PlanResult, Status
from symskill_pddl.planning.text import Answer, Reader, bare
from symskill_pddl.symbols import Domain, Plan, Problem

_NOTHING = Problem("", "", (), frozenset(), frozenset())
_AXIOMS = (
    "derived predicates",
    "universal conditions",
    "existential conditions",
    "disjunctive conditions",
    "negative conditions",
)
"""What may become an axiom in Fast Downward's translation."""
_GAP_S = 0.001
"""Between actions that come one after another [s]."""
_SHARES, _SHARE = {"kairos": 0.3, "fast-downward": 0.75}, 0.5
"""Part of the time that is left which `auto` gives an engine before it asks the next."""


@dataclass(frozen=True)
class Verbatim:
    """What engines take for a `text.Text`: the texts as they are, whatever the problem."""

    domain: str
    written: str

    def problem(self, _problem: Problem) -> str:
        return self.written


def solve(planner: Planner, task: Task, limits: Limits = Limits(), *, any_plan: bool = False) -> PlanResult:
    """Plan for the task.

    Parameters
    ----------
    any_plan : bool
        A plan is wanted and not a good one: a metric to maximize is no reason to refuse.

    Raises
    ------
    InputError
        The task has a metric that this planner would ignore or take the wrong way round, or a text is not whole.
    """
    start = time.monotonic()
    for source, remarks in zip(task.sources, (task.domain.remarks, task.problem.remarks), strict=True):
        for remark in (r for r in remarks if r.broken):
            raise ParseError(remark.what, source=source, line=remark.at[0], column=remark.at[1])
    metric = task.problem.metric
    if metric is not None and not metric.minimize and not any_plan and not isinstance(planner, Command):
        line, column = metric.at
        message = (
            "no planner here follows a metric to maximize; ask for any plan (--any-plan), or take one that does, as a command"
        )
        raise ParseError(message, source=task.sources[1], line=line, column=column)
    if _holds_already(task):
        return _judged(task, planner.name, (Plan(),), ("the goal holds already",), start)
    if isinstance(planner, Auto):
        return _auto(planner, task, limits, start)
    return _one(planner, task, limits, start)


def _auto(planner: Auto, task: Task, limits: Limits, start: float) -> PlanResult:
    """The first engine with an answer; the messages say which, and why the ones before it had none."""
    engines: tuple[Planner, ...] = readers(task)
    asked: list[str] = []
    found: PlanResult | None = None
    for i, engine in enumerate((*engines, planner)):
        left = limits.time_s - (time.monotonic() - start)
        if left <= 0.0:
            break
        last = i == len(engines)
        share = left if last else left * _SHARES.get(engine.name, _SHARE)
        now = _one(engine, task, replace(limits, time_s=share), time.monotonic())
        if now.status in (Status.SOLVED, Status.UNSOLVABLE):
            found = now
            break
        asked.append(
            f"{engine.name if not last else 'our own model'}: {now.status.value}" + "".join(f", {m}" for m in now.messages[:1])
        )
        found = now if found is None or found.status is not Status.TIMEOUT else found
    if found is None:
        found = PlanResult(Status.TIMEOUT, planner=planner.name)
    said = (f"auto took {found.planner}",) if found.status in (Status.SOLVED, Status.UNSOLVABLE) else ()
    return replace(found, seconds=time.monotonic() - start, messages=(*found.messages[:2], *said, *asked))


def readers(task: Task) -> tuple[Reader, ...]:
    """The installed engines that may read the task's text, the quickest first."""
    order: tuple[type[Reader], ...] = (Kairos, FastDownward, LPG, Mimir)
    if task.uses("durative actions", "numeric conditions", "numeric effects", "facts that come true at a time"):
        order = (Kairos, LPG)
    elif task.uses("conditional effects", "derived predicates", "universal effects"):
        order = (Kairos, FastDownward, Mimir)
    return tuple(engine() for engine in order if engine.installed())


def _one(planner: Planner, task: Task, limits: Limits, start: float) -> PlanResult:
    texts = task.domain_text, task.problem_text
    if isinstance(planner, Mimir):  # it tells cases apart and stumbles over comments, neither of which means anything in PDDL
        texts = bare(texts[0]).lower(), bare(texts[1]).lower()
    if isinstance(planner, Reader) and not (task.domain.timed and isinstance(planner, (FastDownward, Mimir))):
        try:
            answer = planner.load(Verbatim(*texts))(_NOTHING, limits)  # type: ignore[arg-type]
        except MissingDependencyError as error:
            answer = Answer(Status.FAILED, messages=(str(error),))
        if isinstance(planner, LPG) and answer.status is Status.UNSOLVABLE:  # a local search that rules out by its own mutexes
            answer = Answer(Status.FAILED, messages=(*answer.messages, "which is no proof"))
        if isinstance(planner, FastDownward) and answer.status is Status.UNSOLVABLE and task.uses(*_AXIOMS):
            answer = _with_axioms(answer)
        return _believed(planner.name, task, limits, answer, start)
    if isinstance(planner, Command):
        return _believed(planner.name, task, limits, planner.answer(*texts, limits, [a.name for a in task.domain.actions]), start)
    try:
        model = compiled(task)
    except BeyondModelError as error:
        readers_there = ", ".join(r.name for r in readers(task)) or "kairos, fast-downward, lpg (none is installed)"
        message = f"{error}; planners that read PDDL themselves may take it: {readers_there}"
        return PlanResult(Status.FAILED, None, time.monotonic() - start, (message,), planner.name)
    return _modelled(planner, task, model, limits, start)


def _with_axioms(answer: Answer) -> Answer:
    """Fast Downward's heuristic may err about dead ends where there are axioms, so status 12 is no proof then."""
    if not any("status 12" in said for said in answer.messages):
        return answer
    return Answer(Status.FAILED, messages=(*answer.messages, "which with axioms is no proof"))


def _modelled(planner: Planner, task: Task, model: Compiled, limits: Limits, start: float) -> PlanResult:
    found = planner.solve(model.domain, model.problem, limits)
    if found.plan is None:
        return replace(found, seconds=time.monotonic() - start)
    plan = model.back(found.plan)
    if task.domain.timed:
        plan = one_by_one(model.domain, plan)
    return _judged(task, found.planner, (plan,), (*model.remarks, *found.messages), start)


def one_by_one(domain: Domain, plan: Plan) -> Plan:
    """A plan of actions that take time, each after the one before it."""
    now, times = 0.0, list[tuple[float, float | None]]()
    for name, _ in plan.steps:
        length = domain.operator(name).cost
        times.append((round(now, 3), length))
        now += length + _GAP_S
    return replace(plan, times=tuple(times))


def _believed(name: str, task: Task, limits: Limits, answer: Answer, start: float) -> PlanResult:
    if answer.status is Status.TIMEOUT:
        said = (f"the time limit of {limits.time_s:.3g} s passed", *answer.messages)
        return PlanResult(Status.TIMEOUT, None, time.monotonic() - start, said, name)
    if answer.status is not Status.SOLVED:
        return PlanResult(answer.status, None, time.monotonic() - start, answer.messages, name)
    try:
        plans = plans_of(task, answer.plan, name) if isinstance(answer.plan, str) else ((_spelled(answer.plan), ()),)
    except ParseError as error:
        return PlanResult(Status.FAILED, None, time.monotonic() - start, (f"what {name} gives is not a plan: {error}",), name)
    remarks = (*plans[-1][1], *answer.messages)
    return _judged(task, name, tuple(plan for plan, _ in plans), remarks, start)


def plans_of(task: Task, text: str, source: str) -> tuple[tuple[Plan, tuple[str, ...]], ...]:
    """The plans that a text holds, in its order, each with what is to be said of it; raises `ParseError`."""
    actions, pools = [a.name for a in task.domain.actions], _checker(task)
    found = printed_plans(text, actions, list(task.objects), pools, source, timed=task.domain.timed)
    return tuple((read.plan, read.remarks) for read in found)


def _checker(task: Task) -> Callable[[str, tuple[str, ...]], object]:
    try:
        semantics = Semantics(task)
    except NotEvaluatedError:
        return lambda name, _args: known_action(task, name)
    return lambda name, args: semantics.bind(known_action(task, name), args)


def _spelled(plan: Plan) -> Plan:
    return replace(plan, steps=tuple((name.lower(), tuple(a.lower() for a in args)) for name, args in plan.steps))


def _judged(task: Task, name: str, plans: Iterable[Plan], messages: tuple[str, ...], start: float) -> PlanResult:
    """The last of the plans that is one."""
    wrong: list[str] = []
    for plan in reversed(tuple(plans)):
        try:
            cost, said = validate_plan(task, plan), messages
        except NotEvaluatedError as error:
            cost, said = plan.cost, (*messages, f"the plan of {name} is not validated: {error}")
        except InputError as error:
            wrong.append(f"what {name} gives is not a plan: {error}")
            continue
        said = (*said, *(f"a later plan is none: {w}" for w in wrong[:1]))
        return PlanResult(Status.SOLVED, replace(plan, cost=cost), time.monotonic() - start, said, name)
    return PlanResult(Status.FAILED, None, time.monotonic() - start, (*wrong[:1], *messages), name)


def _holds_already(task: Task) -> bool:
    if task.beyond:
        return False
    try:
        semantics = Semantics(task)
        return semantics.holds(task.problem.goal, {}, semantics.initial())
    except InputError:
        return False


def explained(task: Task, result: PlanResult) -> tuple[str, ...]:
    """Why there is no plan, where that was proved and our model says what the texts say; nothing where a planner only failed."""
    if result.status is not Status.UNSOLVABLE:
        return ()
    try:
        model = compiled(task)
    except BeyondModelError:
        return ()
    return why_not(model.domain, model.problem) if not model.actions else ()
