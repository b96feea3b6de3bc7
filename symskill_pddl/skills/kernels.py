"""The fields' arithmetic, compiled: one pose or ten thousand go through the same lines and give the same bits.

Loading numba takes half a second, and planning or reading a library evaluates no field: import this module where a field is
evaluated. The compiled code is kept beside the package, or in numba's own folder where that cannot be written.

What is called from outside takes one form of arguments, named where it is defined: it is compiled when its module is imported for
the first time after an installation, and never in a run. A robot that moves cannot wait for a compiler.
"""

from __future__ import annotations

from math import atan2, cos, exp, sin, sqrt

import numpy as np
from numba import njit, types


def fixed(dimensions: int) -> types.Array:
    """The form of an array that nobody writes to, as dataclasses keep theirs; others of the same layout are taken as well."""
    return types.Array(types.float64, dimensions, "C", readonly=True)


NUMBER, POINTS = types.float64, types.float64[:, ::1]
_LPV = types.Tuple([fixed(2), fixed(1), fixed(1), fixed(3), fixed(1)])
_CURVE = types.Tuple([NUMBER, NUMBER, fixed(1)])
_FIELD = types.Tuple([_LPV, fixed(1), fixed(2), _LPV, fixed(1), _CURVE, types.UniTuple(NUMBER, 4)])


@njit(cache=True)
def _linear_systems(e, whitening, offset, log_scale, matrices, pace, logits, out):  # type: ignore[no-untyped-def]
    """out (3,) = sum_k gamma_k(e) A_k e, scaled down to the speed cap sum_k gamma_k(e) pace_k."""
    K = len(log_scale)
    x, y, z = e[0], e[1], e[2]
    highest = -np.inf
    for k in range(K):
        i = 3 * k
        a = whitening[i, 0] * x + whitening[i, 1] * y + whitening[i, 2] * z - offset[i]
        b = whitening[i + 1, 0] * x + whitening[i + 1, 1] * y + whitening[i + 1, 2] * z - offset[i + 1]
        c = whitening[i + 2, 0] * x + whitening[i + 2, 1] * y + whitening[i + 2, 2] * z - offset[i + 2]
        logits[k] = log_scale[k] - 0.5 * (a * a + b * b + c * c)
        highest = max(highest, logits[k])
    total = cap = u = v = w = 0.0
    for k in range(K):
        if logits[k] > highest - 50.0:  # what is left out is lost in rounding
            gamma = exp(logits[k] - highest)
            A = matrices[k]
            total += gamma
            cap += gamma * pace[k]
            u += gamma * (A[0, 0] * x + A[0, 1] * y + A[0, 2] * z)
            v += gamma * (A[1, 0] * x + A[1, 1] * y + A[1, 2] * z)
            w += gamma * (A[2, 0] * x + A[2, 1] * y + A[2, 2] * z)
    scale = 1.0 / total
    speed = sqrt(u * u + v * v + w * w)
    if speed > cap:
        scale *= cap / speed
    out[0], out[1], out[2] = scale * u, scale * v, scale * w


@njit((POINTS, _LPV), cache=True)
def velocities(e, lpv):  # type: ignore[no-untyped-def]
    """Velocities (n, 3) of linear systems at errors (n, 3)."""
    whitening, offset, log_scale, matrices, pace = lpv
    out, logits = np.empty(e.shape), np.empty(len(pace))
    for i in range(len(e)):
        _linear_systems(e[i], whitening, offset, log_scale, matrices, pace, logits, out[i])
    return out


@njit(cache=True)
def _rotation_error(q, goal, out):  # type: ignore[no-untyped-def]
    """out (3,) = log(q goal^-1). The sign is folded by w; where w is 0 the first non-zero component of the axis decides."""
    aw, ax, ay, az = q[0], q[1], q[2], q[3]
    bw, bx, by, bz = goal[0], -goal[1], -goal[2], -goal[3]
    w = aw * bw - ax * bx - ay * by - az * bz
    x = aw * bx + ax * bw + ay * bz - az * by
    y = aw * by - ax * bz + ay * bw + az * bx
    z = aw * bz + ax * by - ay * bx + az * bw
    if w < 0.0 or (w == 0.0 and (x < 0.0 or (x == 0.0 and (y < 0.0 or (y == 0.0 and z < 0.0))))):
        w, x, y, z = -w, -x, -y, -z
    norm = sqrt(x * x + y * y + z * z)
    scale = 2.0
    if norm >= 1e-10:
        scale = 2.0 * atan2(norm, w) / norm
    out[0], out[1], out[2] = scale * x, scale * y, scale * z


