"""What makes a field stable, and the certificate that is computed from the numbers that run.

With P fixed and y = P^(1/2) x, every linear system reads y' = S_k y. Two numbers say all that is promised:

- the rate: the largest alpha with S_k + S_k^T <= -2 alpha I for all k, that is A_k^T P + P A_k <= -2 alpha P;
- the longest step: the largest h with || I + h S_k ||_2 <= 1 for all k. An explicit Euler step of less than h shortens y, for
  any mixture weights, any speed cap and any factor in (0, 1] that slows a field down, because the norm is convex.

A field that may be slowed down to a fraction of its velocity keeps that fraction of the rate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symskill_pddl.errors import CertificateError
from symskill_pddl.geometry import Array, frozen

MIN_RATE_HZ = 0.02
"""A field that approaches its goal more slowly than this [1/s] does not arrive while anybody waits."""
MIN_PERIOD_S = 0.002
"""No robot is commanded in shorter steps than this [s]: a field that needs them has matrices that are no motion's."""


@dataclass(frozen=True, eq=False)
class Certificate:
    """What holds of a field as it runs, computed by eigenvalues.

    Attributes
    ----------
    P : (3, 3)
        Metric of the Lyapunov function x^T P x, of trace 3.
    rate_hz : float
        Below the speed cap the distance in the metric P falls at least as exp(-rate_hz t).
    max_period_s : float
        Explicit Euler steps of less than this shorten the distance, from anywhere [s].
    """

    P: Array
    rate_hz: float
    max_period_s: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "P", frozen(self.P))

    def demand(self, rate_hz: float, period_s: float, slack: float = 1e-2) -> None:
        """Raise `CertificateError` where less than a rate, or steps of less than a period, are certified; up to a fraction."""
        if self.rate_hz < (1.0 - slack) * rate_hz:
            raise CertificateError(f"stability certificate: the error falls at {self.rate_hz:.3g} /s, not at {rate_hz:.3g} /s")
        if self.max_period_s < (1.0 - slack) * period_s:
            raise CertificateError(
                f"stability certificate: steps of up to {self.max_period_s:.3g} s shrink the error, not of {period_s:.3g} s"
            )


def roots(P: Array) -> tuple[Array, Array]:
    """P^(1/2) and P^(-1/2)."""
    values, V = np.linalg.eigh(P)
    root = np.sqrt(values)
    return (V * root) @ V.T, (V / root) @ V.T


def certify(matrices: Array, P: Array, slowest: float = 1.0) -> Certificate:
    """The certificate of linear systems (K, 3, 3) in the metric P (3, 3), slowed down to no less than the fraction `slowest`.

    Raises
    ------
    CertificateError
        Naming the condition that fails and by how much.
    """
    if not (np.all(np.isfinite(matrices)) and np.all(np.isfinite(P))):
        raise CertificateError("stability certificate: the matrices are not finite")
    if not np.allclose(P, P.T, rtol=0.0, atol=1e-9 * max(1.0, float(np.abs(P).max()))):
        raise CertificateError("stability certificate: P is not symmetric")
    least = float(np.linalg.eigvalsh(P)[0])
    if least <= 1e-6:
        raise CertificateError(f"stability certificate: P is not positive definite, least eigenvalue {least:.3g}")
    R, R_inv = roots(P)
    S = R @ matrices @ R_inv
    falls, ways = np.linalg.eigh(-0.5 * (S + S.transpose(0, 2, 1)))
    rate = slowest * float(falls.min())
    if rate < MIN_RATE_HZ:
        raise CertificateError(
            f"stability certificate: A^T P + P A is not negative definite enough, rate {rate:.3g} 1/s is below {MIN_RATE_HZ:g}"
        )
    # | y + h S y |^2 < | y |^2  <=>  h |S y|^2 < -2 y^T S y: in the coordinates where the right side is 2 |z|^2, a norm
    whitened = S @ (ways / np.sqrt(falls)[:, None, :])
    period = 2.0 / float(np.linalg.norm(whitened, ord=2, axis=(1, 2)).max()) ** 2
    if period < MIN_PERIOD_S:
        raise CertificateError(
            f"stability certificate: explicit Euler steps shrink the error up to {period:.3g} s only, below {MIN_PERIOD_S:g} s"
        )
    return Certificate(P, rate, period)
