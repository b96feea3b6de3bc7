"""The two convex problems behind a stable field, solved on Clarabel's own interface, and the certificate checked afterwards.

With P fixed and y = P^(1/2) x, every linear system reads y' = S_k y, and one condition on each S_k carries all that is asked for:

    || I + h S_k ||_2 <= rho,   rho^2 = 1 - 2 alpha h,   h the control period.

It is the discrete-time condition: an explicit Euler step shortens y by the factor rho, for any mixture weights and any speed
cap, because the norm is convex. And it implies the continuous one, S_k + S_k^T <= -2 alpha I, that is A_k^T P + P A_k <= -2
alpha P.
"""

from __future__ import annotations

from dataclasses import dataclass

import clarabel
import numpy as np
from scipy import sparse

from symskill_pddl.errors import CertificateError
from symskill_pddl.geometry import Array, frozen

_ROOT2 = np.sqrt(2.0)
_UPPER = [(i, j) for j in range(3) for i in range(j + 1)]


@dataclass(frozen=True, eq=False)
class Certificate:
    """What was checked after the solve, by eigenvalues.

    Attributes
    ----------
    P : (3, 3)
        Metric of the Lyapunov function x^T P x, of trace 3.
    rate_hz : float
        Largest alpha with A_k^T P + P A_k <= -2 alpha P for all k.
    step_norm : float
        Largest ||I + h A_k|| in the metric P: the factor by which one control step at most keeps the distance.
    period_s : float
        The control period h of `step_norm`.
    """

    P: Array
    rate_hz: float
    step_norm: float
    period_s: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "P", frozen(self.P))


def roots(P: Array) -> tuple[Array, Array]:
    """P^(1/2) and P^(-1/2)."""
    values, V = np.linalg.eigh(P)
    root = np.sqrt(values)
    return (V * root) @ V.T, (V / root) @ V.T


def certify(matrices: Array, P: Array, period_s: float, slack: float = 1e-6) -> Certificate:
    """Check matrices (K, 3, 3) against the metric P (3, 3).

    Raises
    ------
    CertificateError
        Naming the condition that fails and by how much.
    """
    if not (np.all(np.isfinite(matrices)) and np.all(np.isfinite(P))):
        raise CertificateError("stability certificate: the fitted matrices are not finite")
    least = float(np.linalg.eigvalsh(0.5 * (P + P.T))[0])
    if least <= slack:
        raise CertificateError(f"stability certificate: P is not positive definite, least eigenvalue {least:.3g}")
    R, R_inv = roots(P)
    S = R @ matrices @ R_inv
    rate = float(-0.5 * np.linalg.eigvalsh(S + S.transpose(0, 2, 1)).max())
    if rate <= slack:
        raise CertificateError(
            f"stability certificate: A^T P + P A is not negative definite, rate {rate:.3g} 1/s is not positive"
        )
    norm = float(np.linalg.norm(np.eye(3) + period_s * S, ord=2, axis=(1, 2)).max())
    if norm >= 1.0:
        raise CertificateError(
            f"stability certificate: explicit Euler at {period_s} s grows the error by {norm:.6g}, not below 1"
        )
    return Certificate(P, rate, norm, period_s)


