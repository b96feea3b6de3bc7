"""The two convex problems behind a stable field, in CVXPY: the metric P, then the matrices A_k that are stable in it.

CVXPY takes a second to import and only fitting needs it, so this module is imported where a field is fitted, not before. The
problems are stated once per size; their data are parameters (in CVXPY's terms the problems are DPP), so that a solve only fills
in numbers. Every solve starts cold and runs in one thread: its result depends on its data alone, not on earlier solves.
"""

from __future__ import annotations

import warnings
from functools import lru_cache

import cvxpy as cp
import numpy as np

from symskill_pddl.errors import CertificateError
from symskill_pddl.geometry import Array
from symskill_pddl.skills.stability import roots

_MARGIN = 0.05
"""The means are to approach the goal by at least this (velocity and position are unit vectors)."""
_PULL = 0.02
"""Weight of the identity in the metric: it makes the answer unique."""


def fit_metric(x: Array, v: Array, max_condition: float) -> Array:
    """Learn P (3, 3), of trace 3, in which the cluster means move towards the goal ("convex policy learning", Li et al. 2025).

    Minimises the mean of max(0, v^T P x + margin) over unit vectors v (n, 3) and x (n, 3), with a small pull to the identity
    that makes the answer unique, P >= delta I and trace P = 3 (the scale of P is not free, its condition number is capped).

    Raises
    ------
    CertificateError
        If the data are not finite or the solver fails; the message names the solver's status.
    """
    problem = _metric_problem(len(x), max_condition)
    _solve(problem, "learning the metric P", products=(v[:, :, None] * x[:, None, :]).reshape(-1, 9))
    P = problem.var_dict["P"].value
    P = 0.5 * (P + P.T)
    return np.asarray(3.0 * P / np.trace(P))


@lru_cache(maxsize=32)
def _metric_problem(n: int, max_condition: float) -> cp.Problem:
    P = cp.Variable((3, 3), symmetric=True, name="P")
    products = cp.Parameter((n, 9), name="products")  # v_i x_i^T, so that v_i^T P x_i is its product with P
    rise = cp.pos(products @ cp.vec(P, order="C") + _MARGIN)
    delta = 3.0 / (max_condition + 2.0)  # the largest eigenvalue is at most 3 - 2 delta
    return cp.Problem(
        cp.Minimize(cp.sum(rise) / n + 0.5 * _PULL * cp.sum_squares(P - np.eye(3))),
        [P >> delta * np.eye(3), cp.trace(P) == 3.0],
    )


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
    root_P, _ = roots(P)
    each = np.sqrt(importance)[:, None]
    features = each * (weights[:, :, None] * x[:, None, :]).reshape(len(x), 3 * K)
    # || features B - v || = || factor B - target || + constant: the triangular factor of a QR decomposition
    data = np.concatenate([features, each * v / gain_hz], axis=1)
    R = np.asarray(np.linalg.qr(np.concatenate([data, np.zeros((3 * K, 3 * K + 3))]), mode="r"))
    size = np.sum((each * weights) ** 2 * np.sum((x @ root_P) ** 2, axis=1, keepdims=True)) / K
    problem = _matrices_problem(K, gain_hz * period_s, np.sqrt(1.0 - 2.0 * rate_hz * period_s))
    values = {"factor": R[: 3 * K, : 3 * K], "target": R[: 3 * K, 3 * K :], "root_P": root_P, "pull": np.sqrt(ridge * size)}
    _solve(problem, "fitting the stable matrices", **values)
    return gain_hz * np.stack([problem.var_dict[f"A{k}"].value for k in range(K)])


@lru_cache(maxsize=32)
def _matrices_problem(K: int, step: float, rho: float) -> cp.Problem:
    """In units of the gain: A_k, and S_k = P^(1/2) A_k P^(-1/2), which is the same matrix seen in the metric."""
    A = [cp.Variable((3, 3), name=f"A{k}") for k in range(K)]
    S = [cp.Variable((3, 3)) for _ in range(K)]
    factor = cp.Parameter((3 * K, 3 * K), name="factor")
    target = cp.Parameter((3 * K, 3), name="target")
    root_P = cp.Parameter((3, 3), name="root_P")
    pull = cp.Parameter(nonneg=True, name="pull")
    misfit = cp.sum_squares(factor @ cp.vstack([Ak.T for Ak in A]) - target)
    plain = cp.sum_squares(pull * (cp.hstack(S) + np.tile(np.eye(3), K)))  # small where S_k is near to -I
    stable = [cp.sigma_max(np.eye(3) + step * Sk) <= rho for Sk in S]
    return cp.Problem(cp.Minimize(misfit + plain), [*stable, *(Sk @ root_P == root_P @ Ak for Sk, Ak in zip(S, A, strict=True))])


def _solve(problem: cp.Problem, what: str, **values: Array) -> None:
    """Solve for these values of the parameters; the variables hold the answer."""
    if not all(np.all(np.isfinite(value)) for value in values.values()):
        raise CertificateError(f"{what}: the data are not finite")
    for name, value in values.items():
        problem.param_dict[name].value = value
    with warnings.catch_warnings():
        # nearly solved is good enough: the certificate is checked on the numbers themselves
        warnings.filterwarnings("ignore", message="Solution may be inaccurate", category=UserWarning)
        try:
            problem.solve(solver=cp.CLARABEL, warm_start=False, max_threads=1)
        except cp.SolverError as error:
            raise CertificateError(f"{what}: the solver failed: {error}") from error
    if problem.status not in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE):
        raise CertificateError(f"{what}: the solver stopped with status {problem.status}")
