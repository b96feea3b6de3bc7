"""`mimir`: the planner Mimir (pymimir), in process; lazy greedy search with FF's heuristic. It counts steps, not costs.

A session keeps the parsed problem and hands over a new state, which is where it is fastest. What a problem keeps is its goal,
its static atoms, and the atoms that its grounding can reach; where a new state leaves those, the problem is loaded again, with
the atoms of all states so far to ground from.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from threading import Lock
from typing import Any

from symskill_pddl.planning.protocol import Limits, Status
from symskill_pddl.planning.text import Answer, Ask, Reader, Text
from symskill_pddl.symbols import Atom, Plan, Problem, State

_STATUS = {"EXHAUSTED": Status.UNSOLVABLE, "UNSOLVABLE": Status.UNSOLVABLE, "OUT_OF_TIME": Status.TIMEOUT}
_STDOUT = Lock()


@dataclass(frozen=True)
class Mimir(Reader):
    """Mimir over a `lifted` or `grounded` problem; grounding pays only where many states of a small problem follow."""

    mode: str = "lifted"
    max_states: int = 0
    """States after which it gives up, with `Status.FAILED`; 0 is never. Unlike a time limit, the same on every machine."""
    family: str = field(default="mimir", init=False, repr=False)
    package: str = field(default="pymimir", init=False, repr=False)
    module: str = field(default="pymimir", init=False, repr=False)
    licence: str = field(default="GPL-3.0-only", init=False, repr=False)
    dialects: tuple[str, ...] = field(default=("negative",), init=False, repr=False)
    shorten: bool = field(default=True, init=False, repr=False)

    def load(self, text: Text) -> Ask:
        modules = (self.engine(), self.engine("pymimir.advanced.search"), self.engine("pymimir.advanced.formalism"))
        try:
            return _Loaded(*modules, text, self.mode, self.max_states)
        except RuntimeError as error:
            why = f"mimir does not read the domain: {' '.join(str(error).split())}"
            return lambda _problem, _limits: Answer(Status.FAILED, messages=(why,))


class _Loaded:
    """A domain, and the problem that was asked about last."""

    def __init__(self, mimir: Any, search: Any, formalism: Any, text: Text, mode: str, max_states: int) -> None:
        self._mimir, self._search, self._formalism = mimir, search, formalism
        self._text, self._mode, self._max_states = text, mode, max_states
        self._domain = mimir.Domain(text.domain)
        adds = {a.predicate for op in text.original.operators for a in op.add}
        deletes = {a.predicate for op in text.original.operators for a in op.delete}
        self._fluent = adds | deletes
        self._goal: State | None = None
        self._static: State = frozenset()
        self._known: State = frozenset()
        self._atoms: dict[Atom, Any] = {}
        self._problem: Any = None
        self._heuristic: Any = None

    def __call__(self, problem: Problem, limits: Limits) -> Answer:
        static = frozenset(a for a in problem.init if a.predicate not in self._fluent)
        if not (problem.goal == self._goal and static == self._static and problem.init <= self._known):
            if static != self._static:
                self._known = frozenset()
            self._prepare(replace(problem, init=problem.init | self._known), static)
        options = self._search.GBFSLazyOptions()
        options.max_time_in_ms = max(1, int(limits.time_s * 1000))
        if self._max_states:
            options.max_num_states = self._max_states
        options.start_state = self._state(problem.init - static)
        found = self._search.find_solution_gbfs_lazy(self._problem._search_context, self._heuristic, options)
        if found.plan is None:
            status = found.status.name
            return Answer(_STATUS.get(status, Status.FAILED), messages=(f"mimir says '{status.lower()}'",))
        steps = []
        for action in found.plan.get_actions():
            ground = self._mimir.GroundAction(action, self._problem)
            steps.append((ground.get_action().get_name(), tuple(o.get_name() for o in ground.get_objects())))
        plan = Plan(tuple(steps))
        self._remember(plan, problem.init)
        return Answer(Status.SOLVED, plan)

    def _prepare(self, problem: Problem, static: State) -> None:
        with _quiet():  # the grounder prints every atom it reaches
            self._problem = self._mimir.Problem(self._domain, self._text.problem(problem), mode=self._mode)
            self._heuristic = self._mimir.FFHeuristic(self._problem)._advanced_heuristic
        self._goal, self._static, self._known = problem.goal, static, problem.init
        self._atoms = {}

    def _state(self, fluents: State) -> Any:
        atoms = self._formalism.FluentGroundAtomList()
        exported = self._text.names.atoms
        for atom in sorted(fluents):
            if atom not in self._atoms:
                (named,) = exported((atom,))
                objects = [self._problem.get_object(name) for name in named.args]
                ground = self._problem.new_ground_atom(self._domain.get_predicate(named.predicate), objects)
                self._atoms[atom] = ground._advanced_ground_atom
            atoms.append(self._atoms[atom])
        repository = self._problem._search_context.get_state_repository()
        return repository.get_or_create_state(atoms, [])[0]

    def _remember(self, plan: Plan, init: State) -> None:
        """What a plan makes true can be reached, so states along it need no new grounding."""
        known = set(self._known | init)
        for name, args in self._text.plan(plan, "mimir").steps:
            operator = self._text.original.operator(name)
            binding = dict(zip((p.name for p in operator.parameters), args, strict=True))
            known.update(a.substitute(binding) for a in operator.add)
        self._known = frozenset(known)


@contextmanager
def _quiet() -> Iterator[None]:
    """Standard output of the whole process to nowhere, for code that prints past Python."""
    with _STDOUT:
        c_library = ctypes.CDLL(None)
        c_library.fflush(None)
        try:
            kept = os.dup(1)
        except OSError:  # there is none
            yield
            return
        nowhere = os.open(os.devnull, os.O_WRONLY)
        try:
            os.dup2(nowhere, 1)
            yield
        finally:
            c_library.fflush(None)
            os.dup2(kept, 1)
            os.close(kept)
            os.close(nowhere)
