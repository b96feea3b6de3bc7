"""The fast grounder against the naive one, and the numbered task against the semantics."""

from dataclasses import replace
from itertools import count, product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_domains import atoms, covered_egg, domains, kitchen, problems

from symskill_pddl.planning.grounding import OutOfTimeError, TooLargeError, ground_task, reachable
from symskill_pddl.symbols import Atom, Domain, Operator, Parameter, Predicate, Problem, Type


def naive(domain, problem):
    objects = problem.object_types
    every = []
    for op in domain.operators:
        pools = [[o for o, t in objects.items() if domain.is_a(t, p.type)] for p in op.parameters]
        every += [domain.ground(op, args, objects) for args in product(*pools) if len(set(args)) == len(args)]
    reached, found = set(problem.init), {}
    while new := [s for s in every if (s.name, s.args) not in found and s.pre <= reached]:
        for step in new:
            found[step.name, step.args] = step
            reached |= step.add
    return found, reached


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_reachable_is_what_the_naive_loop_finds(data):
    domain = data.draw(domains())
    problem = data.draw(problems(domain))
    found, reached = naive(domain, problem)
    steps, layers = reachable(domain, problem)
    assert {(s.name, s.args): s for s in steps} == found
    assert len(steps) == len(found)
    assert layers.keys() == reached
    assert {a for a, layer in layers.items() if layer == 0} == problem.init


def test_layers_count_the_way():
    _, layers = reachable(kitchen(), covered_egg())
    assert layers[next(iter(atoms("gripper-holds-food egg")))] == 1
    assert layers[next(iter(atoms("food-in-pan egg pan-c")))] == 2


def test_irrelevant_actions_are_left_out():
    from dataclasses import replace

    task = ground_task(kitchen(), replace(covered_egg(), goal=atoms("gripper-holds-lid lid-a")), extra_costs={})
    assert {a.step[0] for a in task.actions} <= {"pick-lid", "place-lid", "place-food", "pick-food"}
    bare = replace(covered_egg(), goal=atoms("lid-on-pan lid-a pan-a"))
    assert ground_task(kitchen(), bare, extra_costs={}).goal is not None


def test_limits():
    with pytest.raises(OutOfTimeError):
        reachable(kitchen(), covered_egg(), deadline=0.0)
    with pytest.raises(TooLargeError, match="more than 3"):
        reachable(kitchen(), covered_egg(), limit=3)


def ring(size=13, length=7):
    """A ring of an odd number of edges, which a graph of two halves does not have: a join that fires nothing."""
    names = [f"?{i}" for i in range(length)]
    pre = frozenset(Atom("edge", (one, two)) for one, two in zip(names, [*names[1:], names[0]], strict=True))
    operator = Operator("ring", tuple(Parameter(name, "t") for name in names), pre, frozenset({Atom("done")}), frozenset())
    domain = Domain("d", (Type("t"),), (Predicate("edge", ("t", "t")), Predicate("done")), (operator,))
    init = frozenset(Atom("edge", (f"o{i}", f"o{j}")) for i in range(size) for j in range(size) if (i + j) % 2)
    return domain, Problem("p", "d", tuple((f"o{i}", "t") for i in range(size)), init, frozenset({Atom("done")}))


def test_a_join_that_ends_nowhere_is_bounded(monkeypatch):
    with pytest.raises(TooLargeError, match="more than 1000 facts and objects to try"):
        reachable(*ring(), matches=1000)
    ticks = count(0.0, 1.0)
    monkeypatch.setattr("time.monotonic", lambda: next(ticks))
    with pytest.raises(OutOfTimeError):
        reachable(*ring(), deadline=10.0)


def test_free_parameters_are_counted_too():
    domain, problem = ring()
    bare = replace(domain, operators=(replace(domain.operators[0], pre=frozenset()),))
    with pytest.raises(TooLargeError, match="to try"):
        reachable(bare, problem, matches=1000)
