"""The fast grounder against the naive one, and the numbered task against the semantics."""

from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_domains import atoms, covered_egg, domains, kitchen, problems

from symskill_pddl.planning.grounding import OutOfTimeError, TooLargeError, ground_task, reachable


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
