"""How a person's hand moves: strokes through via points with rounded corners, uneven speed, pauses and small unsteadiness.

A stroke is not a replay with noise. Each person has a pace and a steadiness of their own; the speed rises and falls as in a
minimum-jerk reach (Flash and Hogan 1985), sways in between, and now and then there is one of the faults that recordings of people
have: a pause, an approach done twice, a nudge, a poor grasp. Everything is a function of the arguments and a
`numpy.random.Generator`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from scipy.ndimage import gaussian_filter1d

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, Pose, frozen, quat_exp, quat_log, quat_multiply

METRES_PER_RADIAN = 0.12
"""A turn counts as the way the hand's rim makes: so a path in SE(3) has one length, and a pure turn has one too."""


@dataclass(frozen=True)
class Person:
    """Habits that stay the same within one demonstration.

    Attributes
    ----------
    speed_m_s : float
        Pace in the middle of a stroke; turning in place counts with `METRES_PER_RADIAN`.
    corner_m : float
        How wide corners are rounded: the standard deviation of the smoothing along the path.
    wander_m : float
        Slow deviation from the planned path, largest in mid-stroke, none at its ends.
    tremor_m : float
        Fast unsteadiness, likewise.
    ramp_s : float
        Time to get up to speed, and to stop.
    """

    speed_m_s: float = 0.14
    corner_m: float = 0.02
    wander_m: float = 0.006
    tremor_m: float = 0.0005
    ramp_s: float = 0.5

    def __post_init__(self) -> None:
        if not (self.speed_m_s > 0.0 and self.ramp_s > 0.0):
            raise InputError(f"a person needs a positive speed and ramp, got {self.speed_m_s} m/s and {self.ramp_s} s")
        if min(self.corner_m, self.wander_m, self.tremor_m) < 0.0:
            raise InputError("corner_m, wander_m and tremor_m of a person must not be negative")

    @classmethod
    def draw(cls, rng: np.random.Generator) -> Person:
        """Somebody: unhurried to brisk, steady to a little unsteady."""
        return cls(
            speed_m_s=float(rng.uniform(0.10, 0.18)),
            corner_m=float(rng.uniform(0.012, 0.025)),
            wander_m=float(rng.uniform(0.002, 0.008)),
            tremor_m=float(rng.uniform(0.0002, 0.0008)),
            ramp_s=float(rng.uniform(0.35, 0.7)),
        )


@dataclass(frozen=True)
class Faults:
    """Which faults one demonstration has."""

    pause: bool = False
    second_approach: bool = False
    nudge: bool = False
    poor_grasp: bool = False

    @classmethod
    def draw(cls, rng: np.random.Generator, chance: float = 0.2) -> Faults:
        """Each fault on its own, with probability `chance` in [0, 1]."""
        if not 0.0 <= chance <= 1.0:
            raise InputError(f"the chance of a fault must lie in [0, 1], got {chance}")
        return cls(*(bool(rng.random() < chance) for _ in fields(cls)))


@dataclass(frozen=True, eq=False)
class Stroke:
    """One motion of the hand from rest to rest: `times` (n,) [s] from 0 at a fixed period, `T_world_ee` (n,)."""

    times: Array
    T_world_ee: Pose

    def __post_init__(self) -> None:
        object.__setattr__(self, "times", frozen(self.times))
        if self.T_world_ee.shape != self.times.shape or len(self.times) < 2:
            raise InputError(
                f"a stroke needs at least 2 poses, as many as times; got {self.T_world_ee.shape} and {self.times.shape}"
            )


def vary(T: Pose, rng: np.random.Generator, spread_m: float, spread_rad: float = 0.0) -> Pose:
    """The pose, somewhere within a cube of +-`spread_m` and a turn of at most `spread_rad` about each own axis."""
    shift, turn = rng.uniform(-spread_m, spread_m, 3), rng.uniform(-spread_rad, spread_rad, 3)
    return Pose(T.p + shift, quat_multiply(T.q, quat_exp(turn)))


