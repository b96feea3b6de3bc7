"""Plans in which actions take time: what happens when, in which state, and what has to hold in between (PDDL 2.1, level 3).

An action is two happenings, its start and its end. What happens at one time is seen from the state before it and done at once; it
may not touch what another happening of that time needs or changes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.pddl.evaluate import Binding, Moment, Semantics, compared
from symskill_pddl.pddl.syntax import Action, And, Change, Condition, Fact, Not, Or, Quantified, Set
from symskill_pddl.pddl.task import Task
from symskill_pddl.symbols import Atom, Plan

_SAME_TIME = 1e-7
"""Times that differ by less are one [s]."""
_PRINTED = 0.01
"""How far a printed duration may lie from what the text says [s]: planners round."""


@dataclass(frozen=True)
class _Step:
    """An action that takes or took place."""

    label: str
    action: Action
    binding: dict[str, str]
    start: float
    end: float


@dataclass(frozen=True)
class _Happening:
    time: float
    when: str
    step: _Step | None = None
    fact: Set | None = None


def timed_end(semantics: Semantics, plan: Plan) -> Moment:
    """The state after a plan with times; raises `InputError` at the first thing that goes wrong."""
    steps = _steps(semantics, plan)
    todo = [_Happening(at, "fact", fact=fact) for at, fact in semantics.task.problem.timed if at > 0.0]
    for step in steps:
        if step.action.duration is None:
            todo.append(_Happening(step.start, "now", step))
        else:
            todo += (_Happening(step.start, "start", step), _Happening(step.end, "end", step))
    last = max((s.end for s in steps), default=0.0)
    todo = sorted((h for h in todo if h.when != "fact" or h.time <= last + _SAME_TIME), key=lambda h: h.time)
    moment = semantics.initial()
    while todo:
        together = [h for h in todo if h.time <= todo[0].time + _SAME_TIME]
        todo = todo[len(together) :]
        moment = _happen(semantics, together, moment)
        now = together[0].time
        for step in steps:
            if step.action.duration is not None and step.start <= now + _SAME_TIME and now + _SAME_TIME < step.end:
                lasting = step.action.condition("all")
                if not semantics.holds(lasting, step.binding, moment):
                    missing = semantics.missing(lasting, step.binding, moment)
                    raise InputError(f"{step.label} needs {missing} all the time, which does not hold after {now:g}")
    return moment


def _steps(semantics: Semantics, plan: Plan) -> list[_Step]:
    if plan.times is None:
        if not plan.steps:
            return []
        raise InputError("the actions take time, but the plan has no times")
    found = []
    for number, ((name, args), (start, length)) in enumerate(zip(plan.steps, plan.times, strict=True), start=1):
        label = f"plan step {number} ({' '.join((name, *args))})"
        try:
            action = known_action(semantics.task, name)
            binding = semantics.bind(action, args)
        except InputError as error:
            raise InputError(f"{label}: {error}") from None
        if action.duration is not None and length is None:
            raise InputError(f"{label}: the plan does not say how long it takes")
        span = length if length is not None and action.duration is not None else 0.0
        found.append(_Step(label, action, {**binding, "?duration": repr(span)}, start, start + span))
    return found


def _happen(semantics: Semantics, together: list[_Happening], moment: Moment) -> Moment:
    changes: list[tuple[Set | Change, Binding]] = []
    needs: list[frozenset[Atom]] = []
    touches: list[frozenset[Atom]] = []
    for happening in together:
        if happening.fact is not None:
            mine: list[tuple[Set | Change, Binding]] = [(happening.fact, {})]
            needs.append(frozenset())
        else:
            mine = _own(semantics, happening, moment)
            step = happening.step
            assert step is not None  # a happening is of a fact or of a step
            needs.append(frozenset(_mentioned(semantics, step.action.condition(happening.when), step.binding)))
        touches.append(frozenset(c.atom.substitute(b) for c, b in mine if isinstance(c, Set)))
        changes += mine
    for i, one in enumerate(together):
        for j, other in enumerate(together):
            if i != j and one.step is not None and other.step is not None and (shared := touches[i] & (needs[j] | touches[j])):
                raise InputError(f"{one.step.label} and {other.step.label} touch {min(shared)} at the same time, {one.time:g}")
    return semantics.after(changes, moment)


def _own(semantics: Semantics, happening: _Happening, moment: Moment) -> list[tuple[Set | Change, Binding]]:
    """What one step changes at a time, once it is clear that it may."""
    step, when = happening.step, happening.when
    assert step is not None  # see the caller
    try:
        if when == "start":
            for said in step.action.duration or ():
                wanted = semantics.number(said.right, step.binding, moment)
                length = step.end - step.start
                if not compared(said.symbol, length, wanted) and abs(length - wanted) > _PRINTED:
                    raise InputError(f"it takes {length:g}, but the duration is to be {said.symbol} {wanted:g}")
        condition = step.action.condition(when)
        if not semantics.holds(condition, step.binding, moment):
            missing = semantics.missing(condition, step.binding, moment)
            raise InputError(f"needs {missing} at {happening.time:g}, which does not hold there")
        return list(semantics.changes(step.action.effect(when), step.binding, moment))
    except InputError as error:
        raise type(error)(f"{step.label}: {error}") from None


def _mentioned(semantics: Semantics, part: Condition, binding: Binding) -> Iterator[Atom]:
    """Every ground atom that a condition looks at."""
    match part:
        case Fact(atom=atom):
            yield atom.substitute(binding)
        case Not(part=inner):
            yield from _mentioned(semantics, inner, binding)
        case And(parts=parts) | Or(parts=parts):
            yield from _all(semantics, parts, binding)
        case Quantified(variables=variables, part=inner):
            for wider in semantics.bindings(variables, binding):
                yield from _mentioned(semantics, inner, wider)
        case _:
            return


def _all(semantics: Semantics, parts: Iterable[Condition], binding: Binding) -> Iterator[Atom]:
    for part in parts:
        yield from _mentioned(semantics, part, binding)


def known_action(task: Task, name: str) -> Action:
    """Raises `InputError` with the names that there are."""
    action = task.domain.action(name)
    if action is None:
        raise InputError(f"unknown action '{name}'; the domain has: {alternatives(a.name for a in task.domain.actions)}")
    return action
