"""How deep whole hands are in ellipsoids, compiled: the hands of a way are looked at in every control tick (see `kernels`)."""

from __future__ import annotations

from math import log

import numpy as np
from numba import njit, types

from symskill_pddl.skills.bending import level, matrix
from symskill_pddl.skills.kernels import NUMBER, fixed


@njit(cache=True)
def _around_hand(p, q, radii, hand, width, length, bulge, row):  # type: ignore[no-untyped-def]
    """`row` (see `bending`) takes what a tip has to keep out of for its hand, of axes (9,), to keep out of a thing."""
    share = 1.0
    row[3:12] = hand
    if max(radii[0], radii[1], radii[2]) - min(radii[0], radii[1], radii[2]) >= 1e-9:
        matrix(q, row[3:12])
    for i in range(3):
        b = row[3 + i] * hand[1] + row[6 + i] * hand[4] + row[9 + i] * hand[7]
        c = row[3 + i] * hand[2] + row[6 + i] * hand[5] + row[9 + i] * hand[8]
        wide = radii[i] + 0.5 * (width * abs(b) + length * abs(c))
        share = min(share, radii[i] / wide)
        row[i], row[12 + i] = p[i] + 0.5 * length * hand[3 * i + 2], bulge * wide
    row[15] = 1.0
    for k in (2.0, 3.0):
        row[15] = max(row[15], log(k) / (-2.0 * log(1.0 - share * (1.0 - k**-0.5))))
    row[15] = min(row[15], 50.0)


@njit((fixed(1), fixed(1), fixed(2), fixed(2), fixed(2), fixed(2), fixed(2), types.UniTuple(NUMBER, 2), NUMBER), cache=True)
def least_levels(base_p, base_q, p, q, things_p, things_q, radii, size, bulge):  # type: ignore[no-untyped-def]
    """Least levels (m,) of things (n,) at hands (m,) that are given in the frame `base`; see `execution.around.around_hand`."""
    out, row, slope, here, turn = np.full(len(p), np.inf), np.zeros(19), np.empty(3), np.empty(3), np.empty(4)
    base, hand = np.empty(9), np.empty(9)
    matrix(base_q, base)
    aw, ax, ay, az = base_q[0], base_q[1], base_q[2], base_q[3]
    for i in range(len(p)):
        bw, bx, by, bz = q[i, 0], q[i, 1], q[i, 2], q[i, 3]
        turn[0], turn[1] = aw * bw - ax * bx - ay * by - az * bz, aw * bx + ax * bw + ay * bz - az * by
        turn[2], turn[3] = aw * by - ax * bz + ay * bw + az * bx, aw * bz + ax * by - ay * bx + az * bw
        matrix(turn, hand)
        for j in range(3):
            here[j] = base_p[j] + base[3 * j] * p[i, 0] + base[3 * j + 1] * p[i, 1] + base[3 * j + 2] * p[i, 2]
        for k in range(len(things_p)):
            _around_hand(things_p[k], things_q[k], radii[k], hand, size[0], size[1], bulge, row)
            out[i] = min(out[i], level(row, here, slope))
    return out