def interpolate(a: Pose, b: Pose, s: float) -> Pose:
    """The pose a fraction `s` of the way from `a` to `b`: straight in position, the shorter way round in rotation."""
    turn = quat_log(quat_multiply(b.q, a.q * np.array([1.0, -1.0, -1.0, -1.0])))
    return Pose(a.p + s * (b.p - a.p), quat_multiply(quat_exp(s * turn), a.q))


def approach_twice(via: Sequence[Pose], rng: np.random.Generator) -> tuple[Pose, ...]:
    """The same way, but near its end the hand hesitates, backs off along the last leg, and comes again."""
    if len(via) < 2:
        raise InputError("an approach needs at least 2 via points")
    before, goal = via[-2], via[-1]
    near, off = rng.uniform(0.55, 0.75), rng.uniform(0.05, 0.25)
    return (*via[:-1], interpolate(before, goal, near), vary(interpolate(before, goal, off), rng, 0.004), goal)


def stroke(
    via: Sequence[Pose],
    person: Person,
    rng: np.random.Generator,
    *,
    period_s: float = 0.05,
    pause_s: float = 0.0,
    careful: bool = False,
) -> Stroke:
    """A person's way through via points, from rest at the first to rest at the last; both ends are met exactly.

    Parameters
    ----------
    via : sequence of Pose
        At least two poses (); corners in between are rounded, so inner ones are passed near and not met.
    person : Person
    rng : numpy.random.Generator
    period_s : float
        Sampling period [s].
    pause_s : float
        Length of a stop somewhere in mid-stroke [s]; 0 for none.
    careful : bool
        Slower and steadier, as in contact or in a narrow place: 60 % of the pace, a third of the wander, sharper corners.

    Returns
    -------
    Stroke
    """
    if len(via) < 2:
        raise InputError(f"a stroke needs at least 2 via points, got {len(via)}")
    if period_s <= 0.0 or pause_s < 0.0:
        raise InputError(f"a stroke needs a positive period and no negative pause, got {period_s} s and {pause_s} s")
    speed = person.speed_m_s * (0.6 if careful else 1.0)
    shrink = 1.0 / 3.0 if careful else 1.0
    s_path, path = _rounded(Pose.stack(via), person.corner_m * (0.5 if careful else 1.0))
    times, s = _progress(float(s_path[-1]), speed, person.ramp_s, pause_s, period_s, rng)
    p = np.stack([np.interp(s, s_path, path.p[:, i]) for i in range(3)], axis=-1)
    q = np.stack([np.interp(s, s_path, path.q[:, i]) for i in range(4)], axis=-1)
    # unsteadiness: none at the ends, so that what was aimed at is met; a short stroke has no room for much of it
    length = max(float(s_path[-1]), 1e-9)
    taper = (np.sin(np.pi * s / length) ** 2)[:, None] * min(1.0, length / 0.15)
    wander = shrink * person.wander_m * _noise(len(times), 0.8 / period_s, rng)
    tremor = person.tremor_m * _noise(len(times), 0.08 / period_s, rng)
    turn = taper * (shrink * 0.03 * _noise(len(times), 0.8 / period_s, rng)) * (person.wander_m / 0.006)
    return Stroke(times, Pose(p + taper * (wander + tremor), quat_multiply(quat_exp(turn), q)))


