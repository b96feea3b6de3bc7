"""What makes a field stable, and the certificate that is checked after the fit.

With P fixed and y = P^(1/2) x, every linear system reads y' = S_k y, and one condition on each S_k carries all that is asked for:

    || I + h S_k ||_2 <= rho,   rho^2 = 1 - 2 alpha h,   h the control period.

It is the discrete-time condition: an explicit Euler step shortens y by the factor rho, for any mixture weights and any speed
cap, because the norm is convex. And it implies the continuous one, S_k + S_k^T <= -2 alpha I, that is A_k^T P + P A_k <= -2
alpha P.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symskill_pddl.errors import CertificateError
from symskill_pddl.geometry import Array, frozen


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
