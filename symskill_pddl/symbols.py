"""The symbolic layer: types, predicates, operators, problems, plans, and what they mean. Standard library only.

Semantics are STRIPS with typing: a state is the set of true ground atoms; an action is applicable when its preconditions hold in
the state and none of its forbidden atoms does; its successor is ``(state - delete) | add`` (an atom in both stays true).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations, product

from symskill_pddl.errors import InputError, alternatives

ROOT_TYPE = "object"
GRIPPER_OPEN = "gripper-open"
"""The one predicate that is built in and not learned: aperture and command both say open. It has no arguments."""


@dataclass(frozen=True, order=True)
class Type:
    """An object type with one parent; the root is `object`."""

    name: str
    parent: str = ROOT_TYPE


@dataclass(frozen=True, order=True)
class Parameter:
    """A typed variable, `name` with its leading question mark: ``?food``."""

    name: str
    type: str

    def __post_init__(self) -> None:
        if not self.name.startswith("?"):
            raise InputError(f"a variable starts with '?', got '{self.name}'")


@dataclass(frozen=True, order=True)
class Predicate:
    """A relation over typed arguments."""

    name: str
    types: tuple[str, ...] = ()


@dataclass(frozen=True, order=True)
class Atom:
    """A predicate applied to names. Variables start with '?'; an atom without variables is ground."""

    predicate: str
    args: tuple[str, ...] = ()

    def substitute(self, binding: Mapping[str, str]) -> Atom:
        return Atom(self.predicate, tuple(binding.get(a, a) for a in self.args))

    @property
    def variables(self) -> tuple[str, ...]:
        return tuple(a for a in self.args if a.startswith("?"))

    def __str__(self) -> str:
        return "(" + " ".join((self.predicate, *self.args)) + ")"


State = frozenset[Atom]


@dataclass(frozen=True, order=True)
class Absent:
    """A negative condition: for every binding of `over`, `atom` is false. Empty `over` is a plain negated atom.

    ``Absent(Atom("lid-on-pan", ("?other", "?pan")), (Parameter("?other", "lid"),))`` says that no lid is on the pan.
    """

    atom: Atom
    over: tuple[Parameter, ...] = ()
    at_most_one: bool = False
    """For the same other arguments no two such atoms were ever seen to hold together. It changes no meaning: it is what an export
    without quantifiers may stand on."""


@dataclass(frozen=True)
class Operator:
    """A lifted action. All sets hold lifted atoms over `parameters`.

    `maintain` holds over [start, end) of the execution and may contain atoms that the operator itself deletes;
    `protected` is what must not fall.
    """

    name: str
    parameters: tuple[Parameter, ...]
    pre: frozenset[Atom]
    add: frozenset[Atom]
    delete: frozenset[Atom]
    maintain: frozenset[Atom] = frozenset()
    absent: frozenset[Absent] = frozenset()
    cost: float = 1.0
    distinct: frozenset[tuple[str, str]] | None = None
    """Pairs of parameters, in their order, that are bound to different objects. None is all pairs, which is what demonstrations
    show; a domain that somebody wrote has those that its text names."""

    def __post_init__(self) -> None:
        names = [p.name for p in self.parameters]
        if len(set(names)) != len(names):
            raise InputError(f"operator '{self.name}' declares a parameter twice: {' '.join(names)}")
        for atom in self.pre | self.add | self.delete | self.maintain:
            for variable in atom.variables:
                if variable not in names:
                    raise InputError(
                        f"operator '{self.name}' uses {variable} in {atom}, its parameters are {alternatives(names)}"
                    )
        for absent in self.absent:
            bound = {*names, *(p.name for p in absent.over)}
            for variable in absent.atom.variables:
                if variable not in bound:
                    raise InputError(f"operator '{self.name}' uses {variable} in not {absent.atom} without declaring it")
        pairs = frozenset(combinations(names, 2))
        if self.distinct == pairs:  # one way to say it, so that equal operators are equal
            object.__setattr__(self, "distinct", None)
        elif self.distinct and (unknown := sorted(self.distinct - pairs)):
            raise InputError(f"operator '{self.name}': {' and '.join(unknown[0])} are no two of its parameters in their order")

    @property
    def distinct_pairs(self) -> tuple[tuple[str, str], ...]:
        """The pairs of parameters that are bound to different objects, in order."""
        names = [p.name for p in self.parameters]
        return tuple(pair for pair in combinations(names, 2) if self.distinct is None or pair in self.distinct)

    @property
    def protected(self) -> frozenset[Atom]:
        return self.maintain - self.delete


@dataclass(frozen=True)
class GroundOperator:
    """An operator with an object for each parameter: one step of a plan, all sets ground."""

    name: str
    args: tuple[str, ...]
    pre: State
    add: State
    delete: State
    maintain: State = frozenset()
    absent: State = frozenset()
    cost: float = 1.0

    @property
    def protected(self) -> State:
        return self.maintain - self.delete

    def applicable(self, state: State) -> bool:
        return self.pre <= state and not (self.absent & state)

    def apply(self, state: State) -> State:
        return (state - self.delete) | self.add

    def __str__(self) -> str:
        return "(" + " ".join((self.name, *self.args)) + ")"


@dataclass(frozen=True)
class Domain:
    """Types, predicates and operators, each name declared once."""

    name: str
    types: tuple[Type, ...]
    predicates: tuple[Predicate, ...]
    operators: tuple[Operator, ...]

    def __post_init__(self) -> None:
        for what, names in (
            ("type", [t.name for t in self.types]),
            ("predicate", [p.name for p in self.predicates]),
            ("operator", [o.name for o in self.operators]),
        ):
            twice = sorted(n for n, times in Counter(names).items() if times > 1)
            if twice:
                raise InputError(f"domain '{self.name}' declares {what} '{twice[0]}' twice")
        known = {ROOT_TYPE, *(t.name for t in self.types)}
        for t in self.types:
            if t.parent not in known:
                raise InputError(
                    f"type '{t.name}' has the unknown parent '{t.parent}'; declared: {alternatives(u.name for u in self.types)}"
                )

    def operator(self, name: str) -> Operator:
        for op in self.operators:
            if op.name == name:
                return op
        raise InputError(f"unknown operator '{name}'; the domain has: {alternatives(o.name for o in self.operators)}")

    def predicate(self, name: str) -> Predicate:
        for p in self.predicates:
            if p.name == name:
                return p
        raise InputError(f"unknown predicate '{name}'; the domain has: {alternatives(p.name for p in self.predicates)}")

    @cached_property
    def _parents(self) -> dict[str, str]:
        return {t.name: t.parent for t in self.types}

    def is_a(self, name: str, ancestor: str) -> bool:
        """Whether type `name` is `ancestor` or below it."""
        if ancestor in (name, ROOT_TYPE):
            return True
        seen: set[str] = set()
        while name not in seen:
            if ancestor in (name, ROOT_TYPE):
                return True
            seen.add(name)
            name = self._parents.get(name, ROOT_TYPE)
        return False

    def ground(self, op: Operator, args: tuple[str, ...], objects: Mapping[str, str]) -> GroundOperator:
        """Bind `op` to `args`; `objects` maps every object of the problem to its type.

        Raises
        ------
        InputError
            Wrong number of arguments, an unknown object, an object of the wrong type, or one object for two parameters that
            are to be different.
        """
        if len(args) != len(op.parameters):
            expected = " ".join(f"{p.name} - {p.type}" for p in op.parameters)
            raise InputError(f"'{op.name}' takes {len(op.parameters)} arguments ({expected}), got {len(args)}: {' '.join(args)}")
        for parameter, arg in zip(op.parameters, args, strict=True):
            if arg not in objects:
                raise InputError(f"'{op.name}' names the unknown object '{arg}'; the problem has: {alternatives(objects)}")
            if not self.is_a(objects[arg], parameter.type):
                fitting = alternatives(o for o, t in objects.items() if self.is_a(t, parameter.type))
                raise InputError(
                    f"'{op.name}' needs a {parameter.type} for {parameter.name}, '{arg}' is a {objects[arg]}; "
                    f"objects that fit: {fitting}"
                )
        binding = dict(zip((p.name for p in op.parameters), args, strict=True))
        if len(set(args)) != len(args) and any(binding[a] == binding[b] for a, b in op.distinct_pairs):
            a, b = next((a, b) for a, b in op.distinct_pairs if binding[a] == binding[b])
            raise InputError(f"'{op.name}' needs different objects for {a} and {b}, got: {' '.join(args)}")

        def bind(atoms: Iterable[Atom]) -> State:
            return frozenset(a.substitute(binding) for a in atoms)

        absent: set[Atom] = set()
        for condition in op.absent:
            pools = [[o for o, t in objects.items() if self.is_a(t, p.type)] for p in condition.over]
            for choice in product(*pools):
                free = dict(zip((p.name for p in condition.over), choice, strict=True))
                absent.add(condition.atom.substitute({**binding, **free}))
        return GroundOperator(
            op.name, args, bind(op.pre), bind(op.add), bind(op.delete), bind(op.maintain), frozenset(absent), op.cost
        )


@dataclass(frozen=True)
class Problem:
    """Objects with their types, an initial state and a conjunctive goal."""

    name: str
    domain: str
    objects: tuple[tuple[str, str], ...]
    """(object, type) pairs."""
    init: State
    goal: State

    @property
    def object_types(self) -> dict[str, str]:
        return dict(self.objects)


@dataclass(frozen=True)
class Plan:
    """Ground steps in order, as (operator name, arguments)."""

    steps: tuple[tuple[str, tuple[str, ...]], ...] = ()
    cost: float | None = field(default=None, compare=False)
    times: tuple[tuple[float, float | None], ...] | None = field(default=None, compare=False)
    """Start and duration [s] of each step, where the plan said them."""

    def ground(self, domain: Domain, objects: Mapping[str, str]) -> tuple[GroundOperator, ...]:
        return tuple(domain.ground(domain.operator(name), args, objects) for name, args in self.steps)

    def __len__(self) -> int:
        return len(self.steps)


def validate(domain: Domain, problem: Problem, plan: Plan) -> None:
    """Run the plan by the semantics above.

    Raises
    ------
    InputError
        At the first step that is unknown, ill-typed or not applicable (naming the missing atoms), or if the goal is missed.
    """
    state = problem.init
    for number, (name, args) in enumerate(plan.steps, start=1):
        try:
            step = domain.ground(domain.operator(name), args, problem.object_types)
        except InputError as error:
            raise InputError(f"plan step {number}: {error}") from None
        if missing := step.pre - state:
            raise InputError(f"plan step {number} {step}: needs {' '.join(map(str, sorted(missing)))}, which does not hold there")
        if present := step.absent & state:
            raise InputError(f"plan step {number} {step}: forbids {' '.join(map(str, sorted(present)))}, which holds there")
        state = step.apply(state)
    if missing := problem.goal - state:
        raise InputError(f"the plan ends without the goal {' '.join(map(str, sorted(missing)))}")


def check_atom(domain: Domain, atom: Atom, types: Mapping[str, str], where: str) -> None:
    """Compare an atom with the declaration of its predicate; `types` maps each variable or object in scope to its type.

    Raises
    ------
    InputError
        Unknown predicate, wrong number of arguments, an argument that is not in `types`, or one of the wrong type.
    """
    try:
        predicate = domain.predicate(atom.predicate)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    if len(atom.args) != len(predicate.types):
        signature = " ".join((predicate.name, *predicate.types))
        raise InputError(f"{where}: ({signature}) takes {len(predicate.types)} arguments, got {len(atom.args)}: {atom}")
    for arg, expected in zip(atom.args, predicate.types, strict=True):
        if arg not in types:
            what = "variable" if arg.startswith("?") else "object"
            raise InputError(f"{where}: {atom} names the unknown {what} '{arg}'; there are: {alternatives(types)}")
        if not domain.is_a(types[arg], expected):
            raise InputError(f"{where}: {atom} needs the type {expected} where '{arg}' is of type {types[arg]}")


def check_domain(domain: Domain) -> None:
    """Check that every type and predicate used in the domain is declared, and that every atom fits its predicate.

    Raises
    ------
    InputError
        At the first use of an undeclared name, wrong arity or wrong type, naming the predicate or operator it stands in.
    """
    known = {ROOT_TYPE, *(t.name for t in domain.types)}

    def check_types(parameters: Iterable[str], where: str) -> None:
        for name in parameters:
            if name not in known:
                raise InputError(f"{where} uses the unknown type '{name}'; declared: {alternatives(known)}")

    for predicate in domain.predicates:
        check_types(predicate.types, f"predicate '{predicate.name}'")
    for op in domain.operators:
        where = f"operator '{op.name}'"
        check_types((p.type for p in op.parameters), where)
        scope = {p.name: p.type for p in op.parameters}
        for atom in sorted(op.pre | op.add | op.delete | op.maintain):
            check_atom(domain, atom, scope, where)
        for absent in sorted(op.absent):
            check_types((p.type for p in absent.over), where)
            check_atom(domain, absent.atom, scope | {p.name: p.type for p in absent.over}, where)


def check_problem(domain: Domain, problem: Problem) -> None:
    """Check that the objects of a problem have declared types, are declared once, and that init and goal fit the predicates.

    Raises
    ------
    InputError
        At the first name, arity or type that does not fit.
    """
    where = f"problem '{problem.name}'"
    known = {ROOT_TYPE, *(t.name for t in domain.types)}
    names = [name for name, _ in problem.objects]
    for name, kind in problem.objects:
        if kind not in known:
            raise InputError(f"{where}: object '{name}' has the unknown type '{kind}'; declared: {alternatives(known)}")
        if names.count(name) > 1:
            raise InputError(f"{where} declares the object '{name}' twice")
    for what, atoms in (("init", problem.init), ("goal", problem.goal)):
        for atom in sorted(atoms):
            check_atom(domain, atom, problem.object_types, f"{where}, {what}")
