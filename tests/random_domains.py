"""Random well-formed domains, problems and plans for hypothesis; and a small hand-made kitchen."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

from hypothesis import strategies as st

from symskill_pddl.symbols import Absent, Atom, Domain, Operator, Parameter, Predicate, Problem, State, Type


def _atoms(domain_predicates, is_a, scope):
    """Every well-typed atom over the names in scope."""
    found = []
    for predicate in domain_predicates:
        pools = [[n for n, t in scope.items() if is_a(t, wanted)] for wanted in predicate.types]
        found += [Atom(predicate.name, args) for args in product(*pools)]
    return found


@st.composite
def domains(draw, *, negative: bool = True, quantified: bool = True) -> Domain:
    types = []
    for i in range(draw(st.integers(1, 3))):
        types.append(Type(f"type{i}", draw(st.sampled_from(["object", *(t.name for t in types)]))))
    kinds = ["object", *(t.name for t in types)]
    predicates = tuple(
        Predicate(f"pred{i}", tuple(draw(st.lists(st.sampled_from(kinds), max_size=2)))) for i in range(draw(st.integers(1, 4)))
    )
    skeleton = Domain("random", tuple(types), predicates, ())
    operators = []
    for i in range(draw(st.integers(1, 4))):
        parameters = tuple(Parameter(f"?p{j}", draw(st.sampled_from(kinds))) for j in range(draw(st.integers(0, 3))))
        scope = {p.name: p.type for p in parameters}
        possible = _atoms(predicates, skeleton.is_a, scope)
        some = st.frozensets(st.sampled_from(possible), max_size=3) if possible else st.just(frozenset())
        pre, add, delete = draw(some), draw(some), draw(some)
        absent = set()
        if negative:
            absent |= {Absent(a) for a in draw(some) - pre}
            if quantified and draw(st.booleans()):
                extra = Parameter("?z0", draw(st.sampled_from(kinds)))
                over = [a for a in _atoms(predicates, skeleton.is_a, {**scope, "?z0": extra.type}) if "?z0" in a.args]
                if over:
                    absent.add(Absent(draw(st.sampled_from(over)), (extra,)))
        maintain = draw(some)
        cost = draw(st.integers(0, 900)) / 100
        operators.append(Operator(f"op{i}", parameters, pre, add, delete, maintain, frozenset(absent), cost))
    return Domain("random", tuple(types), predicates, tuple(operators))


@st.composite
def problems(draw, domain: Domain, n_objects: int = 4) -> Problem:
    kinds = ["object", *(t.name for t in domain.types)]
    objects = tuple((f"obj{i}", draw(st.sampled_from(kinds))) for i in range(draw(st.integers(1, n_objects))))
    possible = _atoms(domain.predicates, domain.is_a, dict(objects))
    some = st.frozensets(st.sampled_from(possible), max_size=6) if possible else st.just(frozenset())
    goal = st.frozensets(st.sampled_from(possible), max_size=2) if possible else st.just(frozenset())
    return Problem("random-problem", domain.name, objects, draw(some), draw(goal))


def breadth_first(domain: Domain, problem: Problem, limit: int = 3000) -> int | None:
    """Length of a shortest plan, by the semantics of `symbols` and nothing else; None where there is none.

    Raises
    ------
    OverflowError
        More than `limit` states.
    """
    objects = problem.object_types
    steps = []
    for op in domain.operators:
        pools = [[o for o, t in objects.items() if domain.is_a(t, p.type)] for p in op.parameters]
        steps += [domain.ground(op, args, objects) for args in product(*pools) if len(set(args)) == len(args)]
    seen: set[State] = {problem.init}
    layer, depth = [problem.init], 0
    while layer:
        if any(problem.goal <= state for state in layer):
            return depth
        following = []
        for state in layer:
            for step in steps:
                if step.applicable(state) and (successor := step.apply(state)) not in seen:
                    seen.add(successor)
                    following.append(successor)
        if len(seen) > limit:
            raise OverflowError
        layer, depth = following, depth + 1
    return None


def atoms(text: str) -> frozenset[Atom]:
    """``"on lid pan, open"`` as atoms."""
    return frozenset(Atom(words[0], tuple(words[1:])) for part in text.split(",") if (words := part.split()))


FOOD, LID, PAN = Parameter("?food", "food"), Parameter("?lid", "lid"), Parameter("?pan", "pan")
NO_LID = Absent(Atom("lid-on-pan", ("?other", "?pan")), (Parameter("?other", "lid"),))


def kitchen() -> Domain:
    """Lids cover pans, food goes into uncovered ones; the negative conditions are quantified."""
    return Domain(
        "kitchen",
        (Type("food"), Type("lid"), Type("pan")),
        (
            Predicate("food-in-pan", ("food", "pan")),
            Predicate("gripper-holds-food", ("food",)),
            Predicate("gripper-holds-lid", ("lid",)),
            Predicate("gripper-open"),
            Predicate("lid-on-pan", ("lid", "pan")),
        ),
        (
            Operator(
                "pick-lid",
                (LID, PAN),
                atoms("lid-on-pan ?lid ?pan, gripper-open"),
                atoms("gripper-holds-lid ?lid"),
                atoms("lid-on-pan ?lid ?pan, gripper-open"),
                atoms("lid-on-pan ?lid ?pan, gripper-open"),
                cost=2.5,
            ),
            Operator(
                "place-lid",
                (LID, PAN),
                atoms("gripper-holds-lid ?lid"),
                atoms("lid-on-pan ?lid ?pan, gripper-open"),
                atoms("gripper-holds-lid ?lid"),
                atoms("gripper-holds-lid ?lid"),
                frozenset({NO_LID}),
                cost=3.0,
            ),
            Operator(
                "pick-food",
                (FOOD, PAN),
                atoms("food-in-pan ?food ?pan, gripper-open"),
                atoms("gripper-holds-food ?food"),
                atoms("food-in-pan ?food ?pan, gripper-open"),
                atoms("food-in-pan ?food ?pan, gripper-open"),
                frozenset({NO_LID}),
            ),
            Operator(
                "place-food",
                (FOOD, PAN),
                atoms("gripper-holds-food ?food"),
                atoms("food-in-pan ?food ?pan, gripper-open"),
                atoms("gripper-holds-food ?food"),
                atoms("gripper-holds-food ?food"),
                frozenset({NO_LID}),
                cost=1.25,
            ),
        ),
    )


def careless_kitchen(at_most_one: bool) -> Domain:
    """The same, but nobody asks whether there is a lid before another is put on; whether two were ever seen is told."""
    operators = (
        replace(
            op,
            absent=frozenset(replace(a, at_most_one=at_most_one) for a in op.absent) if op.name != "place-lid" else frozenset(),
        )
        for op in kitchen().operators
    )
    return replace(kitchen(), operators=tuple(operators))


def covered_egg() -> Problem:
    """An egg in a covered pan has to go to another covered pan, which is closed again."""
    return Problem(
        "egg",
        "kitchen",
        (
            ("egg", "food"),
            ("lid-a", "lid"),
            ("lid-b", "lid"),
            ("pan-a", "pan"),
            ("pan-b", "pan"),
            ("pan-c", "pan"),
            ("pan-d", "pan"),
        ),
        atoms("food-in-pan egg pan-a, lid-on-pan lid-a pan-a, lid-on-pan lid-b pan-b, gripper-open"),
        atoms("food-in-pan egg pan-b, lid-on-pan lid-b pan-b"),
    )
