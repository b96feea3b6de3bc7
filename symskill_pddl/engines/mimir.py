"""Mimir: lazy greedy search with FF's heuristic. It counts steps, not costs.

It keeps the parsed problem and is handed a new state, which is where it is fastest. What a problem keeps is its goal, its static
atoms, and the atoms that its grounding can reach; where a new state leaves those, the problem is loaded again, with the atoms of
all states so far to ground from.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

import pymimir
from pymimir.advanced import formalism, search

_STATUS = {"EXHAUSTED": "unsolvable", "UNSOLVABLE": "unsolvable", "OUT_OF_TIME": "timeout"}
Fact = tuple[str, tuple[str, ...]]
"""Predicate and arguments."""


def load(domain: str, mode: str) -> Callable[..., tuple[str, Any, tuple[str, ...]]]:
    """Read a domain; `mode` is `lifted` or `grounded`."""
    try:
        return _Loaded(pymimir.Domain(_readable(domain)), mode)
    except RuntimeError as error:
        why = f"mimir does not read the domain: {' '.join(str(error).split())}"
        return lambda **_: ("failed", None, (why,))


def _readable(text: str) -> str:
    """Mimir takes `(at-1 home)` and `(at1 home)` for literals that hold from a time on: such predicates get another name."""
    return re.sub(r"\(\s*(?=at[-+.]?\d)", "(not-a-time-", text, flags=re.IGNORECASE)


class _Loaded:
    """A domain, and the problem that was asked about last."""

    def __init__(self, domain: Any, mode: str) -> None:
        self._domain, self._mode = domain, mode
        self._given: tuple[str, str] | None = None
        self._known: set[Fact] = set()
        self._atoms: dict[Fact, Any] = {}
        self._problem: Any = None
        self._heuristic: Any = None

    def __call__(
        self, problem: tuple[str, str], fluents: Sequence[Fact] | None, time_s: float, max_states: int = 0
    ) -> tuple[str, Any, tuple[str, ...]]:
        """Plan from `fluents`; `problem` is a text in two parts, between which they belong. None: the text has them."""
        if problem != self._given or not self._known.issuperset(fluents or ()):
            if problem != self._given:
                self._known = set()
            self._known.update(fluents or ())
            self._prepare(problem)
        options = search.GBFSLazyOptions()
        options.max_time_in_ms = max(1, int(time_s * 1000))
        if max_states:
            options.max_num_states = max_states
        if fluents is not None:
            options.start_state = self._state(fluents)
        found = search.find_solution_gbfs_lazy(self._problem._search_context, self._heuristic, options)
        if found.plan is None:
            name = found.status.name
            return _STATUS.get(name, "failed"), None, (f"mimir says '{name.lower()}'",)
        steps = []
        for action in found.plan.get_actions():
            ground = pymimir.GroundAction(action, self._problem)
            steps.append((ground.get_action().get_name(), tuple(o.get_name() for o in ground.get_objects())))
        return "solved", tuple(steps), ()

    def _prepare(self, problem: tuple[str, str]) -> None:
        self._given = None
        known = "".join(f" ({' '.join((name, *args))})" for name, args in sorted(self._known))
        self._problem = pymimir.Problem(self._domain, _readable(known.join(problem)), mode=self._mode)
        self._heuristic = pymimir.FFHeuristic(self._problem)._advanced_heuristic
        self._given, self._atoms = problem, {}

    def _state(self, fluents: Sequence[Fact]) -> Any:
        atoms = formalism.FluentGroundAtomList()
        for fact in fluents:
            if fact not in self._atoms:
                name, args = _readable(f"({fact[0]}")[1:], fact[1]
                objects = [self._problem.get_object(o) for o in args]
                ground = self._problem.new_ground_atom(self._domain.get_predicate(name), objects)
                self._atoms[fact] = ground._advanced_ground_atom
            atoms.append(self._atoms[fact])
        repository = self._problem._search_context.get_state_repository()
        return repository.get_or_create_state(atoms, [])[0]
