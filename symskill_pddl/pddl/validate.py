"""Running a plan by the meaning of a task's texts, step by step, or happening by happening where actions take time."""

from __future__ import annotations

from symskill_pddl.errors import InputError
from symskill_pddl.pddl.evaluate import Moment, NotEvaluatedError, Semantics
from symskill_pddl.pddl.syntax import Beyond
from symskill_pddl.pddl.task import Task
from symskill_pddl.pddl.timed import known_action, timed_end
from symskill_pddl.symbols import Plan


def validate_plan(task: Task, plan: Plan) -> float | None:
    """Run a plan by the meaning of the task's texts; its cost, which is the number of steps where the task counts nothing else.

    Raises
    ------
    InputError
        At the first step that is unknown, ill-typed or not applicable, naming what does not hold; or if the goal is missed.
    NotEvaluatedError
        The task has preferences, constraints, probabilities or the like.
    """
    semantics = Semantics(task)
    moment = timed_end(semantics, plan) if task.domain.timed or task.problem.timed else _end(semantics, plan)
    goal = task.problem.goal
    if not semantics.holds(goal, {}, moment):
        raise InputError(f"the plan ends without the goal {semantics.missing(goal, {}, moment)}")
    metric = task.problem.metric
    if metric is None:
        return float(len(plan))
    if isinstance(metric.expression, Beyond):
        return None
    spans = [start + (length or 0.0) for start, length in plan.times or ()] if task.domain.timed else [float(len(plan))]
    final = Moment(moment.facts, {**moment.values, ("total-time", ()): max(spans, default=0.0)})
    return semantics.number(metric.expression, {}, final)


def _end(semantics: Semantics, plan: Plan) -> Moment:
    """The state after the steps in their order."""
    moment = semantics.initial()
    for number, (name, args) in enumerate(plan.steps, start=1):
        step = " ".join((name, *args))
        try:
            action = known_action(semantics.task, name)
            binding = semantics.bind(action, args)
            condition = action.condition()
            if not semantics.holds(condition, binding, moment):
                raise InputError(f"needs {semantics.missing(condition, binding, moment)}, which does not hold there")
            moment = semantics.after(semantics.changes(action.effect(), binding, moment), moment)
        except NotEvaluatedError:
            raise
        except InputError as error:
            raise InputError(f"plan step {number} ({step}): {error}") from None
    return moment
