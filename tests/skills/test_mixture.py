import numpy as np

from symskill_pddl.skills.mixture import Mixture, fit_mixture


def curve(n: int = 200) -> tuple[np.ndarray, np.ndarray]:
    u = np.linspace(0, 1, n)
    return np.stack([np.cos(2 * u), np.sin(2 * u), 0.1 * u], 1), u


def test_weights_sum_to_one_near_and_far():
    x, u = curve()
    mixture = fit_mixture(x, u, 5, 0.05)
    for scale in (1.0, 1e3, 1e6):
        w = mixture.weights(scale * x)
        assert np.all(np.isfinite(w))
        assert np.all(w >= 0)
        assert np.allclose(w.sum(1), 1.0, atol=1e-12)


def test_components_follow_the_way():
    x, u = curve()
    owner = fit_mixture(x, u, 4, 0.05).weights(x).argmax(1)
    assert set(owner) == {0, 1, 2, 3}
    assert np.all(np.diff(owner) >= 0)


def test_collinear_and_repeated_samples():
    x = np.zeros((60, 3))
    x[:, 0] = np.repeat(np.linspace(0, 1, 20), 3)
    mixture = fit_mixture(x, np.linspace(0, 1, 60), 3, 0.05)
    assert np.all(np.isfinite(mixture.whitening))
    assert np.all(np.isfinite(fit_mixture(np.zeros((10, 3)), np.linspace(0, 1, 10), 3, 0.05).weights(np.ones((1, 3)))))


def test_single_is_one_everywhere():
    assert np.array_equal(Mixture.single().weights(np.array([[0.0, 0, 0], [1e9, 0, 0]])), np.ones((2, 1)))


def test_one_and_many_points_agree():
    x, u = curve()
    mixture = fit_mixture(x, u, 3, 0.05)
    assert np.allclose(mixture.weights(x)[7], mixture.weights(x[7]), atol=1e-14)


def test_a_fit_is_repeatable():
    x, u = curve()
    a, b = fit_mixture(x, u, 4, 0.05), fit_mixture(x, u, 4, 0.05)
    assert np.array_equal(a.whitening, b.whitening)
    assert np.array_equal(a.log_scale, b.log_scale)


def test_weights_are_the_shares_of_separate_clouds():
    # two clouds of 30 and 90 samples with known means and spreads: near each the weight is its own
    rng = np.random.default_rng(0)
    x = np.concatenate([rng.normal(0.0, 0.02, (30, 3)), 1.0 + rng.normal(0.0, 0.02, (90, 3))])
    mixture = fit_mixture(x, np.linspace(0, 1, 120), 2, 0.05)
    assert np.allclose(mixture.weights(x)[:30, 0], 1.0)
    assert np.allclose(mixture.weights(x)[30:, 1], 1.0)
    # floor and spread add: the covariance of each is about (0.05^2 + 0.02^2) I
    W = mixture.whitening.reshape(2, 3, 3)
    for covariance in np.linalg.inv(W.transpose(0, 2, 1) @ W):
        assert np.allclose(covariance, (0.05**2 + 0.02**2) * np.eye(3), atol=3e-4)
    # the logits hold the shares
    log_prior = mixture.log_scale - np.log(np.diagonal(W, axis1=1, axis2=2)).sum(1)
    assert np.allclose(np.exp(log_prior), [0.25, 0.75], atol=1e-3)


def test_fewer_samples_than_components_and_empty_slices():
    x = np.array([[0.0, 0, 0], [1.0, 0, 0]])
    assert fit_mixture(x, np.array([0.0, 1.0]), 5, 0.05).size == 2
    assert fit_mixture(x[:1], np.array([0.0]), 5, 0.05).size == 1
    x, u = curve(40)
    early = fit_mixture(x, 0.4 * u, 4, 0.05)  # no sample in the last two slices
    assert np.all(np.isfinite(early.log_scale))
    assert np.allclose(early.weights(x).sum(1), 1.0)
