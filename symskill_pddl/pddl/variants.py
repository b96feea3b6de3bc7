"""Actions and goals in disjunctive normal form, for a model whose operators know conjunctions only; see `compiled`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations, product

from symskill_pddl.pddl.evaluate import Semantics
from symskill_pddl.pddl.symbolic import BeyondModelError, beyond_what, costs_counted
from symskill_pddl.pddl.syntax import (
    Action,
    All,
    And,
    Change,
    Condition,
    Each,
    Effect,
    Fact,
    Not,
    Number,
    Or,
    Place,
    Quantified,
    Same,
    Set,
    Variable,
    When,
)
from symskill_pddl.pddl.task import Task
from symskill_pddl.symbols import ROOT_TYPE, Absent, Atom, Domain, Operator, Parameter, Predicate, Problem, Type

_CASES = 64
"""Operators that one action may become."""
_PARTS = 200
"""Parts that one quantifier may become."""
GOAL = "goal-reached"
SAME = "is-same-as"


@dataclass(frozen=True)
class _Literal:
    """A fact or an equality of two terms, or that it is not so; `over` quantifies a negative one."""

    atom: Atom
    value: bool = True
    over: tuple[Variable, ...] = ()


_Case = tuple[frozenset[_Literal], tuple[Variable, ...]]
"""Literals that hold together, and the variables that are to be found for them."""


class Compiler:
    """Compiles one task."""

    def __init__(self, task: Task) -> None:
        self._task, self._semantics = task, Semantics(task) if not task.beyond else None
        self._count = 0
        self._statics: dict[str, Predicate] = {}
        self._facts: set[Atom] = set()
        self._taken = {*task.domain.vocabulary.predicates, *(a.name for a in task.domain.actions)}

    def result(self) -> tuple[Domain, Problem, dict[str, tuple[str, int]], tuple[str, ...]]:
        """The model's domain and problem, what its operators stand for, and what is to be said."""
        task = self._task
        self._refuse()
        priced, operators, actions, remarks = (
            costs_counted(task.domain),
            list[Operator](),
            dict[str, tuple[str, int]](),
            list[str](),
        )
        for action in task.domain.actions:
            for i, (op, exact) in enumerate(self._operators(action, priced)):
                name = action.name if i == 0 else self._fresh(f"{action.name}-case-{i + 1}")
                operators.append(replace(op, name=name))
                actions[name] = (action.name, len(action.parameters))
                if not exact and not remarks:
                    remarks.append("costs that differ between steps of one action count as 1 here")
        cases = self._cases(task.problem.goal)
        goal = frozenset(literal.atom for literal in cases[0][0]) if len(cases) == 1 else frozenset()
        plain = len(cases) == 1 and not cases[0][1] and all(x.value and x.atom.predicate != "=" for x in cases[0][0])
        if not plain:
            reached = self._fresh(GOAL)
            self._statics[reached] = Predicate(reached)
            goal = frozenset({Atom(reached)})
            for case in cases:
                name = self._fresh("reach-goal")
                operators.append(self._operator(name, (), case, {Atom(reached)}, set(), 0.0))
                actions[name] = ("", 0)
        types = tuple(Type(name, self._single(parents)) for name, parents in task.domain.vocabulary.types.items())
        predicates = (
            *(Predicate(n, tuple(self._kind(k) for k in kinds)) for n, kinds in task.domain.vocabulary.predicates.items()),
            *self._statics.values(),
        )
        objects = tuple((name, self._single(kinds)) for name, kinds in task.objects.items())
        init = frozenset({f.atom for f in task.problem.init} | self._facts)
        domain = Domain(task.domain.name, types, predicates, tuple(operators))
        return domain, Problem(task.problem.name, domain.name, objects, init, goal), actions, tuple(remarks)

    def _refuse(self) -> None:
        task = self._task
        for what, source, (line, column) in task.features:
            if what in (
                "durative actions",
                "derived predicates",
                "numeric conditions",
                "facts that come true at a time",
            ) or what in {b[0] for b in task.beyond}:
                raise BeyondModelError(f"{what} are not supported by our own model", source=source, line=line, column=column)
        for source, remarks in zip(task.sources, (task.domain.remarks, task.problem.remarks), strict=True):
            for remark in (r for r in remarks if not r.harmless):
                raise BeyondModelError(remark.what, source=source, line=remark.at[0], column=remark.at[1])

    def _operators(self, action: Action, priced: bool) -> Iterator[tuple[Operator, bool]]:
        always, conditional = self._effects(action)
        self._limited(2 ** len(conditional), action.at, "conditional effects")
        number, exact = 0, True
        for chosen in _subsets(range(len(conditional))):
            needed = [conditional[i][0] if i in chosen else Not(conditional[i][0], action.at) for i in range(len(conditional))]
            changes = [*always, *(c for i in chosen for c in conditional[i][1])]
            add = {c.atom for c in changes if isinstance(c, Set) and c.value}
            delete = {c.atom for c in changes if isinstance(c, Set) and not c.value}
            cost = 0.0 if priced else 1.0
            for change in (c for c in changes if isinstance(c, Change)):
                if change.target.function != "total-cost" or change.symbol != "increase":
                    raise self._beyond("numeric effects", change.at)
                exact = exact and isinstance(change.amount, Number)
                cost += change.amount.value if isinstance(change.amount, Number) else 1.0
            for case in self._cases(And((action.condition(), *needed), action.at)):
                number += 1
                self._limited(number, action.at, "disjunctions and conditional effects")
                yield self._operator(action.name, action.parameters, case, add, delete, cost), exact

    def _effects(self, action: Action) -> tuple[list[Set | Change], list[tuple[Condition, list[Set | Change]]]]:
        """What an action always does, and what it does under conditions."""
        always: list[Set | Change] = []
        found: dict[Condition, list[Set | Change]] = {}

        def gather(part: Effect, binding: Mapping[str, str], under: tuple[Condition, ...]) -> None:
            match part:
                case All(parts=parts):
                    for inner in parts:
                        gather(inner, binding, under)
                case When(condition=condition, effect=inner):
                    gather(inner, binding, (*under, _bound(condition, binding)))
                case Each(variables=variables, effect=inner, at=at):
                    for wider in self._expanded(variables, binding, at):
                        gather(inner, wider, under)
                case Set():
                    put(replace(part, atom=part.atom.substitute(binding)), under)
                case Change():
                    put(part, under)

        def put(change: Set | Change, under: tuple[Condition, ...]) -> None:
            if under:
                found.setdefault(under[0] if len(under) == 1 else And(under), []).append(change)
            else:
                always.append(change)

        gather(action.effect(), {}, ())
        return always, list(found.items())

    def _expanded(self, variables: tuple[Variable, ...], binding: Mapping[str, str], at: Place) -> list[dict[str, str]]:
        assert self._semantics is not None  # `_refuse` came before
        found: list[dict[str, str]] = []
        for wider in self._semantics.bindings(variables, binding):
            found.append(wider)
            if len(found) > _PARTS:
                raise self._beyond("quantifiers over so many objects", at)
        return found

    def _cases(self, part: Condition, *, value: bool = True) -> list[_Case]:
        """The ways to make a condition true, or false."""
        match part:
            case Fact(atom=atom):
                return [(frozenset({_Literal(atom, value)}), ())]
            case Same(left=left, right=right):
                if left == right:
                    return [(frozenset(), ())] if value else []
                return [(frozenset({_Literal(Atom("=", (left, right)), value)}), ())]
            case Not(part=inner):
                return self._cases(inner, value=not value)
            case And(parts=parts, at=at) | Or(parts=parts, at=at):
                if isinstance(part, Or) == value:
                    return [case for p in parts for case in self._cases(p, value=value)]
                return self._joined([self._cases(p, value=value) for p in parts], at)
            case Quantified(every=every, variables=variables, part=inner, at=at):
                if every == value:
                    return self._every(variables, inner, value, at)
                self._count += 1
                fresh = {v.name: f"{v.name}-{self._count}" for v in variables}
                named = tuple(Variable(fresh[v.name], v.types, v.at) for v in variables)
                return [(case, (*named, *extra)) for case, extra in self._cases(_bound(inner, fresh), value=value)]
            case _:
                raise self._beyond(beyond_what(part), part.at)

    def _every(self, variables: tuple[Variable, ...], inner: Condition, value: bool, at: Place) -> list[_Case]:
        """A condition for all bindings: as it is where it denies one atom, else a conjunction over the objects."""
        core, sign = inner, value
        while isinstance(core, Not):
            core, sign = core.part, not sign
        if isinstance(core, Fact) and not sign and all(len(v.types) == 1 for v in variables):
            return [(frozenset({_Literal(core.atom, False, variables)}), ())]
        parts = [_bound(inner, binding) for binding in self._expanded(variables, {}, at)]
        return self._joined([self._cases(p, value=value) for p in parts], at)

    def _joined(self, parts: list[list[_Case]], at: Place) -> list[_Case]:
        cases: list[_Case] = [(frozenset(), ())]
        for choices in parts:
            self._limited(len(cases) * len(choices), at, "disjunctions")
            cases = [(a | b, (*x, *y)) for (a, x), (b, y) in product(cases, choices)]
        return cases

    def _operator(
        self, name: str, parameters: tuple[Variable, ...], case: _Case, add: set[Atom], delete: set[Atom], cost: float
    ) -> Operator:
        literals, extra = case
        listed = [Parameter(v.name, self._kind(v.types)) for v in (*parameters, *extra)]
        pre = {self._is(v.name, v.types) for v in (*parameters, *extra) if len(v.types) > 1}
        terms = {t for x in literals for t in x.atom.args if t not in {v.name for v in x.over}} | {
            t for a in add | delete for t in a.args
        }
        names = {v.name for v in (*parameters, *extra)}
        constants = {}
        for constant in sorted(t for t in terms if t not in names):
            constants[constant] = f"?is-{constant}"
            listed.append(Parameter(f"?is-{constant}", self._single(self._task.objects[constant])))
            pre.add(self._fixed(constant, f"?is-{constant}"))
        order = [p.name for p in listed]
        absent, distinct = set[Absent](), set[tuple[str, str]]()
        for literal in literals:
            atom = literal.atom.substitute(constants)
            if atom.predicate != "=":
                over = tuple(Parameter(v.name, self._kind(v.types)) for v in literal.over)
                absent.add(Absent(atom, over)) if not literal.value else pre.add(atom)
            elif literal.value:
                pre.add(self._equal(*atom.args))
            else:
                first, second = sorted(atom.args, key=order.index)
                distinct.add((first, second))
        return Operator(
            name,
            tuple(listed),
            frozenset(pre),
            frozenset(a.substitute(constants) for a in add),
            frozenset(a.substitute(constants) for a in delete),
            absent=frozenset(absent),
            cost=cost,
            distinct=frozenset(distinct),
        )

    def _fixed(self, constant: str, variable: str) -> Atom:
        """That a variable is bound to a constant."""
        return self._static(f"is-{constant}", {(constant,)}, (variable,))

    def _is(self, variable: str, kinds: tuple[str, ...]) -> Atom:
        """That it is of one of the types."""
        assert self._semantics is not None  # `_refuse` came before
        return self._static("is-" + "-or-".join(kinds), {(o,) for o in self._semantics.pool(kinds)}, (variable,))

    def _equal(self, left: str, right: str) -> Atom:
        return self._static(SAME, {(o, o) for o in self._task.objects}, (left, right))

    def _static(self, wish: str, holds: set[tuple[str, ...]], args: tuple[str, ...]) -> Atom:
        if wish in self._task.domain.vocabulary.predicates:
            wish = f"{wish}-here"
        self._statics.setdefault(wish, Predicate(wish, (ROOT_TYPE,) * len(args)))
        self._facts |= {Atom(wish, a) for a in holds}
        return Atom(wish, args)

    def _kind(self, kinds: tuple[str, ...]) -> str:
        """The type, or the lowest one that all of them are below."""
        above = self._task.domain.vocabulary.above
        shared = frozenset.intersection(*(above[kind] for kind in kinds))
        return max(sorted(shared), key=lambda kind: len(above[kind]))

    def _single(self, kinds: tuple[str, ...]) -> str:
        if len(kinds) != 1:
            raise self._beyond("types with several parents, and objects of 'either' type,", (1, 1))
        return kinds[0]

    def _limited(self, number: int, at: Place, what: str) -> None:
        if number > _CASES:
            raise self._beyond(f"{what} with more than {_CASES} cases", at)

    def _beyond(self, what: str, at: Place) -> BeyondModelError:
        source = self._task.sources[0]
        return BeyondModelError(f"{what} are not supported by our own model", source=source, line=at[0], column=at[1])

    def _fresh(self, wish: str) -> str:
        name = next(n for n in (wish, *(f"{wish}-{i}" for i in range(2, len(self._taken) + 3))) if n not in self._taken)
        self._taken.add(name)
        return name


def _subsets(items: Iterable[int]) -> Iterator[tuple[int, ...]]:
    listed = list(items)
    for size in range(len(listed) + 1):
        yield from combinations(listed, size)


def _bound(part: Condition, binding: Mapping[str, str]) -> Condition:
    """The condition with terms for its free variables."""
    match part:
        case Fact():
            return replace(part, atom=part.atom.substitute(binding))
        case Same():
            return replace(part, left=binding.get(part.left, part.left), right=binding.get(part.right, part.right))
        case Not():
            return replace(part, part=_bound(part.part, binding))
        case And() | Or():
            return replace(part, parts=tuple(_bound(p, binding) for p in part.parts))
        case Quantified():
            inner = {k: v for k, v in binding.items() if k not in {x.name for x in part.variables}}
            return replace(part, part=_bound(part.part, inner))
        case _:
            return part
