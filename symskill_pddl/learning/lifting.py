"""From ground atoms to lifted ones: arguments by role, context objects by the best injective matching, intersections over a
group."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from symskill_pddl.learning.matching import Side, Tagged, best_match
from symskill_pddl.learning.naming import parameter_names, unique
from symskill_pddl.learning.transitions import Transition
from symskill_pddl.symbols import Atom, Parameter


@dataclass(frozen=True)
class Lifted:
    """What a group of transitions has in common. `bindings` maps variables to objects, one per transition."""

    parameters: tuple[Parameter, ...]
    n_args: int
    pre: frozenset[Atom]
    add: frozenset[Atom]
    delete: frozenset[Atom]
    during: frozenset[Atom]
    bindings: tuple[dict[str, str], ...]

    @property
    def args(self) -> frozenset[str]:
        """The variables of the moved object and its reference."""
        return frozenset(p.name for p in self.parameters[: self.n_args])


def lift(group: Sequence[Transition]) -> Lifted:
    """Intersect the transitions of a group, variables matched so that as much as possible is shared.

    The arguments of all transitions correspond by position. Every other object of the first transition is a context variable of
    its own; in each following transition it stands for a different object of its type, or for none.
    """
    first = group[0]
    others = sorted({a for _, atom in _tagged(first) for a in atom.args} - set(first.args))
    names = parameter_names([*first.args, *others], first.demo.objects)
    to_variable = {o: names[o] for o in (*first.args, *others)}
    common = frozenset((tag, atom.substitute(to_variable)) for tag, atom in _tagged(first))
    arg_variables = [names[a] for a in first.args]
    context = {names[o]: first.demo.objects[o] for o in others}
    bindings = [{v: o for o, v in to_variable.items()}]
    for transition in group[1:]:
        used = {a for _, atom in common for a in atom.args}
        fixed, tagged = dict(zip(transition.args, arg_variables, strict=True)), _tagged(transition)
        seen = {a for _, atom in tagged for a in atom.args} - set(fixed)
        lifted = Side(common, {v: t for v, t in context.items() if v in used})
        match = best_match(lifted, Side(tagged, {o: transition.demo.objects[o] for o in seen}), fixed)
        common = common & frozenset((tag, atom.substitute(match)) for tag, atom in tagged)
        bindings.append({v: o for o, v in match.items()})
    used = {a for _, atom in common for a in atom.args}
    kept = [*arg_variables, *(v for v in context if v in used)]
    types = {**{names[a]: first.demo.objects[a] for a in first.args}, **context}
    # ?food-2 may have lost its ?food: number again
    clean = dict(zip(kept, unique(_stem(v, types) for v in kept), strict=True))
    sets: dict[str, set[Atom]] = defaultdict(set)
    for tag, atom in common:
        sets[tag].add(atom.substitute(clean))
    return Lifted(
        tuple(Parameter(clean[v], types[v]) for v in kept),
        len(arg_variables),
        frozenset(sets["pre"]),
        frozenset(sets["add"]),
        frozenset(sets["delete"]),
        frozenset(sets["during"]),
        tuple({clean[v]: o for v, o in binding.items() if v in clean} for binding in bindings),
    )


def _stem(variable: str, types: Mapping[str, str]) -> str:
    return next(iter(parameter_names([variable], types).values()))


def _tagged(t: Transition) -> Tagged:
    return frozenset(
        [("pre", a) for a in t.before]
        + [("add", a) for a in t.after - t.before]
        + [("delete", a) for a in t.before - t.after]
        + [("during", a) for a in t.during]
    )