def fit_metric(x: Array, v: Array, max_condition: float) -> Array:
    """Learn P (3, 3), of trace 3, in which the cluster means move towards the goal ("convex policy learning", Li et al. 2025).

    Minimises the sum of max(0, v^T P x + margin) over unit vectors v (n, 3) and x (n, 3), with a small pull to the identity
    that makes the answer unique, P >= delta I and trace P = 3 (the scale of P is not free, its condition number is capped).
    """
    n = len(x)
    margin, pull = 0.05, 0.02 * n
    delta = 3.0 / (max_condition + 2.0)  # the largest eigenvalue is at most 3 - 2 delta
    # variables: svec(P) in the order of _UPPER (6), then t (n)
    svec = np.array([[1.0 if i == j else _ROOT2 for i, j in _UPPER]])
    products = np.stack([x[:, i] * v[:, j] for i, j in _UPPER], 1)
    swapped = np.stack([x[:, j] * v[:, i] for i, j in _UPPER], 1)
    a = 0.5 * (products + swapped) * svec  # v^T P x = a . svec(P)
    identity = np.array([1.0 if i == j else 0.0 for i, j in _UPPER])
    H = sparse.diags(np.concatenate([np.full(6, pull), np.zeros(n)]), format="csc")
    c = np.concatenate([-pull * identity, np.ones(n)])
    rows = np.concatenate(
        [
            np.concatenate([identity, np.zeros(n)])[None],  # trace
            np.concatenate([np.zeros((n, 6)), -np.eye(n)], 1),  # t >= 0
            np.concatenate([a, -np.eye(n)], 1),  # t >= a p + margin
            np.concatenate([-np.eye(6), np.zeros((6, n))], 1),  # P - delta I in the cone
        ]
    )
    b = np.concatenate([[3.0], np.zeros(n), np.full(n, -margin), -delta * identity])
    cones = [clarabel.ZeroConeT(1), clarabel.NonnegativeConeT(2 * n), clarabel.PSDTriangleConeT(3)]
    p = _solve(H, c, sparse.csc_matrix(rows), b, cones, "learning the metric P")[:6] / svec[0]
    P = np.zeros((3, 3))
    for (i, j), value in zip(_UPPER, p, strict=True):
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

    The data enter through a Gram matrix (3K, 3K) only: the solve does not grow with the number of samples.

    Parameters
    ----------
    x, v : (n, 3)
        Errors to the goal and desired velocities.
    weights : (n, K)
        Mixture weights.
    importance : (n,)
        Weight of each sample's squared residual; sums to 1.
    """
    K = weights.shape[1]
    R, R_inv = roots(P)
    features = (weights[:, :, None] * (x @ R)[:, None, :]).reshape(len(x), 3 * K)
    gram = (importance[:, None] * features).T @ features  # (3K, 3K)
    cross = (importance[:, None] * features).T @ (v @ R) / gain_hz  # (3K, 3)
    # unknown Z = S / gain, row-major (3, 3K); residuals are measured in the units of v, hence P^-1
    scale = np.trace(gram) / K
    W = R_inv @ R_inv
    H = np.kron(W, gram) + ridge * scale * np.eye(9 * K)
    c = -(W @ cross.T).reshape(-1) + ridge * scale * np.tile(np.eye(3), (1, K)).reshape(-1)
    rho = np.sqrt(1.0 - 2.0 * rate_hz * period_s)
    step = gain_hz * period_s
    # [[rho I, M_k], [M_k^T, rho I]] >= 0 with M_k = I + step Z_k, upper triangle by columns
    triangle = [(i, j) for j in range(6) for i in range(j + 1)]
    entries, b_block = [], np.zeros(21)
    for row, (i, j) in enumerate(triangle):
        if i == j:
            b_block[row] = rho
        elif i < 3 <= j:
            entries.append((row, i, j - 3))
            b_block[row] = _ROOT2 * (i == j - 3)
    rows = [21 * k + row for k in range(K) for row, _, _ in entries]
    columns = [i * 3 * K + 3 * k + j for k in range(K) for _, i, j in entries]
    A = sparse.csc_matrix((np.full(len(rows), -_ROOT2 * step), (rows, columns)), shape=(21 * K, 9 * K))
    cones = [clarabel.PSDTriangleConeT(6)] * K
    z = _solve(sparse.csc_matrix(np.triu(H)), c, A, np.tile(b_block, K), cones, "fitting the stable matrices")
    S = gain_hz * z.reshape(3, K, 3).transpose(1, 0, 2)
    return R_inv @ S @ R


def _solve(H: sparse.csc_matrix, c: Array, A: sparse.csc_matrix, b: Array, cones: list[object], what: str) -> Array:
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    solution = clarabel.DefaultSolver(H, c, A, b, cones, settings).solve()
    if str(solution.status) not in ("Solved", "AlmostSolved"):
        raise CertificateError(f"{what}: the solver stopped with status {solution.status}")
    return np.asarray(solution.x)
