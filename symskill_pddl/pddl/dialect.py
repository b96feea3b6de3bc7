"""What a domain becomes in each dialect of PDDL: symbols in, symbols out.

The law that ties writing to reading is ``read_domain(write_domain(d, dialect=x)) == exported(d, x).domain``.

| dialect    | negative conditions   | distinct parameters          | cost               | maintain                |
|------------|-----------------------|------------------------------|--------------------|-------------------------|
| `strips`   | complement predicates | static predicate `different` | none               | comment                 |
| `negative` | `not`, `forall`       | ``(not (= ?a ?b))``          | none               | comment                 |
| `costs`    | as `negative`         | as `negative`                | integer hundredths | comment                 |
| `temporal` | as `negative`         | as `negative`                | duration [s]       | `over all`, delete time |

Learned operators bind distinct parameters to distinct objects. PDDL does not, so the export says it wherever two such
parameters have related types. In `strips`, which has no equality, it is a static predicate that the problem states for every
pair of different objects: exact, and pruned while grounding. Hence a plan for the text is a plan by the semantics of
`symbols`, and the reverse, but for one thing that `strips` may have to add: the complement of "no lid on this pan" can be
kept only while at most one lid is on a pan. An operator that adds one without asking whether there is one asks in `strips`
(`Exported.stated`) where the demonstrations never showed two (`Absent.at_most_one`); where that was not observed, the dialect
refuses.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import combinations, permutations, product

from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.symbols import (
    ROOT_TYPE,
    Absent,
    Atom,
    Domain,
    Operator,
    Parameter,
    Predicate,
    Problem,
    check_domain,
    check_problem,
)

DIALECTS = ("strips", "negative", "costs", "temporal")
COST_SCALE = 100
"""Costs are exported as integers, in hundredths: Fast Downward and others refuse fractions."""


@dataclass(frozen=True)
class Complement:
    """A predicate that says of the arguments at `keep` that `predicate` is false for every choice of the others.

    The others range over `over` (one type per dropped position). With nothing dropped it is the plain complement of `predicate`.
    """

    name: str
    predicate: str
    keep: tuple[int, ...]
    over: tuple[tuple[int, str], ...]
    observed: bool = False
    """Whether the demonstrations show at most one denied atom at a time for the same kept arguments."""

    def of(self, atom: Atom) -> Atom:
        return Atom(self.name, tuple(atom.args[i] for i in self.keep))


@dataclass(frozen=True)
class Stated:
    """A precondition beyond what was learned: `operator` adds `effect`, so here it `needs` that there is none like it."""

    operator: str
    effect: Atom
    complement: Complement

    @property
    def needs(self) -> Atom:
        return self.complement.of(self.effect)


@dataclass(frozen=True)
class Exported:
    """A domain in one dialect, and how to bring a problem of the original domain along."""

    domain: Domain
    original: Domain
    dialect: str
    complements: tuple[Complement, ...] = ()
    different: str = ""
    """Name of the static inequality predicate, empty where it is not needed."""
    different_types: tuple[str, ...] = ()
    """Types of the parameters that could be bound to one object; only their objects are stated to be different."""
    arm: str = ""
    """Name of the predicate for the free arm, temporal only."""
    stated: tuple[Stated, ...] = ()
    """What the operators need here beyond the original: with any, that there is no plan for the text proves nothing for it."""

    def problem(self, problem: Problem) -> Problem:
        """The problem with the complements, inequalities and resources of this dialect in its initial state.

        Raises
        ------
        InputError
            The problem does not fit the domain, or its initial state breaks an exclusion that a compiled condition stands on.
        """
        check_problem(self.original, problem)
        objects, init = problem.object_types, set(problem.init)
        for complement in self.complements:
            types = self.domain.predicate(complement.name).types
            for args in product(*([o for o, t in problem.objects if self.domain.is_a(t, kind)] for kind in types)):
                holding = [a for a in problem.init if self._covers(complement, a, args, objects)]
                if len(holding) > 1:
                    raise InputError(
                        f"problem '{problem.name}': {' and '.join(map(str, sorted(holding)))} hold together, but the 'strips' "
                        f"dialect compiles on at most one of them; use 'negative'"
                    )
                if not holding:
                    init.add(Atom(complement.name, args))
        if self.different:
            mixed = sorted(o for o, t in problem.objects if any(self.domain.is_a(t, kind) for kind in self.different_types))
            init.update(Atom(self.different, pair) for pair in permutations(mixed, 2))
        if self.arm:
            init.add(Atom(self.arm))
        return replace(problem, init=frozenset(init))

    def _covers(self, complement: Complement, atom: Atom, args: tuple[str, ...], objects: dict[str, str]) -> bool:
        return (
            atom.predicate == complement.predicate
            and tuple(atom.args[i] for i in complement.keep) == args
            and all(self.domain.is_a(objects[atom.args[i]], kind) for i, kind in complement.over)
        )


@lru_cache(maxsize=16)
def exported(domain: Domain, dialect: str) -> Exported:
    """The domain as a dialect can say it. The last few are kept: every problem of a domain asks for it.

    Raises
    ------
    InputError
        An unknown dialect, an ill-formed domain, or a negative condition that `strips` cannot express; names the operator.
    """
    if dialect not in DIALECTS:
        raise InputError(f"unknown dialect '{dialect}'; there are: {alternatives(DIALECTS)}")
    check_domain(domain)
    plain = replace(domain, operators=tuple(_plain(domain, op, dialect) for op in domain.operators))
    if dialect == "strips":
        return _positive(domain, plain)
    if dialect == "temporal":
        arm = fresh("arm-free", domain)
        free = frozenset({Atom(arm)})
        operators = tuple(replace(op, pre=op.pre | free, add=op.add | free, delete=op.delete | free) for op in plain.operators)
        timed = replace(plain, predicates=(*plain.predicates, Predicate(arm)), operators=operators)
        return Exported(timed, domain, dialect, arm=arm)
    return Exported(plain, domain, dialect)


def expressible(domain: Domain) -> tuple[str, ...]:
    """The dialects that can say everything this domain says, plainest first; only `strips` is ever left out."""
    found = []
    for dialect in DIALECTS:
        try:
            exported(domain, dialect)
        except InputError:
            if dialect != "strips":
                raise
        else:
            found.append(dialect)
    return tuple(found)


def unifiable(domain: Domain, op: Operator) -> tuple[tuple[str, str], ...]:
    """Pairs of different parameters to which PDDL could bind one object: the type of one is the other's, or above it."""
    types, found = {p.name: p.type for p in op.parameters}, []
    for a, b in op.distinct_pairs:
        if domain.is_a(types[a], types[b]) or domain.is_a(types[b], types[a]):
            found.append((a, b))
    return tuple(found)


