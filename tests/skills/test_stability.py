import clarabel
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

from symskill_pddl.errors import CertificateError
from symskill_pddl.skills.stability import _solve, certify, fit_matrices, fit_metric

SETTINGS = {"gain_hz": 3.0, "rate_hz": 1.0, "period_s": 0.05, "ridge": 1e-3}


@pytest.mark.parametrize(
    ("A", "P", "message"),
    [
        (np.eye(3)[None], np.eye(3), "not negative definite, rate -1 1/s"),
        (-np.eye(3)[None], np.diag([1.0, 1.0, -1.0]), "least eigenvalue -1"),
        (-np.eye(3)[None], np.diag([1.0, 1.0, 0.0]), "P is not positive definite"),
        (-50.0 * np.eye(3)[None], np.eye(3), "explicit Euler at 0.05 s grows the error by 1.5"),
        (np.full((1, 3, 3), np.nan), np.eye(3), "not finite"),
        (np.stack([-np.eye(3), np.array([[-1.0, 9, 0], [0, -1, 0], [0, 0, -1]])]), np.eye(3), "not negative definite"),
    ],
)
def test_what_is_not_stable_is_refused(A, P, message):
    with pytest.raises(CertificateError, match=message):
        certify(A, P, 0.05)


def test_certificate_of_a_known_system():
    certificate = certify(np.array([np.diag([-1.0, -2.0, -3.0])]), np.eye(3), 0.05)
    assert certificate.rate_hz == pytest.approx(1.0)
    assert certificate.step_norm == pytest.approx(0.95)


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
    certificate = certify(A, P, 0.05)
    assert certificate.rate_hz >= 1.0 - 1e-4
    assert certificate.step_norm <= np.sqrt(1 - 2 * 0.05) + 1e-5
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


def test_a_solver_failure_is_an_error():
    # no number is above one and below zero
    A = sparse.csc_matrix([[-1.0], [1.0]])
    with pytest.raises(CertificateError, match="this test: the solver stopped with status"):
        _solve(sparse.csc_matrix((1, 1)), np.zeros(1), A, np.array([-1.0, 0.0]), [clarabel.NonnegativeConeT(2)], "this test")
