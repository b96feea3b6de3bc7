"""`mimir`: the planner Mimir (pymimir), in a process of its own: lazy greedy search with FF's heuristic. It counts steps.

A session hands over nothing but a new state, as long as goal and static atoms stay.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from symskill_pddl.planning.protocol import Limits
from symskill_pddl.planning.text import Answer, Ask, Reader, Text, answered
from symskill_pddl.planning.worker import Remote
from symskill_pddl.symbols import Atom, Problem, State

Fact = tuple[str, tuple[str, ...]]


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
        self.required()
        remote = Remote("symskill_pddl.engines.mimir", {"domain": text.domain, "mode": self.mode})
        split = _Split(text) if isinstance(text, Text) else _whole(text)

        def ask(problem: Problem, limits: Limits) -> Answer:
            written, fluents = split(problem)
            states = self.max_states
            return answered(remote.ask(limits.time_s, limits.memory_mb, problem=written, fluents=fluents, max_states=states))

        return ask


def _whole(text: Text) -> Callable[[Problem], tuple[tuple[str, str], None]]:
    """A text that is handed over as it is."""
    return lambda problem: ((text.problem(problem), ""), None)


class _Split:
    """A problem as a text without fluent atoms, in two parts between which they belong, and the fluent atoms."""

    def __init__(self, text: Text) -> None:
        self._text = text
        operators = text.original.operators
        self._fluent = {a.predicate for op in operators for a in (*op.add, *op.delete)}
        self._last: tuple[State, State] | None = None
        self._written = ("", "")
        self._facts: dict[Atom, Fact] = {}

    def __call__(self, problem: Problem) -> tuple[tuple[str, str], tuple[Fact, ...]]:
        fluents = frozenset(a for a in problem.init if a.predicate in self._fluent)
        static = problem.init - fluents
        if (problem.goal, static) != self._last:
            before, init, after = self._text.problem(replace(problem, init=static)).partition("(:init")
            self._written, self._last = (before + init, after), (problem.goal, static)
        for atom in fluents - self._facts.keys():
            (named,) = self._text.names.atoms((atom,))
            self._facts[atom] = (named.predicate, named.args)
        return self._written, tuple(sorted(self._facts[a] for a in fluents))