def fresh(name: str, domain: Domain) -> str:
    """`name`, or the first of name-2, name-3, ... that the domain does not use for anything."""
    taken = {*(t.name for t in domain.types), *(p.name for p in domain.predicates), *(o.name for o in domain.operators)}
    return next(n for n in (name, *(f"{name}-{i}" for i in range(2, len(taken) + 3))) if n not in taken)


def _plain(domain: Domain, op: Operator, dialect: str) -> Operator:
    """Drop what the dialect does not carry, and deletes that the same operator adds back; of the inequalities, what types say."""
    cost = {"costs": float(round(op.cost * COST_SCALE)), "temporal": round(op.cost, 3)}.get(dialect, 1.0)
    maintain = op.maintain if dialect == "temporal" else frozenset()
    absent = op.absent if dialect == "strips" else frozenset(replace(a, at_most_one=False) for a in op.absent)
    distinct = frozenset(unifiable(domain, op))
    return replace(op, delete=op.delete - op.add, cost=cost, maintain=maintain, absent=absent, distinct=distinct)


def _positive(original: Domain, domain: Domain) -> Exported:
    complements: dict[tuple[str, tuple[tuple[int, str], ...]], Complement] = {}
    observed = {(a.atom.predicate, _dropped(op, a)) for op in domain.operators for a in op.absent if a.at_most_one}
    for op in domain.operators:
        for absent in sorted(op.absent):
            over = _dropped(op, absent)
            key = (absent.atom.predicate, over)
            if key not in complements:
                dropped = {i for i, _ in over}
                keep = tuple(i for i in range(len(absent.atom.args)) if i not in dropped)
                prefix = "not" if not over else "no-" + "-".join(kind for _, kind in over) if _narrow(domain, key) else "none"
                taken = replace(domain, predicates=(*domain.predicates, *(Predicate(c.name) for c in complements.values())))
                complements[key] = Complement(fresh(f"{prefix}-{key[0]}", taken), key[0], keep, over, key in observed)
    for op in domain.operators:
        _check_complements(domain, op, complements.values())
    stated = tuple(s for complement in complements.values() if complement.over for s in _exclusive(domain, complement))
    clash = {p.type for op in domain.operators for pair in unifiable(domain, op) for p in op.parameters if p.name in pair}
    different = fresh("different", domain) if clash else ""
    predicates = [*domain.predicates]
    for complement in complements.values():
        types = domain.predicate(complement.predicate).types
        predicates.append(Predicate(complement.name, tuple(types[i] for i in complement.keep)))
    if different:
        predicates.append(Predicate(different, (ROOT_TYPE, ROOT_TYPE)))
    operators = []
    for op in domain.operators:
        pre = set(op.pre) | {Atom(different, pair) for pair in unifiable(domain, op)}
        pre |= {complements[a.atom.predicate, _dropped(op, a)].of(a.atom) for a in op.absent}
        pre |= {s.needs for s in stated if s.operator == op.name}
        add, delete = set(op.add), set(op.delete)
        for complement in complements.values():
            filled = {complement.of(a) for a in op.add if _touches(domain, op, complement, a)}
            delete |= filled
            add |= {complement.of(a) for a in op.delete if _touches(domain, op, complement, a)} - filled
        positive = replace(op, absent=frozenset(), distinct=frozenset())
        operators.append(replace(positive, pre=frozenset(pre), add=frozenset(add), delete=frozenset(delete)))
    compiled = replace(domain, predicates=tuple(predicates), operators=tuple(operators))
    return Exported(compiled, original, "strips", tuple(complements.values()), different, tuple(sorted(clash)), stated=stated)


