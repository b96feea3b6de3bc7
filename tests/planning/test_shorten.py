"""Plans without detours are plans, and what is left of a plan is one."""

from itertools import pairwise

from hypothesis import assume, given, settings
from hypothesis import strategies as st
from random_domains import atoms, covered_egg, domains, kitchen, problems

from symskill_pddl.errors import InputError
from symskill_pddl.planning import Builtin
from symskill_pddl.planning.moves import Numbered, shortened
from symskill_pddl.planning.shorten import Move, rest_of, without_detours
from symskill_pddl.symbols import Atom, Domain, Operator, Parameter, Plan, Predicate, Problem, Type, validate

EGG = covered_egg()


def ground(*steps):
    return Plan(tuple((name, tuple(args.split())) for name, args in steps)).ground(kitchen(), EGG.object_types)


def test_there_and_back_is_left_out():
    good = Builtin().solve(kitchen(), EGG).unwrap().ground(kitchen(), EGG.object_types)
    back = kitchen().ground(kitchen().operator("place-lid"), good[0].args, EGG.object_types)
    assert shortened(kitchen(), EGG.object_types, (good[0], back, *good), EGG.init, EGG.goal) == good


def test_what_was_put_down_on_the_way_is_fetched_where_it_lay():
    """Without the detour the last pick is from another pan than the plan says."""
    steps = ground(
        ("pick-lid", "lid-a pan-a"), ("place-lid", "lid-a pan-c"), ("pick-lid", "lid-a pan-c"), ("place-lid", "lid-a pan-d")
    )
    first, _, _, last = steps
    assert shortened(kitchen(), EGG.object_types, steps, EGG.init, atoms("lid-on-pan lid-a pan-d")) == (first, last)
    held = shortened(kitchen(), EGG.object_types, steps[:3], EGG.init, atoms("gripper-holds-lid lid-a"))
    assert held == (first,)


def walk(n, jump):
    go = Operator(
        "go",
        (Parameter("?a", "place"), Parameter("?b", "place")),
        pre=frozenset({Atom("at", ("?a",)), Atom("link", ("?a", "?b"))}),
        add=frozenset({Atom("at", ("?b",))}),
        delete=frozenset({Atom("at", ("?a",))}),
    )
    domain = Domain("walk", (Type("place"),), (Predicate("at", ("place",)), Predicate("link", ("place", "place"))), (go,))
    names = [f"p{i:04}" for i in range(n)]
    init = {Atom("link", pair) for pair in [*pairwise(names), *(p[::-1] for p in pairwise(names)), jump]} | {
        Atom("at", (names[0],))
    }
    objects = tuple((name, "place") for name in names)
    return domain, Problem("far", "walk", objects, frozenset(init), frozenset({Atom("at", (names[-1],))})), names


def test_a_loop_in_a_plan_of_a_thousand_steps():
    domain, problem, names = walk(1000, ("p0000", "p0001"))
    way = [*names[:500], *names[498:450:-1], *names[452:]]
    steps = Plan(tuple(("go", pair) for pair in pairwise(way))).ground(domain, problem.object_types)
    found = shortened(domain, problem.object_types, steps, problem.init, problem.goal)
    assert [s.args for s in found] == list(pairwise(names))


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_random_plans(data):
    """Random walks are plans for what they end in; what remains of them is one, costs no more, and misses no part of the goal."""
    domain = data.draw(domains())
    problem = data.draw(problems(domain))
    types, state, steps = problem.object_types, problem.init, []
    for _ in range(data.draw(st.integers(1, 8))):
        choices = []
        for op in domain.operators:
            args = tuple(data.draw(st.sampled_from(sorted(types))) for _ in op.parameters)
            try:
                step = domain.ground(op, args, types)
            except InputError:
                continue
            if step.applicable(state):
                choices.append(step)
        if choices:
            steps.append(data.draw(st.sampled_from(choices)))
            state = steps[-1].apply(state)
    assume(steps)
    goal = frozenset(data.draw(st.lists(st.sampled_from(sorted(state)), max_size=3))) if state else frozenset()
    found = shortened(domain, types, steps, problem.init, goal)
    validate(domain, Problem("p", domain.name, problem.objects, problem.init, goal), Plan(tuple((s.name, s.args) for s in found)))
    assert sum(s.cost for s in found) <= sum(s.cost for s in steps)
    numbered = Numbered()
    moves, wanted = [numbered.move(s) for s in steps], numbered.mask(goal)
    for other in (problem.init, state, steps[0].apply(problem.init)):
        rest = rest_of(moves, numbered.known(other), wanted)
        assert rest is not None or other not in (problem.init, state)
        if rest is not None:
            plan = Plan(tuple((m.of.name, m.of.args) for m in rest))
            validate(domain, Problem("p", domain.name, problem.objects, other, goal), plan)


def move(name, pre, add, delete=0, absent=0, cost=1.0):
    return Move(pre, absent, delete, add, cost, name)


def test_steps_that_cost_nothing_go_too():
    plan = [move("free", 1, 2, cost=0.0), move("needed", 1, 4)]
    assert [m.of for m in without_detours(plan, 1, 4)] == ["needed"]


def test_a_dearer_replacement_is_no_gain():
    plan = [move("a", 1, 2), move("b", 2, 4)]
    assert without_detours(plan, 1, 4, lambda wanted, state: move("dear", 1, 4, cost=3.0)) == tuple(plan)
    assert [m.of for m in without_detours(plan, 1, 4, lambda wanted, state: move("other", 1, 4))] == ["other"]


def test_the_shortest_stretch_or_what_is_applicable():
    plan = [move("a", 1, 2, 1), move("b", 2, 4), move("c", 4, 8, absent=16)]
    assert [m.of for m in rest_of(plan, 1, 8)] == ["a", "b", "c"]
    assert [m.of for m in rest_of(plan, 2 | 4, 8)] == ["c"]
    assert rest_of(plan, 4 | 16, 8) is None
    assert rest_of(plan, 8, 8) == ()
    assert [m.of for m in rest_of([move("x", 1, 8), move("y", 2, 16)], 2 | 8, 8 | 16)] == ["y"]
