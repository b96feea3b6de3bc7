import subprocess
import sys

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symskill_pddl.errors import CertificateError
from symskill_pddl.skills.convex import _matrices_problem, _metric_problem, _solve, fit_matrices, fit_metric
from symskill_pddl.skills.stability import certify, roots

SETTINGS = {"gain_hz": 3.0, "rate_hz": 1.0, "period_s": 0.05, "ridge": 1e-3}


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 5))
def test_any_data_gives_certified_matrices(seed, K):
    rng = np.random.default_rng(seed)
    x, v = rng.normal(size=(40, 3)), rng.normal(size=(40, 3)) * rng.choice([0.1, 1.0, 30.0])
    w = rng.dirichlet(np.ones(K), 40)
    P = fit_metric(x / np.linalg.norm(x, axis=1)[:, None], v / np.linalg.norm(v, axis=1)[:, None], 50.0)
    assert np.trace(P) == pytest.approx(3.0)
    assert np.linalg.cond(P) <= 50.0 * 1.01
    A = fit_matrices(x, v, w, np.full(40, 1 / 40), P, **SETTINGS)
    certificate = certify(A, P)
    certificate.demand(1.0, SETTINGS["period_s"], slack=1e-4)
    # the continuous condition itself, and the step for a mixture of systems
    for Ak in A:
        assert np.linalg.eigvalsh(Ak.T @ P + P @ Ak + 2 * (certificate.rate_hz - 1e-9) * P).max() <= 1e-7
    mixed = x + 0.05 * rng.uniform() * np.einsum("nk,kij,nj->ni", w, A, x)
    assert np.all(np.einsum("ni,ij,nj->n", mixed, P, mixed) < np.einsum("ni,ij,nj->n", x, P, x))


def test_a_system_within_the_conditions_is_recovered():
    rng = np.random.default_rng(0)
    A = np.array([[-2.0, 0.5, 0.0], [-0.5, -2.0, 0.0], [0.0, 0.0, -1.5]])
    x = rng.normal(size=(50, 3))
    found = fit_matrices(x, x @ A.T, np.ones((50, 1)), np.full(50, 0.02), np.eye(3), **{**SETTINGS, "ridge": 1e-9})
    assert np.allclose(found[0], A, atol=1e-4)


def test_collinear_data_pull_to_the_goal_across():
    x = np.linspace(0.1, 1, 20)[:, None] * np.array([1.0, 0, 0])
    A = fit_matrices(x, -3.0 * x, np.ones((20, 1)), np.full(20, 0.05), np.eye(3), **SETTINGS)
    assert np.allclose(A[0], -3.0 * np.eye(3), atol=1e-4)


def test_metric_bends_to_a_motion_that_the_plain_one_forbids():
    # an L: while going down the plain distance to the goal may rise, in the learned metric it must not
    x = np.array([[-1.0, 0, 0.3], [-0.9, 0, 0.05], [-0.5, 0, 0.0]])
    v = np.array([[-0.1, 0, -1.0], [0.3, 0, -1.0], [1.0, 0, 0.0]])
    x, v = x / np.linalg.norm(x, axis=1)[:, None], v / np.linalg.norm(v, axis=1)[:, None]
    P = fit_metric(x, v, 50.0)
    plain, learned = np.einsum("ni,ni->n", v, x), np.einsum("ni,ij,nj->n", v, P, x)
    assert np.maximum(0, learned).sum() <= np.maximum(0, plain).sum() + 1e-9
    assert np.allclose(fit_metric(x[2:], v[2:], 50.0), np.eye(3), atol=0.05)


