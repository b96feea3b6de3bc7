"""The arithmetic of `modulate`, compiled (see `kernels` for why it is imported late, and what its forms are).

An obstacle is a row of numbers: centre (3), axes (9, row by row), radii (3), power, velocity (3). Vectors are worked on number by
number: numba takes ten times as long to compile whole-array expressions.
"""

from __future__ import annotations

from math import acos, cos, sin, sqrt

import numpy as np
from numba import njit

from symskill_pddl.skills.kernels import NUMBER, POINTS, fixed

_OBSTACLES = (fixed(2), fixed(2), fixed(2), fixed(2), fixed(1))
ESCAPE = 0.3
"""Sideways part of a head-on velocity at the surface, as a fraction of its size."""
ON_SURFACE = 1.0 - 1e-9
"""What lies no deeper than rounding takes it is outside."""


@njit(cache=True)
def _norm(a):  # type: ignore[no-untyped-def]
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@njit(cache=True)
def _dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def _add(a, factor, b):  # type: ignore[no-untyped-def]
    """a (3,) += factor b (3,)."""
    for i in range(3):
        a[i] += factor * b[i]


@njit(cache=True)
def _difference(a, b, out):  # type: ignore[no-untyped-def]
    """out (3,) = a - b; its length."""
    for i in range(3):
        out[i] = a[i] - b[i]
    return _norm(out)


@njit(cache=True)
def level(row, x, slope):  # type: ignore[no-untyped-def]
    """Gamma^(1 / 2 power) at x (3,): 1 on the surface, linear along every ray from the centre. `slope` (3,) takes its gradient.

    It is a norm, hence convex: the plane through a point's slope keeps the whole obstacle on one side.
    """
    d, u = np.empty(3), np.empty(3)
    highest, thinnest = 0.0, 0
    for i in range(3):
        d[i] = row[3 + i] * (x[0] - row[0]) + row[6 + i] * (x[1] - row[1]) + row[9 + i] * (x[2] - row[2])
        u[i] = abs(d[i]) / row[12 + i]
        highest = max(highest, u[i])
        if row[12 + i] < row[12 + thinnest]:
            thinnest = i
    if highest < 1e-12:  # at the centre every direction leads out, the thinnest one first
        highest = 1e-12
        u[thinnest] = d[thinnest] = 1e-12
    p = row[15]
    total = 0.0
    for i in range(3):
        u[i] /= highest
        total += u[i] * u[i] if p == 1.0 else u[i] ** (2.0 * p)
    size = sqrt(total) if p == 1.0 else total ** (0.5 / p)
    slope[0] = slope[1] = slope[2] = 0.0
    for i in range(3):
        share = u[i] / size
        g = (share if p == 1.0 else share ** (2.0 * p - 1.0)) / row[12 + i]
        if d[i] < 0.0:
            g = -g
        for j in range(3):
            slope[j] += row[3 + 3 * j + i] * g
    return highest * size


@njit(cache=True)
def _half_width(row, n):  # type: ignore[no-untyped-def]
    """How far an obstacle reaches from its centre along n (3,), times the length of n; for a power above 1 its bounding box."""
    total = 0.0
    for i in range(3):
        part = abs(row[3 + i] * n[0] + row[6 + i] * n[1] + row[9 + i] * n[2]) * row[12 + i]
        total += part * part if row[15] == 1.0 else part
    return sqrt(total) if row[15] == 1.0 else total


@njit(cache=True)
def _apart(a, b, n):  # type: ignore[no-untyped-def]
    """Whether a plane across the direction n (3,) separates two obstacles."""
    gap = (b[0] - a[0]) * n[0] + (b[1] - a[1]) * n[1] + (b[2] - a[2]) * n[2]
    return abs(gap) > _half_width(a, n) + _half_width(b, n)


@njit(cache=True)
def _common_point(a, b, point):  # type: ignore[no-untyped-def]
    """Whether two obstacles overlap; `point` (3,) takes a point deep in both, found by going into each in turn."""
    slope = np.empty(3)
    if _difference(b, a, slope) > 1e-12 and _apart(a, b, slope):
        return False
    for i in range(3):
        point[i] = 0.5 * (a[i] + b[i])
    for _ in range(20):
        if _deeper(a, point, slope) & _deeper(b, point, slope):
            return True
        if _apart(a, b, slope):
            return False
    return max(level(a, point, slope), level(b, point, slope)) < 1.0


@njit(cache=True)
def _deeper(row, point, slope):  # type: ignore[no-untyped-def]
    """Move the point (3,) to the depth at which an obstacle counts as shared, along the slope; whether it was as deep already."""
    at = level(row, point, slope)
    if at <= 0.9:
        return True
    _add(point, (0.88 - at) / _dot(slope, slope), slope)
    return False


