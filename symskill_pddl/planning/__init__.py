"""Planning: one protocol, one registry, one file per engine."""

from __future__ import annotations

from importlib.util import find_spec

from symskill_pddl.errors import InputError, MissingDependencyError, alternatives
from symskill_pddl.planning.auto import Auto
from symskill_pddl.planning.command import Command
from symskill_pddl.planning.downward import FastDownward
from symskill_pddl.planning.engine import Engine
from symskill_pddl.planning.explain import Effort, explain, nearest_goal, why_not
from symskill_pddl.planning.kairos import Kairos
from symskill_pddl.planning.lpg import LPG
from symskill_pddl.planning.mimir import Mimir
from symskill_pddl.planning.own import Own
from symskill_pddl.planning.protocol import NO_EXTRA_COSTS, Limits, Planner, PlanResult, Session, Status, Step, session
from symskill_pddl.planning.pyperplan import Pyperplan
from symskill_pddl.planning.search import Builtin
from symskill_pddl.planning.text import Reader
from symskill_pddl.planning.unified import UnifiedPlanning, engines, to_unified_planning

__all__ = [
    "LPG",
    "NO_EXTRA_COSTS",
    "Auto",
    "Builtin",
    "Command",
    "Effort",
    "Engine",
    "FastDownward",
    "Kairos",
    "Limits",
    "Mimir",
    "Own",
    "PlanResult",
    "Planner",
    "Pyperplan",
    "Session",
    "Status",
    "Step",
    "UnifiedPlanning",
    "explain",
    "get",
    "missing",
    "nearest_goal",
    "planners",
    "session",
    "to_unified_planning",
    "why_not",
]

_READERS: dict[str, type[Reader]] = {"kairos": Kairos, "mimir": Mimir, "fast-downward": FastDownward, "lpg": LPG}
"""The engines of the extra `[planners]`."""
_FAMILIES = (
    "pyperplan[:SEARCH:HEURISTIC], kairos[:DIALECT], mimir, fast-downward[:DIALECT][:optimal], lpg[:DIALECT], "
    "unified-planning:ENGINE, 'command:PROGRAM {domain} {problem}', MODULE:NAME (a planner class of your own)"
)


def planners(*, unified: bool = False) -> tuple[Planner, ...]:
    """The planners that are installed, in the order in which `symskill planners` shows them.

    Parameters
    ----------
    unified : bool
        Also ask unified-planning for its engines; importing it takes about a second.
    """
    found: list[Planner] = [Auto(), Builtin(), Builtin(optimal=True, name="builtin-optimal")]
    if find_spec("pyperplan"):
        found.append(Pyperplan())
    found += [reader() for reader in _READERS.values() if reader.installed()]
    if unified:
        found += [UnifiedPlanning(engine) for engine in engines()]
    return tuple(found)


def missing() -> tuple[str, ...]:
    """The engines of the extra `[planners]` that are not installed."""
    return tuple(name for name, reader in _READERS.items() if not reader.installed())


def get(name: str = "auto") -> Planner:
    """A planner by name; ``auto`` chooses for each problem, and the result of `solve` says which.

    Raises
    ------
    InputError
        No planner has this name; the message lists what there is.
    MissingDependencyError
        The planner is known and not installed.
    """
    known = planners()
    for planner in known:
        if planner.name == name:
            return planner
    family, _, rest = name.partition(":")
    if family == "unified-planning" and rest:
        return UnifiedPlanning.checked(rest)
    if family == "command" and rest:
        return Command(rest)
    if family == "pyperplan":
        if not find_spec("pyperplan"):
            raise MissingDependencyError("the planner 'pyperplan' is not installed; pip install pyperplan")
        search, _, heuristic = rest.partition(":")
        return Pyperplan(search or "astar", heuristic or "hadd")
    if family in _READERS:
        words = [word for word in rest.split(":") if word]
        if family == "fast-downward" and words[-1:] == ["optimal"]:
            return _checked(FastDownward(":".join(words[:-1]), optimal=True))
        return _checked(_READERS[family](":".join(words)))
    if rest.isidentifier() and Own.exists(family):
        return Own(family, rest)
    raise InputError(f"unknown planner '{name}'; there are: {alternatives(p.name for p in known)}; families: {_FAMILIES}")


def _checked(reader: Reader) -> Planner:
    if not reader.installed():
        raise MissingDependencyError(
            f"the planner '{reader.family}' is not installed; pip install 'symskill-pddl[planners]' (or {reader.package})"
        )
    return reader
