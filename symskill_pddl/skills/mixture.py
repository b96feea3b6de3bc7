"""A Gaussian mixture whose weights say which linear system acts where."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np

from symskill_pddl.geometry import Array, frozen


@dataclass(frozen=True, eq=False)
class Mixture:
    """K Gaussians in R^3, kept as what their evaluation takes.

    Attributes
    ----------
    whitening : (3K, 3)
        Stacked inverse Cholesky factors W_k of the covariances.
    offset : (3K,)
        W_k mean_k.
    log_scale : (K,)
        log prior_k + log det W_k.
    """

    whitening: Array
    offset: Array
    log_scale: Array

    def __post_init__(self) -> None:
        for name in ("whitening", "offset", "log_scale"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    @classmethod
    def single(cls) -> Mixture:
        """One component: its weight is 1 everywhere."""
        return cls(np.eye(3), np.zeros(3), np.zeros(1))

    @property
    def size(self) -> int:
        return len(self.log_scale)

    def weights(self, x: Array) -> Array:
        """Weights (..., K) at x (..., 3): positive, finite and of sum 1 however far x is (log-sum-exp)."""
        z = x @ self.whitening.T - self.offset  # (..., 3K)
        z *= z
        logits = self.log_scale - 0.5 * z.reshape(*x.shape[:-1], -1, 3).sum(-1)
        logits -= logits.max(-1, keepdims=True)
        np.exp(logits, out=logits)
        logits /= logits.sum(-1, keepdims=True)
        return logits


def fit_mixture(x: Array, progress: Array, size: int, floor: float, iterations: int = 5) -> Mixture:
    """Expectation maximisation (scikit-learn's) from slices of the path.

    The components start as `size` equal slices of the progress along the demonstrations, so no random start is needed, and the
    result does not depend on a seed.

    Parameters
    ----------
    x : (n, 3)
        Samples.
    progress : (n,)
        Fraction of its way that each sample has behind it, in [0, 1].
    size : int
        Number of components K; no more than there are samples are fitted.
    floor : float
        Standard deviation added to every direction, in the unit of x.
    """
    size = min(size, len(x))
    if size == 1:
        return Mixture.single()
    from sklearn.exceptions import ConvergenceWarning  # slow to import, and only fitting needs it
    from sklearn.mixture import GaussianMixture

    slices = np.minimum((progress * size).astype(int), size - 1)
    share, mean, covariance = _moments(x, np.eye(size)[slices], floor)
    model = GaussianMixture(
        size,
        reg_covar=floor**2,
        max_iter=iterations,
        weights_init=share,
        means_init=mean,
        precisions_init=np.linalg.inv(covariance),
        init_params="random_from_data",  # spares older versions a k-means that the three above would replace
        random_state=0,
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)  # a few steps from the slices are all that is wanted
        model.fit(x)
    W = model.precisions_cholesky_.transpose(0, 2, 1)  # (K, 3, 3), lower triangular
    log_det = np.log(np.diagonal(W, axis1=1, axis2=2)).sum(1)
    return Mixture(W.reshape(-1, 3), (W @ model.means_[:, :, None]).reshape(-1), np.log(model.weights_) + log_det)


def _moments(x: Array, member: Array, floor: float) -> tuple[Array, Array, Array]:
    """Shares (K,), means (K, 3) and covariances (K, 3, 3) of slices, given as memberships (n, K); a slice may be empty."""
    count = member.sum(0) + 1e-6
    mean = member.T @ x / count[:, None]
    centred = x[:, None, :] - mean  # (n, K, 3)
    scatter = (member[:, :, None] * centred).transpose(1, 2, 0) @ centred.transpose(1, 0, 2)
    return count / count.sum(), mean, scatter / count[:, None, None] + floor**2 * np.eye(3)