@pytest.mark.parametrize("K", [1, 3])
def test_no_stable_matrices_near_by_fit_better(K):
    # the problem as it is stated, on the samples themselves: neither the factor nor the solver hides anything
    rng = np.random.default_rng(K)
    x, v, w = rng.normal(size=(60, 3)), 3.0 * rng.normal(size=(60, 3)), rng.dirichlet(np.ones(K), 60)
    importance = rng.dirichlet(np.ones(60))
    P = np.diag([2.0, 0.5, 0.5])
    R, R_inv = roots(P)

    def cost(A: np.ndarray) -> float:
        misfit = importance @ np.sum((np.einsum("nk,kij,nj->ni", w, A, x) - v) ** 2, axis=1)
        scale = np.sum(importance[:, None] * w**2 * np.sum((x @ R) ** 2, axis=1)[:, None]) / K
        return float(misfit + SETTINGS["ridge"] * scale * np.sum((R @ A @ R_inv + 3.0 * np.eye(3)) ** 2))

    A = fit_matrices(x, v, w, importance, P, **SETTINGS)
    least, allowed, tried = cost(A), np.sqrt(1 - 2 * 0.05), 0
    for _ in range(300):
        other = A + rng.choice([1e-3, 1e-2, 0.1]) * rng.normal(size=A.shape)
        # pulled towards -3 I, which is strictly inside, until it is allowed
        while np.linalg.norm(np.eye(3) + 0.05 * R @ other @ R_inv, ord=2, axis=(1, 2)).max() > allowed:
            other = other + 0.02 * (-3.0 * np.eye(3) - other)
        tried += 1
        assert cost(other) >= least - 1e-5 * (1 + least)
    assert tried == 300


def test_fewer_samples_than_unknowns():
    x, v = np.eye(3)[:2], -np.eye(3)[:2]
    A = fit_matrices(x, v, np.full((2, 4), 0.25), np.full(2, 0.5), np.eye(3), **SETTINGS)
    assert certify(A, np.eye(3)).rate_hz >= 1.0 - 1e-4


def test_a_fit_does_not_depend_on_earlier_fits():
    rng = np.random.default_rng(5)
    x, v, w, importance = rng.normal(size=(40, 3)), rng.normal(size=(40, 3)), rng.dirichlet([1, 1], 40), np.full(40, 1 / 40)
    units = [a / np.linalg.norm(a, axis=1)[:, None] for a in (x, v)]

    def fits() -> tuple[np.ndarray, np.ndarray]:
        return fit_metric(*units, 50.0), fit_matrices(x, v, w, importance, np.eye(3), **SETTINGS)

    _metric_problem.cache_clear()
    _matrices_problem.cache_clear()
    first = fits()
    fit_metric(units[1], units[0], 50.0)
    fit_matrices(v, 10.0 * x, w, importance, np.diag([2.0, 0.5, 0.5]), **SETTINGS)
    for a, b in zip(first, fits(), strict=True):
        assert np.array_equal(a, b)


def test_problems_are_stated_once():
    assert _matrices_problem(3, 0.15, 0.9) is _matrices_problem(3, 0.15, 0.9)
    assert _matrices_problem(3, 0.15, 0.9).is_dpp()
    assert _metric_problem(7, 50.0).is_dpp()


def test_a_solver_failure_is_an_error():
    # no number is above one and below zero
    x = cp.Variable()
    with pytest.raises(CertificateError, match="this test: the solver stopped with status infeasible"):
        _solve(cp.Problem(cp.Minimize(x), [x >= 1, x <= 0]), "this test")


def test_data_that_are_no_numbers_are_an_error():
    with pytest.raises(CertificateError, match="fitting the stable matrices: the data are not finite"):
        fit_matrices(np.ones((4, 3)), np.full((4, 3), np.nan), np.ones((4, 1)), np.full(4, 0.25), np.eye(3), **SETTINGS)
    with pytest.raises(CertificateError, match="learning the metric P: the data are not finite"):
        fit_metric(np.full((4, 3), np.inf), np.ones((4, 3)), 50.0)


def test_running_skills_needs_neither_solver_nor_scikit_learn():
    code = "import sys, symskill_pddl.skills; print(*sorted(set(sys.modules) & {'cvxpy', 'sklearn', 'clarabel'}))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