@njit(cache=True)
def references(rows):  # type: ignore[no-untyped-def]
    """Points (n, 3) that each obstacle leads away from, and the group (n,) of overlapping ones it belongs to.

    Overlapping obstacles lead away from a point they share, so that nothing is caught between them. Where a group shares none,
    its first one, that with the most overlaps, keeps its own, and each further one takes one it shares with the one before it.
    """
    n = len(rows)
    points, shared = np.empty((n, 3)), np.empty((n, n, 3))
    touches, count = np.zeros((n, n), dtype=np.bool_), np.zeros(n, dtype=np.int64)
    for i in range(n):
        for j in range(i):
            if _common_point(rows[i], rows[j], shared[i, j]):
                touches[i, j] = touches[j, i] = True
                count[i] += 1
                count[j] += 1
    group, queue, point, slope = np.full(n, -1), np.empty(n, dtype=np.int64), np.empty(3), np.empty(3)
    while True:
        root = -1
        for i in range(n):
            if group[i] < 0 and (root < 0 or count[i] > count[root]):
                root = i
        if root < 0:
            break
        group[root] = queue[0] = root
        head, tail = 0, 1
        for k in range(3):
            points[root, k] = point[k] = rows[root, k]
        while head < tail:
            i = queue[head]
            head += 1
            for j in range(n):
                if touches[i, j] and group[j] < 0:
                    group[j], queue[tail] = root, j
                    tail += 1
                    for k in range(3):
                        points[j, k] = shared[max(i, j), min(i, j), k]
                        point[k] += points[j, k]
        if tail == 1:
            continue
        for k in range(3):
            point[k] = (point[k] - points[root, k]) / (tail - 1)
        common = False
        for _ in range(20):
            common = True
            for i in range(tail):
                common &= _deeper(rows[queue[i]], point, slope)
            if common:
                break
        for i in range(tail):
            j = queue[i]
            if common or level(rows[j], points[root], slope) < 0.9:
                for k in range(3):
                    points[j, k] = point[k] if common else points[root, k]
    return points, group


@njit(cache=True)
def _around(v, speed, at, out, normal, near, row, bent):  # type: ignore[no-untyped-def]
    """bent (3,): the velocity v (3,) around one obstacle."""
    along = _dot(v, normal) / _dot(out, normal)  # v = along * out + tangent, tangent in the surface's plane
    for i in range(3):
        bent[i] = v[i]
    if at >= ON_SURFACE and along >= 0.0:
        return
    _add(bent, -along, out)
    # head-on, nothing leads around: a sideways push, decided by the obstacle's thinnest way
    size = _norm(bent)
    lack = ESCAPE * near * speed - size
    if lack > 0.0:
        if size > 1e-6 * speed:
            _add(bent, lack / size, bent)
        else:
            _sideways(row, normal, lack, bent)
    if at < ON_SURFACE:  # inside: outwards, the faster the deeper
        outwards = max(along, 0.0) + speed * min(1.0, 0.1 + 5.0 * (1.0 - at))
    else:
        outwards = (1.0 - near) * along
    for i in range(3):
        bent[i] = (1.0 + near) * bent[i] + outwards * out[i]
    length = _norm(bent)
    if length > speed:
        for i in range(3):
            bent[i] *= speed / length


@njit(cache=True)
def _sideways(row, normal, amount, v):  # type: ignore[no-untyped-def]
    """Add a tangent to v (3,), along the axis of the least radius that lies in the surface's plane well enough."""
    best, radius, factor = 0, np.inf, 0.0
    for i in range(3):
        across = row[3 + i] * normal[0] + row[6 + i] * normal[1] + row[9 + i] * normal[2]
        # two of three orthogonal axes make more than 30 degrees with any normal
        if across * across < 0.75 and row[12 + i] < radius:
            best, radius, factor = i, row[12 + i], across
    size = sqrt(1.0 - factor * factor)
    for j in range(3):
        v[j] += amount / size * (row[3 + 3 * j + best] - factor * normal[j])


@njit(cache=True)
def _keep_out(v, slopes, bounds, count):  # type: ignore[no-untyped-def]
    """The velocity nearest to v (3,) with slopes_i . v >= bounds_i for all i < count (Hildreth's method), in place.

    Where every bound is negative, and standing still therefore allowed, what is left after the last round is scaled away.
    """
    force = np.zeros(count)
    for _ in range(30):
        change = 0.0
        for i in range(count):
            square = _dot(slopes[i], slopes[i])
            step = max(-force[i], (bounds[i] - _dot(slopes[i], v)) / square)
            force[i] += step
            _add(v, step, slopes[i])
            change = max(change, abs(step) * sqrt(square))
        if change <= 1e-12 * (1e-6 + _norm(v)):
            break
    scale = 1.0
    for i in range(count):
        speed = _dot(slopes[i], v)
        if speed < bounds[i] <= 0.0:
            scale = min(scale, bounds[i] / speed)
    for i in range(3):
        v[i] *= scale


