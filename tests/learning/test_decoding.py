"""The cheapest division of a recording, against trying them all."""

from itertools import combinations, pairwise, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symskill_pddl.learning import decoding
from symskill_pddl.learning.decoding import Hypothesis, Span, decode


def steps(levels, length=20, sigma=0.1, seed=0):
    rng = np.random.default_rng(seed)
    return np.concatenate([np.full((length, 1), float(level)) for level in levels]) + rng.normal(
        0.0, sigma, (length * len(levels), 1)
    )


def states(x, sigma=0.1, cost=5.0, repeats=False):
    n = len(x)
    return {
        "constant": Hypothesis(((x, np.full(n, sigma**-2)),), np.full(n, -0.5), repeats),
        "other": Hypothesis((), np.full(n, cost)),
    }


def cost_of(x, spans, change, sigma=0.1, cost=5.0):
    total = change * (len(spans) - 1)
    for s in spans:
        part = x[s.start : s.stop]
        own = 0.5 * float(np.sum((part - part.mean(axis=0)) ** 2)) / sigma**2 - 0.5 * len(part)
        total += own if s.state == "constant" else cost * len(part)
    return total


def test_levels_apart_with_a_ramp_between_are_found():
    x = np.concatenate([steps([0.0]), np.linspace(0.0, 5.0, 10)[:, None], steps([5.0], seed=1)])
    found = decode(states(x), 10.0, np.arange(len(x) + 1.0), 2.0)
    assert [s.state for s in found] == ["constant", "other", "constant"]
    assert abs(found[0].stop - 20) <= 1
    assert abs(found[1].stop - 30) <= 1


def test_a_state_that_repeats_may_follow_itself():
    x = steps([0.0, 3.0])
    assert [s.state for s in decode(states(x, repeats=True), 10.0, np.arange(41.0), 2.0)] == ["constant", "constant"]
    assert [s.state for s in decode(states(x), 10.0, np.arange(41.0), 2.0)] == ["constant", "other", "constant"]


@given(st.lists(st.sampled_from([0.0, 0.3, 2.0]), min_size=3, max_size=8), st.sampled_from([1.0, 3.0]))
@settings(max_examples=40, deadline=None)
def test_no_other_division_is_cheaper(levels, change):
    x = np.array(levels)[:, None]
    n = len(x)
    best = min(
        cost_of(x, [Span(s, a, b) for s, a, b in zip(names, (0, *cuts), (*cuts, n), strict=True)], change)
        for k in range(n)
        for cuts in combinations(range(1, n), k)
        for names in product(("constant", "other"), repeat=k + 1)
        if all(a != b for a, b in pairwise(names))
    )
    found = decode(states(x), change, np.arange(n + 1.0), 0.0)
    assert cost_of(x, found, change) == pytest.approx(best)


def test_blocks_change_nothing(monkeypatch):
    x = steps([0.0, 2.0, -1.0, 4.0, 0.5], length=30)
    whole = decode(states(x, repeats=True), 8.0, np.arange(151.0), 4.0)
    monkeypatch.setattr(decoding, "BLOCK", 7)
    assert decode(states(x, repeats=True), 8.0, np.arange(151.0), 4.0) == whole


def test_what_weighs_nothing_costs_nothing():
    x = steps([0.0, 0.0])
    x[10:20] = 100.0
    weight = np.full(40, 100.0)
    weight[10:20] = 0.0
    unseen = {
        "constant": Hypothesis(((x, weight),), np.zeros(40)),
        "other": Hypothesis((), np.where(weight > 0, 5.0, 0.0)),
    }
    assert decode(unseen, 10.0, np.arange(41.0), 2.0) == (Span("constant", 0, 40),)
