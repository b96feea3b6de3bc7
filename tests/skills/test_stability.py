import numpy as np
import pytest

from symskill_pddl.errors import CertificateError
from symskill_pddl.skills.stability import certify


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