@njit(cache=True)
def _bend(v, x, rows, points, group, locality, rate, result):  # type: ignore[no-untyped-def]
    n = len(rows)
    levels, near, weights, slopes = np.empty(n), np.empty(n), np.empty(n), np.empty((n, 3))
    inside, total = -1, 0.0
    for i in range(n):
        levels[i] = level(rows[i], x, slopes[i])
        near[i] = min(1.0, max(levels[i], 1e-3) ** (-2.0 * locality))
        weights[i] = 1.0 / max(levels[i] - 1.0, 1e-9)
        total += weights[i]
        if levels[i] < ON_SURFACE:
            inside = group[i]
    relative, nominal, turn, bent, normal, out = np.empty((6, 3))
    for j in range(3):
        relative[j] = result[j] = v[j]
    for i in range(n):
        weights[i] /= total
        _add(relative, -weights[i] * near[i], rows[i, 16:19])
    speed = _norm(relative)
    if speed < 1e-12:
        return
    # the mean of sizes, and of directions as angles from the nominal one, so that opposite ones do not cancel
    size = 0.0
    for j in range(3):
        nominal[j], turn[j] = relative[j] / speed, 0.0
    for i in range(n):
        steep = _norm(slopes[i])
        for j in range(3):
            normal[j] = slopes[i, j] / steep
        away = _difference(x, points[i], out)
        if _dot(out, normal) < 0.05 * away or away < 1e-12:  # inside, deeper than the shared point
            away = _difference(x, rows[i], out)
        if _dot(out, normal) < 0.05 * away or away < 1e-12:
            away = 1.0
            for j in range(3):
                out[j] = normal[j]
        for j in range(3):
            out[j] /= away
        _around(relative, speed, levels[i], out, normal, near[i], rows[i], bent)
        length = _norm(bent)
        size += weights[i] * length
        if length > 1e-12:
            cosine = min(1.0, max(-1.0, _dot(bent, nominal) / length))
            for j in range(3):
                bent[j] = bent[j] / length - cosine * nominal[j]
            span = _norm(bent)
            if span > 1e-12:
                _add(turn, weights[i] * acos(cosine) / span, bent)
    angle = _norm(turn)
    for j in range(3):
        # what the obstacles carry along, and the mean
        result[j] += size * cos(angle) * nominal[j] - relative[j]
        if angle > 1e-12:
            result[j] += size * sin(angle) / angle * turn[j]
    # whatever the mean is: no step of 1 / rate, and so none shorter, ends in an obstacle it did not start in
    kept = 0
    for i in range(n):
        if levels[i] >= ON_SURFACE and group[i] != inside:
            near[kept] = _dot(slopes[i], rows[i, 16:19]) - rate * max(levels[i] - 1.0, 0.0)
            for j in range(3):
                slopes[kept, j] = slopes[i, j]
            kept += 1
    _keep_out(result, slopes, near, kept)


@njit(cache=True)
def matrix(q, out):  # type: ignore[no-untyped-def]
    """out (9,), row by row: the rotation matrix of a quaternion (4,)."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    out[0], out[1], out[2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    out[3], out[4], out[5] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    out[6], out[7], out[8] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@njit(cache=True)
def _rows(p, q, radii, velocity, power):  # type: ignore[no-untyped-def]
    rows = np.empty((len(p), 19))
    for i in range(len(p)):
        matrix(q[i], rows[i, 3:12])
        rows[i, 15] = power[i]
        for j in range(3):
            rows[i, j], rows[i, 12 + j], rows[i, 16 + j] = p[i, j], radii[i, j], velocity[i, j]
    return rows


@njit((NUMBER[::1], *_OBSTACLES), cache=True)
def levels(x, p, q, radii, velocity, power):  # type: ignore[no-untyped-def]
    """`level` (n,) of all obstacles at x (3,)."""
    rows = _rows(p, q, radii, velocity, power)
    out, slope = np.empty(len(rows)), np.empty(3)
    for i in range(len(rows)):
        out[i] = level(rows[i], x, slope)
    return out


@njit((POINTS, POINTS, POINTS, *_OBSTACLES, NUMBER, NUMBER), cache=True)
def bend(v, x, free, p, q, radii, velocity, power, locality, rate):  # type: ignore[no-untyped-def]
    """Velocities (n, 3) at points (n, 3), bent around the obstacles that hold none of the points `free` (k, 3)."""
    rows, kept, slope = _rows(p, q, radii, velocity, power), 0, np.empty(3)
    for i in range(len(rows)):
        counts = True
        for j in range(len(free)):
            counts &= level(rows[i], free[j], slope) > 1.0
        if counts:
            for j in range(19):
                rows[kept, j] = rows[i, j]
            kept += 1
    out = v.copy()
    if kept > 0:
        rows = rows[:kept]
        points, group = references(rows)
        for i in range(len(v)):
            _bend(v[i], x[i], rows, points, group, locality, rate, out[i])
    return out
