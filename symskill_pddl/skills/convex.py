"""The two convex problems behind a stable field: the metric P, then the matrices A_k that are stable in it.

They are stated in the solver's own terms, minimise x^T Q x / 2 + c^T x over b - A x in cones: a modelling language takes several
times as long to translate a problem of this size as the solver takes. Only fitting needs the solver, so this module is imported
where a field is fitted, not before. Every solve starts cold and runs in one thread: its result depends on its data alone.
"""

from __future__ import annotations

from typing import Any

import clarabel
import numpy as np
from scipy import sparse

from symskill_pddl.errors import CertificateError
from symskill_pddl.geometry import Array
from symskill_pddl.skills.stability import roots

_MARGIN = 0.05
"""The means are to approach the goal by at least this (velocity and position are unit vectors)."""
_PULL = 0.02
"""Weight of the identity in the metric: it makes the answer unique."""
_UPPER = tuple((i, j) for j in range(6) for i in range(j + 1))
"""Entries of a symmetric matrix in the solver's order; those off the diagonal are multiplied by the square root of 2."""


def fit_metric(x: Array, v: Array, max_condition: float) -> Array:
    """Learn P (3, 3), of trace 3, in which the cluster means move towards the goal ("convex policy learning", Li et al. 2025).

    Minimises the mean of max(0, v^T P x + margin) over unit vectors v (n, 3) and x (n, 3), with a small pull to the identity
    that makes the answer unique, P >= delta I and trace P = 3 (the scale of P is not free, its condition number is capped).

    Raises
    ------
    CertificateError
        If the data are not finite or the solver fails; the message names the solver's status.
    """
    n = len(x)
    upper = _UPPER[:6]
    twice = np.array([1.0 if i == j else 2.0 for i, j in upper])
    identity = np.array([float(i == j) for i, j in upper])
    # v^T P x on the six entries of P, and the rises above zero, one for each mean
    products = np.stack(
        [0.5 * t * (v[:, i] * x[:, j] + v[:, j] * x[:, i]) for t, (i, j) in zip(twice, upper, strict=True)], axis=1
    )
    eye, none = np.eye(n), np.zeros((n, 6))
    A = np.concatenate(
        [
            np.concatenate([identity, np.zeros(n)])[None],  # trace P = 3
            np.concatenate([none, -eye], axis=1),  # rise >= 0
            np.concatenate([products, -eye], axis=1),  # rise >= v^T P x + margin
            np.concatenate([-np.diag(np.sqrt(twice)), np.zeros((6, n))], axis=1),  # P - delta I is positive
        ]
    )
    delta = 3.0 / (max_condition + 2.0)  # the largest eigenvalue is at most 3 - 2 delta
    b = np.concatenate([[3.0], np.zeros(n), np.full(n, -_MARGIN), -delta * identity])
    Q = np.diag(np.concatenate([_PULL * twice, np.zeros(n)]))
    c = np.concatenate([-_PULL * identity, np.full(n, 1.0 / n)])
    cones = [clarabel.ZeroConeT(1), clarabel.NonnegativeConeT(2 * n), clarabel.PSDTriangleConeT(3)]
    entries = solve(Q, c, A, b, cones, "learning the metric P")
    P = np.zeros((3, 3))
    for value, (i, j) in zip(entries, upper, strict=False):
        P[i, j] = P[j, i] = value
    return np.asarray(3.0 * P / np.trace(P))


def fit_matrices(
    x: Array,
    v: Array,
    weights: Array,
    importance: Array,
    P: Array,
    *,
    gain_hz: float,
    rate_hz: float,
    period_s: float,
    ridge: float,
) -> Array:
    """Least squares A_k (K, 3, 3) for v = sum_k weights_k A_k x, stable in the metric P.

    The data enter through a factor (3K, 3K) of their Gram matrix only: the solve does not grow with the number of samples.

    Parameters
    ----------
    x, v : (n, 3)
        Errors to the goal and desired velocities.
    weights : (n, K)
        Mixture weights.
    importance : (n,)
        Weight of each sample's squared residual; sums to 1.

    Raises
    ------
    CertificateError
        If the data are not finite or the solver fails; the message names the solver's status.
    """
    K = weights.shape[1]
    root_P, inverse_root = roots(P)
    each = np.sqrt(importance)[:, None]
    features = each * (weights[:, :, None] * x[:, None, :]).reshape(len(x), 3 * K)
    # || features B - v || = || R B - target || + constant: the triangular factor of a QR decomposition
    data = np.concatenate([features, each * v / gain_hz], axis=1)
    R = np.asarray(np.linalg.qr(np.concatenate([data, np.zeros((3 * K, 3 * K + 3))]), mode="r"))
    factor, target = R[: 3 * K, : 3 * K], R[: 3 * K, 3 * K :]
    # In units of the gain. The unknowns are S_k = P^(1/2) A_k P^(-1/2), the same matrices seen in the metric, row by row, and
    # the residuals r; column a of A_k^T is a linear form in the entries of S_k.
    entry = np.einsum("ai,jb->baij", inverse_root, root_P).reshape(3, 3, 9)  # A_k[a, b] = entry[b, a] . S_k
    mapped = np.einsum("mkb,baq->makq", factor.reshape(3 * K, K, 3), entry).reshape(9 * K, 9 * K)
    size = np.sum((each * weights) ** 2 * np.sum((x @ root_P) ** 2, axis=1, keepdims=True)) / K
    pull = ridge * float(size)  # holds S_k near to -I
    Q = np.concatenate([np.full(9 * K, pull), np.ones(9 * K)])
    c = np.concatenate([np.tile(pull * np.eye(3).ravel(), K), np.zeros(9 * K)])
    # || I + h S_k || <= rho: the symmetric matrix [rho I, I + h S_k; its transpose, rho I] is positive
    step, rho = gain_hz * period_s, np.sqrt(1.0 - 2.0 * rate_hz * period_s)
    A, b = np.zeros((21, 9)), np.zeros(21)
    for row, (i, j) in enumerate(_UPPER):
        if i == j:
            b[row] = rho
        elif i < 3 <= j:
            A[row, 3 * i + j - 3] = -np.sqrt(2.0) * step
            b[row] = np.sqrt(2.0) * (i == j - 3)
    rows = sparse.bmat([[mapped, -sparse.eye(9 * K)], [sparse.kron(sparse.eye(K), A), None]])
    cones = [clarabel.ZeroConeT(9 * K), *[clarabel.PSDTriangleConeT(6)] * K]
    found = solve(np.diag(Q), c, rows, np.concatenate([target.ravel(), np.tile(b, K)]), cones, "fitting the stable matrices")
    S = found[: 9 * K].reshape(K, 3, 3)
    return np.asarray(gain_hz * (inverse_root @ S @ root_P))


def solve(Q: Array, c: Array, A: Any, b: Array, cones: list[Any], what: str) -> Array:
    """The x that minimises x^T Q x / 2 + c^T x with b - A x in the cones."""
    A = sparse.csc_matrix(A)
    if not all(np.all(np.isfinite(values)) for values in (Q, c, A.data, b)):
        raise CertificateError(f"{what}: the data are not finite")
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_threads = False, 1
    settings.static_regularization_constant = (
        1e-7  # of 4,500 problems of random numbers the default leaves 30 unsolved, this none
    )
    solution = clarabel.DefaultSolver(sparse.triu(Q, format="csc"), c, A, b, cones, settings).solve()
    # nearly solved is good enough: the certificate is checked on the numbers themselves
    if solution.status not in (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved):
        raise CertificateError(f"{what}: the solver stopped with status {solution.status}")
    return np.array(solution.x)
