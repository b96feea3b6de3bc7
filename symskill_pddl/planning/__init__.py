"""Planning: one protocol, one registry, one file per engine."""

from __future__ import annotations

from importlib.util import find_spec

from symskill_pddl.errors import InputError, MissingDependencyError, alternatives
from symskill_pddl.planning.command import Command
from symskill_pddl.planning.explain import explain, nearest_goal, why_not
from symskill_pddl.planning.protocol import NO_EXTRA_COSTS, Limits, Planner, PlanResult, Status, Step
from symskill_pddl.planning.pyperplan import Pyperplan
from symskill_pddl.planning.search import Builtin
from symskill_pddl.planning.unified import UnifiedPlanning, engines

__all__ = [
    "NO_EXTRA_COSTS",
    "Builtin",
    "Command",
    "Limits",
    "PlanResult",
    "Planner",
    "Pyperplan",
    "Status",
    "Step",
    "UnifiedPlanning",
    "explain",
    "get",
    "nearest_goal",
    "planners",
    "why_not",
]

_FAMILIES = "pyperplan[:SEARCH:HEURISTIC], unified-planning:ENGINE, 'command:PROGRAM {domain} {problem}'"


def planners(*, unified: bool = False) -> tuple[Planner, ...]:
    """The planners that are installed, best first.

    Parameters
    ----------
    unified : bool
        Also ask unified-planning for its engines; importing it takes about a second.
    """
    found: list[Planner] = [Builtin(), Builtin(optimal=True, name="builtin-optimal")]
    if find_spec("pyperplan"):
        found.append(Pyperplan())
    if unified:
        found += [UnifiedPlanning(engine) for engine in engines()]
    return tuple(found)


def get(name: str = "auto") -> Planner:
    """A planner by name; ``auto`` is the best that is installed, and the result of `solve` says which.

    Raises
    ------
    InputError
        No planner has this name; the message lists what there is.
    MissingDependencyError
        The planner is known and not installed.
    """
    known = planners()
    if name == "auto":
        return known[0]
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
    raise InputError(f"unknown planner '{name}'; there are: auto, {alternatives(p.name for p in known)}; families: {_FAMILIES}")
