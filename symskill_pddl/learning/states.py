"""What each object does at each moment of a recording: at rest, constant in the hand, or moving otherwise.

Every object's whole path is divided by `decoding` at once, in units of the recording's own:

- lengths in A, the hand's widest aperture; times in tau = A / V, with V the hand's usual speed; both are measured;
- deviations in units of each object's own noise, measured from second differences, plus a floor in A.

Three states. *rest*: the pose is constant in the world. *hand*: the hand's pose is constant in the object's frame. *moving*:
neither; the object is pushed, turns about an axis within the fingers, or falls. Where an object is not seen, nothing is known and
nothing costs. Fingers are evidence: constant in an open hand costs a little.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.demos import Demo
from symskill_pddl.demos.noise import Jitter, jitter
from symskill_pddl.geometry import Array, Pose, rotation_distance
from symskill_pddl.learning.decoding import Hypothesis, Span, decode
from symskill_pddl.scene import GRIPPER

REST, HAND, MOVING = "rest", "hand", "moving"
CELLS = 16
"""Of a unit of time; finer ones change nothing, since boundaries are refined at the recording's own rate."""
DWELL = 0.25
"""Least duration of a state, in tau: the hand comes A / 4 meanwhile."""

BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.intp]


@dataclass(frozen=True)
class StateConfig:
    """The segmentation. Lengths are fractions of A, the hand's widest aperture, turns in radians beside them; costs are in the
    unit of the log likelihood, per cell of a sixteenth of the time in which the hand usually comes A."""

    still: float = 0.01
    """Spread of a resting pose besides its noise [A]: physics, and trackers that drift, move what rests by a millimetre."""
    firm: float = 0.025
    """Spread of a grasp besides noise [A]: fingers give way by a few millimetres."""
    moving: float = 5.0
    """Cost of a cell in no constant state: what three standard deviations cost; a change of state costs as much as two."""
    open_hand: float = 3.0
    """Cost of a cell constant in a hand that is told to open: it holds nothing, but commands come early and late."""
    around: float = 0.5
    """Fingers that close take hold of an object if the hand is then this near [A] to its later place on it."""
    slight: float = 0.125
    """What comes to rest this near [A] to where it rested was nudged: people knock things by up to a centimetre."""
    along: float = 0.3
    """Of the way of an object's point at the hand, the least part that is the hand's own if the hand moves it."""


@dataclass(frozen=True, eq=False)
class Measured:
    """A recording with its own units: `A` [m], and `tau` [s]."""

    demo: Demo
    A: float
    tau: float
    config: StateConfig
    _noise: dict[str, Jitter] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, demo: Demo, A: float, config: StateConfig) -> Measured:
        """`A` is one for all recordings of a hand. V is the median speed of the hand, each speed weighted by its way."""
        steps = np.linalg.norm(np.diff(demo.T_world_ee.p, axis=0), axis=-1)
        speeds = steps / np.diff(demo.times)
        order = np.argsort(speeds)
        way = np.cumsum(steps[order])
        if way[-1] < A:
            return cls(demo, A, 1.0, config)
        return cls(demo, A, A / float(speeds[order][np.searchsorted(way, way[-1] / 2)]), config)

    def noise(self, frame: str) -> Jitter:
        if frame not in self._noise:
            self._noise[frame] = jitter(self.demo, frame)
        return self._noise[frame]

    def after(self, taus: float) -> IntArray:
        """The sample (n,) that is this long, in tau, after each one; before it, if negative; within the recording."""
        times = self.demo.times
        return np.clip(np.searchsorted(times, times + taus * self.tau), 0, len(times) - 1)

    def stays(self, obj: str, other: IntArray) -> BoolArray:
        """Whether an object's pose at each sample is, up to noise, that at the `other` sample."""
        T, own = self.demo.pose(obj), self.noise(obj)
        near = np.linalg.norm(T.p - T.p[other], axis=-1) <= self.config.still * self.A + 4 * own.p_m
        return np.asarray(near & (rotation_distance(T, T[other]) <= self.config.still / 2 + 4 * own.r_rad))


