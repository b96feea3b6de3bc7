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
