"""Costs from data: what runs say of each operator, and what a step is then worth avoiding.

An operator's cost is the time that it takes until it has worked, as one may expect it: the mean duration of a try, divided by the
probability that a try works. That probability is Laplace's rule of succession, ``(successes + 1) / (tries + 2)``: an operator
that was never tried is taken for a coin toss, and one failure does not condemn it. The duration is that of its own successes, and
that of the demonstrations as long as there are none.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from symskill_pddl.errors import InputError
from symskill_pddl.execution.lines import StepLine, TickLine, VerdictLine, load_watch, unrows
from symskill_pddl.execution.monitor import Blame, Watch, only_clearance_lacks
from symskill_pddl.execution.trace import Trace
from symskill_pddl.library import Experience, LearnedOperator, Library
from symskill_pddl.symbols import Atom, State


@dataclass
class _Try:
    """One step that was carried out, as far as it is known whose doing its end was."""

    operator: str
    seconds: float
    worked: bool


def experience_of(trace: Trace) -> dict[str, Experience]:
    """What a run says of each operator.

    A step counts when the monitor has found its effects, or has blamed it; what others did to it counts neither way. A grasp that
    is lost on the way was no success of the step that closed the fingers, as in the executor's own memory.

    Raises
    ------
    InputError
        A run without monitor: nobody judged its steps.
    """
    if not trace.header.monitor:
        raise InputError("a run without monitor, which says nothing of single steps")
    tries: list[_Try] = []
    holding: dict[Atom, _Try] = {}
    watch: Watch | None = None
    state: State = frozenset()
    for line in trace.lines:
        if isinstance(line, StepLine):
            watch, state = load_watch(line), unrows(line.state)
        elif isinstance(line, TickLine):
            state = (state - unrows(line.removed)) | unrows(line.added)
        else:
            continue
        if watch is None or line.verdict.kind == "Continue":
            continue
        _judge(line.verdict, watch, state, line.time, tries, holding)
        watch = None
    found: dict[str, Experience] = defaultdict(Experience)
    for entry in tries:
        seconds = entry.seconds if entry.worked else 0.0
        found[entry.operator] += Experience(1, int(entry.worked), seconds)
    return {name: found[name] for name in sorted(found)}


def _judge(verdict: VerdictLine, watch: Watch, state: State, now_s: float, tries: list[_Try], holding: dict[Atom, _Try]) -> None:
    step = watch.step
    if verdict.kind == "EffectsHold":
        tries.append(_Try(step.name, now_s - watch.start_s, worked=True))
        for atom in step.delete:
            holding.pop(atom, None)
        holding.update({atom: tries[-1] for atom in step.add if atom.predicate in watch.gripper})
    elif verdict.kind == "Violation" and verdict.blame == Blame.ACQUIRING:
        for atom in unrows(verdict.atoms) & holding.keys():
            holding.pop(atom).worked = False
    elif verdict.blame == Blame.OWN or (verdict.kind in ("Stalled", "OverTime") and not only_clearance_lacks(watch, state)):
        tries.append(_Try(step.name, now_s - watch.start_s, worked=False))


def with_experience(library: Library, more: Mapping[str, Experience], runs: Iterable[str] = ()) -> Library:
    """The library with what more runs say, and the costs that follow.

    Parameters
    ----------
    more : mapping of str to Experience
        By operator; those that the library does not have are left out.
    runs : iterable of str
        Checksums of the runs, so that none is counted twice.

    Raises
    ------
    InputError
        A run that the library has counted before.
    """
    new = tuple(runs)
    if again := sorted(set(new) & set(library.runs)):
        raise InputError(f"the run {again[0]} is counted in the library already: every run counts once")
    if not new and not any(e.tries for e in more.values()):
        return library
    operators = tuple(replace(o, experience=o.experience + more.get(o.operator.name, Experience())) for o in library.operators)
    return replace(library, operators=tuple(map(_costed, operators)), runs=tuple(sorted({*library.runs, *new})))


def _costed(learned: LearnedOperator) -> LearnedOperator:
    own = learned.experience
    seconds = own.seconds / own.successes if own.successes else learned.duration_s[0]
    cost = max(round(seconds / own.success, 1), 0.1)
    return replace(learned, operator=replace(learned.operator, cost=cost))