@dataclass(frozen=True, eq=False)
class Cells:
    """A recording on a grid: `first` (m,) is the first sample of each cell, `edges` (m + 1,) are times, `weight` (m,) is each
    cell's duration in sixteenths of tau."""

    first: IntArray
    edges: Array
    weight: Array

    @classmethod
    def of(cls, times: Array, tau: float, still: BoolArray) -> Cells:
        """Where an object is `still` (n,), cells are four times as long: no boundary is there."""
        grid = tau / CELLS
        fine, coarse = (np.floor((times - times[0]) / g + 1e-6) for g in (grid, 4 * grid))
        within = np.concatenate([[False], still[1:] & still[:-1]])
        first = np.flatnonzero(np.where(within, np.diff(coarse, prepend=-1), np.diff(fine, prepend=-1)) > 0)
        dt = float(np.median(np.diff(times)))
        counts = np.diff(np.append(first, len(times)))
        return cls(first, np.append(times[first], times[-1] + dt), counts * dt / grid)

    def counts(self, mask: BoolArray) -> Array:
        """Samples (m,) of each cell that are in `mask` (n,)."""
        return np.asarray(np.add.reduceat(mask.astype(float), self.first))

    def mean(self, x: Array, seen: BoolArray) -> Array:
        """Mean (m, d) over the seen samples of each cell."""
        total = np.add.reduceat(np.where(seen[:, None], x, 0.0), self.first)
        return np.asarray(total / np.maximum(self.counts(seen), 1.0)[:, None])


def spans(measured: Measured, obj: str) -> tuple[Span, ...]:
    """The states of an object, in samples."""
    demo, config = measured.demo, measured.config
    T, n = demo.pose(obj), len(demo)
    if _within(T, config.still * measured.A, config.still):
        return (Span(REST, 0, n),)
    still = measured.stays(obj, measured.after(-DWELL)) & measured.stays(obj, measured.after(DWELL))
    cells = Cells.of(demo.times, measured.tau, still)
    states = _hypotheses(measured, obj, cells)
    whole = states[REST].sums().costs(slice(-1, None), np.zeros(1, dtype=np.intp))
    if whole[0, 0] < config.moving:
        return (Span(REST, 0, n),)
    bounds = np.append(cells.first, n)
    found = decode(states, 2 * config.moving, cells.edges, DWELL * measured.tau)
    return tuple(Span(s.state, int(bounds[s.start]), int(bounds[s.stop])) for s in found)


def _within(T: Pose, metres: float, radians: float) -> bool:
    return bool(np.linalg.norm(T.p - T.p[0], axis=-1).max() < metres and rotation_distance(T, T[0]).max() < radians)


def _hypotheses(measured: Measured, obj: str, cells: Cells) -> dict[str, Hypothesis]:
    demo, config = measured.demo, measured.config
    seen, own, hand = demo.sees(obj), measured.noise(obj), measured.noise(GRIPPER)
    samples = cells.counts(np.ones(len(demo), bool))
    weight = cells.weight * cells.counts(seen) / samples
    T_obj_ee = demo.pose(obj).inverse() @ demo.T_world_ee
    lever = cells.mean(np.linalg.norm(T_obj_ee.p, axis=-1)[:, None], seen)[:, 0]

    def constant(T: Pose, p_m: Array, r_rad: Array, spread: float) -> tuple[tuple[tuple[Array, Array], ...], Array]:
        """Positions and orientations as observations, and what noise alone is expected to cost. Matrices over the square root of
        two are as far apart as the angle between them [rad]."""
        parts, expected = [], np.zeros(len(weight))
        turns = T.rotation_matrix().reshape(-1, 9) / np.sqrt(2.0)
        for x, sigma, floor in ((T.p, p_m, spread * measured.A), (turns, r_rad, 2 * spread)):
            of_mean = sigma**2 / samples
            parts.append((cells.mean(x, seen), weight / (of_mean + floor**2)))
            expected += 1.5 * weight * of_mean / (of_mean + floor**2)
        return tuple(parts), expected

    one = np.ones(len(weight))
    resting, by_noise = constant(demo.pose(obj), own.p_m * one, own.r_rad * one, config.still)
    p_m = np.sqrt(own.p_m**2 + hand.p_m**2 + (lever * own.r_rad) ** 2)
    held, held_by_noise = constant(T_obj_ee, p_m, np.hypot(own.r_rad, hand.r_rad) * one, config.firm)
    opened = weight * cells.counts(~demo.gripper_closed) / samples
    return {
        REST: Hypothesis(resting, -by_noise),
        HAND: Hypothesis(held, config.open_hand * opened - held_by_noise, repeats=True),
        MOVING: Hypothesis((), config.moving * weight),
    }