def _rounded(via: Pose, corner_m: float) -> tuple[Array, Pose]:
    """Dense path through `via` with its corners smoothed; arc length (m,) and poses (m,)."""
    q = via.q.copy()
    for i in range(1, len(q)):
        if q[i] @ q[i - 1] < 0.0:
            q[i] = -q[i]
    steps = np.linalg.norm(np.diff(via.p, axis=0), axis=-1)
    turns = np.linalg.norm(quat_log(quat_multiply(q[1:], q[:-1] * np.array([1.0, -1.0, -1.0, -1.0]))), axis=-1)
    knots = np.concatenate([[0.0], np.cumsum(np.maximum(np.maximum(steps, METRES_PER_RADIAN * turns), 1e-6))])
    grain = 0.002
    n = max(int(np.ceil(knots[-1] / grain)) + 1, 3)
    s = np.linspace(0.0, knots[-1], n)
    # slerp between neighbours: constant turn rate on each leg
    leg = np.clip(np.searchsorted(knots, s, side="right") - 1, 0, len(steps) - 1)
    u = ((s - knots[leg]) / (knots[leg + 1] - knots[leg]))[:, None]
    p = via.p[leg] + u * (via.p[leg + 1] - via.p[leg])
    r = quat_log(quat_multiply(q[1:], q[:-1] * np.array([1.0, -1.0, -1.0, -1.0])))
    dense_q = quat_multiply(quat_exp(u * r[leg]), q[leg])
    for i in range(1, n):
        if dense_q[i] @ dense_q[i - 1] < 0.0:
            dense_q[i] = -dense_q[i]
    spread = corner_m / (s[1] - s[0])
    if spread > 0.0 and len(steps) > 1:
        p, dense_q = _smooth(p, spread), _smooth(dense_q, spread)
    path = Pose(p, dense_q)
    way = np.maximum(
        np.linalg.norm(np.diff(path.p, axis=0), axis=-1),
        METRES_PER_RADIAN
        * np.linalg.norm(quat_log(quat_multiply(path.q[1:], path.q[:-1] * np.array([1.0, -1.0, -1.0, -1.0]))), axis=-1),
    )
    return np.concatenate([[0.0], np.cumsum(way)]), path


def _smooth(x: Array, spread: float) -> Array:
    """Gaussian smoothing along axis 0 that leaves both ends where they are: the ends are continued point-symmetrically."""
    n = len(x)
    pad = min(n - 1, int(4 * spread) + 1)
    head, tail = 2 * x[0] - x[pad:0:-1], 2 * x[-1] - x[-2 : -pad - 2 : -1]
    smooth = gaussian_filter1d(np.concatenate([head, x, tail]), spread, axis=0)[pad : pad + n]
    # what the cut-off of a short path leaves over is spread linearly
    u = np.linspace(0.0, 1.0, n)[:, None]
    return np.asarray(smooth + (1 - u) * (x[0] - smooth[0]) + u * (x[-1] - smooth[-1]))


def _progress(
    length: float, speed: float, ramp_s: float, pause_s: float, period_s: float, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Times (n,) and arc length (n,): smooth start and stop, a swaying pace, and perhaps a stop on the way."""
    moving_s = max(length / speed + ramp_s, 2.0 * ramp_s)
    n = max(round((moving_s + pause_s + (2.0 * ramp_s if pause_s else 0.0)) / period_s), 2)
    times = np.arange(n + 1) * period_s
    rate = _step(times / ramp_s) * _step((times[-1] - times) / ramp_s)
    rate = rate * np.clip(1.0 + 0.15 * _noise(n + 1, 0.5 / period_s, rng)[:, 0], 0.4, 1.6)
    where = rng.uniform(0.3, 0.7)
    if pause_s:
        middle = where * times[-1]
        rate = rate * _step((np.abs(times - middle) - 0.5 * pause_s) / ramp_s)
    s = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]))])
    return times, length * s / s[-1]


def _step(x: Array) -> Array:
    """From 0 at x <= 0 to 1 at x >= 1 with zero slope and curvature at both: the minimum-jerk polynomial."""
    x = np.clip(x, 0.0, 1.0)
    return x**3 * (10.0 - 15.0 * x + 6.0 * x**2)


def _noise(n: int, spread: float, rng: np.random.Generator) -> Array:
    """Smooth noise (n, 3) of unit standard deviation; neighbours within `spread` samples look alike."""
    pad = int(4 * spread) + 1
    white = rng.standard_normal((n + 2 * pad, 3))
    return np.asarray(gaussian_filter1d(white, spread, axis=0)[pad : pad + n] * np.sqrt(2.0 * np.sqrt(np.pi) * spread))
