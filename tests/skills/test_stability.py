import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symskill_pddl.errors import CertificateError
from symskill_pddl.skills.stability import certify


@pytest.mark.parametrize(
    ("A", "P", "message"),
    [
        (np.eye(3)[None], np.eye(3), "not negative definite enough, rate -1 1/s"),
        (-1e-3 * np.eye(3)[None], np.eye(3), r"rate 0\.001 1/s is below 0\.02"),
        (-np.eye(3)[None], np.diag([1.0, 1.0, -1.0]), "least eigenvalue -1"),
        (-np.eye(3)[None], np.diag([1.0, 1.0, 0.0]), "P is not positive definite"),
        (-np.eye(3)[None], np.array([[1.0, 1, 0], [0, 1, 0], [0, 0, 1]]), "P is not symmetric"),
        (-2e3 * np.eye(3)[None], np.eye(3), r"shrink the error up to 0\.001 s only"),
        (np.full((1, 3, 3), np.nan), np.eye(3), "not finite"),
        (np.stack([-np.eye(3), np.array([[-1.0, 9, 0], [0, -1, 0], [0, 0, -1]])]), np.eye(3), "not negative definite"),
    ],
)
def test_what_is_not_stable_is_refused(A, P, message):
    with pytest.raises(CertificateError, match=message):
        certify(A, P)


def test_certificate_of_a_known_system():
    certificate = certify(np.array([np.diag([-1.0, -2.0, -4.0])]), np.eye(3))
    assert certificate.rate_hz == pytest.approx(1.0)
    assert certificate.max_period_s == pytest.approx(2.0 / 4.0)
    assert certify(-np.eye(3)[None], np.eye(3), slowest=0.25).rate_hz == pytest.approx(0.25)


def test_less_than_asked_is_refused():
    certificate = certify(-np.eye(3)[None], np.eye(3))
    certificate.demand(1.0, 2.0)
    with pytest.raises(CertificateError, match=r"falls at 1 /s, not at 1\.1 /s"):
        certificate.demand(1.1, 0.1)
    with pytest.raises(CertificateError, match=r"up to 2 s shrink the error, not of 2\.5 s"):
        certificate.demand(0.5, 2.5)


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_the_longest_step_is_the_longest(seed):
    """A step just shorter shrinks the error from everywhere, one just longer grows it from somewhere."""
    rng = np.random.default_rng(seed)
    skew = rng.normal(size=(2, 3, 3))
    A = -(0.5 + rng.random((2, 1, 1))) * np.eye(3) + (skew - skew.transpose(0, 2, 1))
    certificate = certify(A, np.eye(3))
    norms = [np.linalg.norm(np.eye(3) + h * certificate.max_period_s * A, ord=2, axis=(1, 2)).max() for h in (0.999, 1.001)]
    assert norms[0] < 1.0 < norms[1]
