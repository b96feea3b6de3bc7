"""The fields' arithmetic, compiled: one pose or ten thousand go through the same lines and give the same bits.

Loading numba takes half a second, and planning or reading a library evaluates no field: import this module where a field is
evaluated. The compiled code is kept beside the package, or in numba's own folder where that cannot be written.
"""

from __future__ import annotations

from math import atan2, exp, sqrt

import numpy as np
from numba import njit


@njit(cache=True)
def _linear_systems(e, whitening, offset, log_scale, matrices, pace, out):  # type: ignore[no-untyped-def]
    """out (3,) = sum_k gamma_k(e) A_k e, scaled down to the speed cap sum_k gamma_k(e) pace_k."""
    K = len(log_scale)
    logits = np.empty(K)
    highest = -np.inf
    for k in range(K):
        total = 0.0
        for i in range(3 * k, 3 * k + 3):
            z = whitening[i, 0] * e[0] + whitening[i, 1] * e[1] + whitening[i, 2] * e[2] - offset[i]
            total += z * z
        logits[k] = log_scale[k] - 0.5 * total
        highest = max(highest, logits[k])
    weights = 0.0
    for k in range(K):
        logits[k] = exp(logits[k] - highest)
        weights += logits[k]
    out[:] = 0.0
    cap = 0.0
    for k in range(K):
        gamma = logits[k] / weights
        cap += gamma * pace[k]
        A = matrices[k]
        for i in range(3):
            out[i] += gamma * (A[i, 0] * e[0] + A[i, 1] * e[1] + A[i, 2] * e[2])
    speed = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2])
    if speed > cap:
        for i in range(3):
            out[i] *= cap / speed


@njit(cache=True)
def velocities(e, lpv):  # type: ignore[no-untyped-def]
    """Velocities (n, 3) of linear systems at errors (n, 3)."""
    whitening, offset, log_scale, matrices, pace = lpv
    out = np.empty(e.shape)
    for i in range(len(e)):
        _linear_systems(e[i], whitening, offset, log_scale, matrices, pace, out[i])
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


@njit(cache=True)
def rotation_errors(q, goal):  # type: ignore[no-untyped-def]
    """Rotation vectors (n, 3) from the goal to quaternions (n, 4)."""
    out = np.empty((len(q), 3))
    for i in range(len(q)):
        _rotation_error(q[i], goal, out[i])
    return out


@njit(cache=True)
def lead(distance, angle, reach, turn, difference):  # type: ignore[no-untyped-def]
    """How far the rotation is ahead of the position [rad]; see `Pairing`."""
    last = len(difference) - 1
    at = min(0.5 * (distance / reach + angle / turn), 1.0) * last
    i = min(int(at), last - 1)
    shown = difference[i] + (at - i) * (difference[i + 1] - difference[i])
    return turn * (distance / reach - angle / turn - shown)


@njit(cache=True)
def twists(p, q, position, goal_p, P, orientation, goal_q, pairing, widths):  # type: ignore[no-untyped-def]
    """Twists (n, 6) at positions (n, 3) and quaternions (n, 4)."""
    reach, turn, difference = pairing
    lead_width, lag_width, least = widths
    out = np.empty((len(p), 6))
    e_p, e_q = np.empty(3), np.empty(3)
    for i in range(len(p)):
        square = 0.0
        for j in range(3):
            e_p[j] = p[i, j] - goal_p[j]
        for j in range(3):
            square += e_p[j] * (P[j, 0] * e_p[0] + P[j, 1] * e_p[1] + P[j, 2] * e_p[2])
        _rotation_error(q[i], goal_q, e_q)
        angle = sqrt(e_q[0] * e_q[0] + e_q[1] * e_q[1] + e_q[2] * e_q[2])
        _linear_systems(e_p, position[0], position[1], position[2], position[3], position[4], out[i, :3])
        _linear_systems(e_q, orientation[0], orientation[1], orientation[2], orientation[3], orientation[4], out[i, 3:])
        ahead = lead(sqrt(max(square, 0.0)), angle, reach, turn, difference)
        slower = min(max(1.0 + ahead / lag_width, least), 1.0)
        waits = min(max(1.0 - ahead / lead_width, 0.0), 1.0)
        for j in range(3):
            out[i, j] *= slower
            out[i, 3 + j] *= waits
    return out