@njit((POINTS, fixed(1)), cache=True)
def rotation_errors(q, goal):  # type: ignore[no-untyped-def]
    """Rotation vectors (n, 3) from the goal to quaternions (n, 4)."""
    out = np.empty((len(q), 3))
    for i in range(len(q)):
        _rotation_error(q[i], goal, out[i])
    return out


@njit((NUMBER, NUMBER, NUMBER, NUMBER, fixed(1)), cache=True)
def lead(distance, angle, reach, turn, difference):  # type: ignore[no-untyped-def]
    """How far the rotation is ahead of the position [rad]; see `Pairing`."""
    last = len(difference) - 1
    at = min(0.5 * (distance / reach + angle / turn), 1.0) * last
    i = min(int(at), last - 1)
    shown = difference[i] + (at - i) * (difference[i + 1] - difference[i])
    return turn * (distance / reach - angle / turn - shown)


@njit((POINTS, POINTS, *_FIELD), cache=True)
def twists(p, q, position, goal_p, P, orientation, goal_q, pairing, widths):  # type: ignore[no-untyped-def]
    """Twists (n, 6) at positions (n, 3) and quaternions (n, 4)."""
    reach, turn, difference = pairing
    lead_width, lag_width, slowest_p, slowest_q = widths
    out = np.empty((len(p), 6))
    e_p, e_q, v, omega = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    logits = np.empty(max(len(position[4]), len(orientation[4])))
    for i in range(len(p)):
        square = 0.0
        for j in range(3):
            e_p[j] = p[i, j] - goal_p[j]
        for j in range(3):
            square += e_p[j] * (P[j, 0] * e_p[0] + P[j, 1] * e_p[1] + P[j, 2] * e_p[2])
        _rotation_error(q[i], goal_q, e_q)
        angle = sqrt(e_q[0] * e_q[0] + e_q[1] * e_q[1] + e_q[2] * e_q[2])
        _linear_systems(e_p, position[0], position[1], position[2], position[3], position[4], logits, v)
        _linear_systems(e_q, orientation[0], orientation[1], orientation[2], orientation[3], orientation[4], logits, omega)
        ahead = lead(sqrt(max(square, 0.0)), angle, reach, turn, difference)
        slower = min(max(1.0 + ahead / lag_width, slowest_p), 1.0)
        waits = min(max(1.0 - ahead / lead_width, slowest_q), 1.0)
        for j in range(3):
            out[i, j] = slower * v[j]
            out[i, 3 + j] = waits * omega[j]
    return out


@njit(cache=True)
def _turned(r, q, out):  # type: ignore[no-untyped-def]
    """out (4,) = exp(r) q for a rotation vector r (3,)."""
    angle = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2])
    scale = 0.5 if angle < 1e-8 else sin(0.5 * angle) / angle
    aw, ax, ay, az = cos(0.5 * angle), scale * r[0], scale * r[1], scale * r[2]
    bw, bx, by, bz = q[0], q[1], q[2], q[3]
    out[0] = aw * bw - ax * bx - ay * by - az * bz
    out[1] = aw * bx + ax * bw + ay * bz - az * by
    out[2] = aw * by - ax * bz + ay * bw + az * bx
    out[3] = aw * bz + ax * by - ay * bx + az * bw


@njit((POINTS, POINTS, types.int64, NUMBER, _FIELD), cache=True)
def rollouts(p, q, steps, period, field):  # type: ignore[no-untyped-def]
    """Explicit Euler motions (n, steps + 1, 3), (n, steps + 1, 4) from positions (n, 3) and quaternions (n, 4)."""
    ps, qs = np.empty((len(p), steps + 1, 3)), np.empty((len(p), steps + 1, 4))
    r = np.empty(3)
    ps[:, 0], qs[:, 0] = p, q
    position, goal_p, P, orientation, goal_q, pairing, widths = field
    for i in range(len(p)):
        for t in range(steps):
            here = slice(t, t + 1)
            twist = twists(ps[i, here], qs[i, here], position, goal_p, P, orientation, goal_q, pairing, widths)
            for j in range(3):
                ps[i, t + 1, j] = ps[i, t, j] + period * twist[0, j]
                r[j] = period * twist[0, 3 + j]
            _turned(r, qs[i, t], qs[i, t + 1])
    return ps, qs


@njit((POINTS, NUMBER), cache=True)
def moving(x, band):  # type: ignore[no-untyped-def]
    """Indices of the samples of x (n, d) that lie at least `band` from the one before among them."""
    kept, count = np.zeros(len(x), dtype=np.int64), 1
    for i in range(1, len(x)):
        square = 0.0
        for j in range(x.shape[1]):
            square += (x[i, j] - x[kept[count - 1], j]) ** 2
        if square > band * band:
            kept[count] = i
            count += 1
    return kept[:count]
