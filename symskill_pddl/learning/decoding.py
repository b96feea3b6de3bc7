"""The best division of a recording into spans of a few states: semi-Markov Viterbi, exact, on any cost of sums and means.

A state says of a span [a, b) of cells either that observations are constant over it, up to noise (half the weighted sum of their
squared deviations from their own mean), or only what each cell costs, or both. All of it comes from cumulative sums, so that the
costs of all spans that end in a block of cells are a few matrix products.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.geometry import Array

IntArray = NDArray[np.intp]
BLOCK = 256
"""Ends of spans that are computed at a time: bounds the memory, changes nothing."""


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """One state of an object, as costs.

    Attributes
    ----------
    constant : tuple of (ndarray (n, d), ndarray (n,))
        Observations that the state says are constant over a span, with the weight of each cell, 1 / variance.
    cell : ndarray (n,)
        What each cell costs by itself.
    repeats : bool
        Whether another span of the same state may follow at once, with another constant.
    """

    constant: tuple[tuple[Array, Array], ...]
    cell: Array
    repeats: bool = False

    def sums(self) -> Sums:
        parts = []
        for x, w in self.constant:
            x = x - np.median(x, axis=0)  # the smaller the numbers, the more exact are differences of sums
            parts.append(tuple(_summed(v) for v in (w[:, None] * x, w * np.einsum("ij,ij->i", x, x), w)))
        return Sums(tuple(parts), _summed(self.cell))


@dataclass(frozen=True, eq=False)
class Sums:
    """Cumulative sums of a hypothesis, at the n + 1 edges of the cells."""

    parts: tuple[tuple[Array, ...], ...]
    cell: Array

    def costs(self, stops: slice, starts: IntArray) -> Array:
        """Of the spans from `starts` (m,) to the edges `stops` (k,), (k, m); without meaning where a stop comes first."""
        total = self.cell[stops][:, None] - self.cell[starts][None]
        for first, second, weight in self.parts:
            a, b = first[stops], first[starts]
            squared = np.einsum("ij,ij->i", a, a)[:, None] - 2.0 * (a @ b.T) + np.einsum("ij,ij->i", b, b)[None]
            mass = weight[stops][:, None] - weight[starts][None]
            mean = np.divide(squared, mass, out=np.zeros_like(mass), where=mass > 1e-12)
            total += 0.5 * np.maximum(second[stops][:, None] - second[starts][None] - mean, 0.0)
        return np.asarray(total)


@dataclass(frozen=True)
class Span:
    """Cells, or samples, [start, stop) in one state."""

    state: str
    start: int
    stop: int


def decode(states: dict[str, Hypothesis], change: float, edges: Array, dwell: float) -> tuple[Span, ...]:
    """The cheapest sequence of spans over n cells.

    Parameters
    ----------
    states : dict of str to Hypothesis
    change : float
        Cost of a change of state.
    edges : ndarray (n + 1,)
        Times of the cells' edges.
    dwell : float
        Least duration of a span; the first and the last may be shorter.
    """
    names, n = list(states), len(edges) - 1
    sums = [states[name].sums() for name in names]
    best, enter = np.full((len(names), n + 1), np.inf), np.full((len(names), n + 1), np.inf)
    enter[:, 0] = 0.0
    came_from, began = (np.zeros((len(names), n + 1), dtype=np.intp) for _ in range(2))
    itself = np.diag([0.0 if states[name].repeats else np.inf for name in names])
    itself[~np.eye(len(names), dtype=bool)] = 0.0
    latest = np.searchsorted(edges, edges - dwell + 1e-9, side="right") - 1  # the last edge at which a span to here may begin
    latest[-1] = n - 1
    latest = np.maximum(latest, 0)
    alive: list[IntArray] = [np.arange(1)] * len(names)
    for block in range(1, n + 1, BLOCK):
        stop = min(block + BLOCK, n + 1)
        starts: list[IntArray] = [np.union1d(own, np.arange(block, stop)).astype(np.intp) for own in alive]
        costs = [s.costs(slice(block, stop), own) for s, own in zip(sums, starts, strict=True)]
        usable = [np.searchsorted(own, latest[block:stop], side="right").tolist() for own in starts]
        entering = [enter[k, own] for k, own in enumerate(starts)]
        where = [{int(edge): i for i, edge in enumerate(own)} for own in starts]
        for t in range(block, stop):
            for k, own in enumerate(starts):
                m = usable[k][t - block]
                total = entering[k][:m] + costs[k][t - block, :m]
                first = total.argmin()
                best[k, t], began[k, t] = total[first], own[first]
            others = best[:, t] + itself
            came_from[:, t] = others.argmin(axis=1)
            enter[:, t] = others.min(axis=1) + change
            for k, index in enumerate(where):
                entering[k][index[t]] = enter[k, t]
        turn = int(latest[min(stop, n)])
        if turn >= block:
            alive = [_alive(enter[k], own, costs[k][turn - block], turn) for k, own in enumerate(starts)]
        else:
            alive = starts
    return _traced(names, best, began, came_from)


def _alive(enter: Array, starts: IntArray, costs: Array, turn: int) -> IntArray:
    """The starts that can still be a span's best: those for which entering anew at the edge `turn` is not cheaper (PELT)."""
    return np.asarray(starts[(starts >= turn) | (enter[starts] + costs < enter[turn])])


def _traced(names: Sequence[str], best: Array, began: IntArray, came_from: IntArray) -> tuple[Span, ...]:
    t = best.shape[1] - 1
    k = int(np.argmin(best[:, t]))
    spans = []
    while t > 0:
        start = int(began[k, t])
        spans.append(Span(names[k], start, t))
        k, t = int(came_from[k, start]), start
    return tuple(reversed(spans))


def _summed(values: Array) -> Array:
    return np.concatenate([np.zeros((1, *values.shape[1:])), np.cumsum(values, axis=0)])