def _check_complements(domain: Domain, op: Operator, complements: Iterable[Complement]) -> None:
    """Effects tell which complements change only while different atoms of an operator stay different once they are bound."""
    may_be_one = set(unifiable(domain, replace(op, distinct=None))) - set(op.distinct_pairs)
    for complement in complements if may_be_one else ():
        places = {complement.of(a) for a in op.add | op.delete if a.predicate == complement.predicate}
        for one, other in combinations(sorted(places), 2):
            pairs = [{a, b} for a, b in zip(one.args, other.args, strict=True) if a != b]
            if all(any(pair == set(known) for known in may_be_one) for pair in pairs):
                raise InputError(
                    f"operator '{op.name}': {' and '.join(sorted(pairs[0]))} may be one object, so the 'strips' dialect cannot "
                    f"compile the negative conditions on '{complement.predicate}'; use 'negative'"
                )


def _narrow(domain: Domain, key: tuple[str, tuple[tuple[int, str], ...]]) -> bool:
    """Whether the quantifier ranges over less than the predicate's own argument types."""
    types = domain.predicate(key[0]).types
    return any(types[i] != kind for i, kind in key[1])


def _dropped(op: Operator, absent: Absent) -> tuple[tuple[int, str], ...]:
    """Positions of the quantified arguments with the type each ranges over."""
    over = {p.name: p.type for p in absent.over}
    used = [a for a in absent.atom.args if a in over]
    if len(set(used)) != len(used):
        raise _cannot(op, absent, "a quantified variable stands there twice")
    return tuple((i, over[a]) for i, a in enumerate(absent.atom.args) if a in over)


