"""Rules in an order in which they can be evaluated: what a rule denies is known before it is asked."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from symskill_pddl.errors import InputError
from symskill_pddl.pddl.syntax import And, Condition, Fact, Not, Or, Quantified, Rule


def layers(rules: Iterable[Rule]) -> tuple[tuple[Rule, ...], ...]:
    """The rules, layer by layer; raises `InputError` where a predicate is derived from its own absence."""
    rules = tuple(rules)
    level = {rule.head: 0 for rule in rules}
    for _ in range(len(level) + 1):
        before = dict(level)
        for rule in rules:
            for name, denied in _asked(rule.condition, denied=False):
                if name in level:
                    level[rule.head] = max(level[rule.head], level[name] + denied)
        if level == before:
            return tuple(tuple(r for r in rules if level[r.head] == i) for i in sorted(set(level.values())))
    circle = max(level, key=lambda name: level[name])
    raise InputError(f"the derived predicate '{circle}' depends on its own absence")


def _asked(part: Condition, *, denied: bool) -> Iterator[tuple[str, bool]]:
    match part:
        case Fact(atom=atom):
            yield atom.predicate, denied
        case Not(part=inner):
            yield from _asked(inner, denied=not denied)
        case And(parts=parts) | Or(parts=parts):
            for inner in parts:
                yield from _asked(inner, denied=denied)
        case Quantified(part=inner):
            yield from _asked(inner, denied=denied)
        case _:
            return
