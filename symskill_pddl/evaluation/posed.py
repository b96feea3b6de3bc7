"""A problem that a person wrote or edited, in the scene of an episode."""

from __future__ import annotations

from collections.abc import Mapping

from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.pddl import Names
from symskill_pddl.symbols import Domain, Problem, State, check_problem


def placed(posed: Problem, domain: Domain, scene: Mapping[str, str]) -> Problem:
    """The problem over the objects of a scene.

    Parameters
    ----------
    posed : Problem
        Under the library's names of types and predicates; its objects are called as in the scene or as in an export. Atoms of
        its initial state that the domain does not know, which some dialects add, are left out.
    scene : mapping of str to str
        Objects with their types.

    Raises
    ------
    InputError
        An object that the scene does not have, or has as another type; or the goal does not fit the domain.
    """
    called = {name: identifier for identifier, name in Names.of(domain, scene).objects.items()}
    names = {name: name if name in scene else called.get(name, name) for name, _ in posed.objects}
    where = f"problem '{posed.name}'"
    for name, kind in posed.objects:
        if names[name] not in scene:
            raise InputError(f"{where}: the scene has no object '{name}'; it has: {alternatives(scene)}")
        if not domain.is_a(kind, scene[names[name]]):
            raise InputError(f"{where}: the object '{name}' is a {scene[names[name]]} in the scene, not a {kind}")
    known = {p.name for p in domain.predicates}
    found = Problem(
        posed.name,
        domain.name,
        tuple((names[name], kind) for name, kind in posed.objects),
        frozenset(a.substitute(names) for a in posed.init if a.predicate in known),
        frozenset(a.substitute(names) for a in posed.goal),
    )
    check_problem(domain, found)
    return found


def unlike(posed: State, seen: State) -> tuple[str, ...]:
    """In words, how the initial state of a problem differs from what the robot sees, which is what it plans from."""
    lines = []
    for atoms, what in ((posed - seen, "the problem says, and it is not seen"), (seen - posed, "seen, and not in the problem")):
        if atoms:
            lines.append(f"{what}: {' '.join(map(str, sorted(atoms)))}")
    return tuple(lines)