def _touches(domain: Domain, op: Operator, complement: Complement, atom: Atom) -> bool:
    """Whether an effect atom is an instance of what the complement denies."""
    if atom.predicate != complement.predicate:
        return False
    types = {p.name: p.type for p in op.parameters}
    for i, kind in complement.over:
        bound = types[atom.args[i]]
        if not domain.is_a(bound, kind):
            if domain.is_a(kind, bound):
                raise InputError(
                    f"operator '{op.name}': the 'strips' dialect cannot tell whether {atom.args[i]} - {bound} in {atom} is a "
                    f"{kind}, which another operator's negative condition is about; use 'negative'"
                )
            return False
    return True


def _exclusive(domain: Domain, complement: Complement) -> Iterator[Stated]:
    """What makes it so that at most one denied atom holds at a time: each operator that adds one found none before, or takes one
    away. What an operator does not ask for is given back, where the demonstrations show it.

    Then, and only then, removing one leaves none. The initial state is checked when a problem is exported.
    """
    for op in domain.operators:
        added = [a for a in op.add if _touches(domain, op, complement, a)]
        removed = [a for a in op.delete if _touches(domain, op, complement, a)]
        for atom in sorted(removed):
            if atom not in op.pre:
                raise InputError(
                    f"operator '{op.name}': it deletes {atom} without requiring it, so the 'strips' dialect cannot keep "
                    f"({complement.name}); use 'negative'"
                )
        for atom in sorted(added):
            place = complement.of(atom)
            if sum(complement.of(a) == place for a in added) > 1:
                raise InputError(f"operator '{op.name}': it adds several atoms like {atom} at once; use the dialect 'negative'")
            swapped = any(complement.of(a) == place for a in removed)
            if swapped or atom in op.pre or _requires_none(op, complement, place):
                continue
            beside = any(complement.of(a) == place for a in op.pre if _touches(domain, op, complement, a))
            if complement.observed and not beside:
                yield Stated(op.name, atom, complement)
            else:
                raise InputError(
                    f"operator '{op.name}': it adds {atom} without requiring that there is none before, so the 'strips' dialect "
                    f"cannot compile the negative condition on '{complement.predicate}'; use 'negative'"
                )


def _requires_none(op: Operator, complement: Complement, place: Atom) -> bool:
    return any(
        absent.atom.predicate == complement.predicate
        and _dropped(op, absent) == complement.over
        and complement.of(absent.atom) == place
        for absent in op.absent
    )


def _cannot(op: Operator, absent: Absent, why: str) -> InputError:
    over = " ".join(f"{p.name} - {p.type}" for p in absent.over)
    return InputError(
        f"operator '{op.name}': the 'strips' dialect cannot say (forall ({over}) (not {absent.atom})): {why}; use 'negative'"
    )


def requirements(exported_domain: Exported) -> tuple[str, ...]:
    """Exactly the requirement keywords that the text of this domain uses."""
    domain, dialect = exported_domain.domain, exported_domain.dialect
    operators = domain.operators
    equality = dialect != "strips" and any(unifiable(domain, op) for op in operators)
    typed = domain.types or any(p.types for p in domain.predicates) or any(op.parameters for op in operators)
    negative = equality or any(op.absent for op in operators)
    universal = any(absent.over for op in operators for absent in op.absent)
    found: Iterable[tuple[str, object]] = (
        (":strips", True),
        (":typing", typed),
        (":negative-preconditions", negative),
        (":universal-preconditions", universal),
        (":equality", equality),
        (":action-costs", dialect == "costs"),
        (":durative-actions", dialect == "temporal"),
    )
    return tuple(name for name, used in found if used)


def parameter_list(parameters: Iterable[Parameter]) -> str:
    """``?food - food ?cabinet - cabinet``."""
    return " ".join(f"{p.name} - {p.type}" for p in parameters)
