import numpy as np
import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.skills.pairing import Pairing, fit_pairing


def test_demonstrated_relation_is_found():
    d = np.linspace(1.0, 0.0, 100)
    pairing = fit_pairing([d, d], [1.2 * d**2, 1.2 * d**2])
    knots = np.linspace(0, 1, len(pairing.angles))
    assert np.allclose(pairing.angles, 1.2 * knots**2, atol=0.01)


def test_who_is_ahead_waits():
    pairing = Pairing(1.0, np.array([0.0, 1.0]))
    assert pairing.factors_at(0.5, 0.5) == (1.0, 1.0)
    assert pairing.factors_at(0.5, 0.1) == (1.0, 0.0)
    assert pairing.factors_at(0.5, 1.5) == (0.25, 1.0)
    assert pairing.factors_at(0.0, 0.0) == (1.0, 1.0)


def test_one_and_many_agree():
    pairing = Pairing(0.7, np.array([0.0, 0.1, 0.5, 0.5]))
    rng = np.random.default_rng(0)
    d, a = rng.uniform(0, 1, 50), rng.uniform(0, 1, 50)
    many = np.stack(pairing.factors(d, a), 1)
    assert np.allclose(many, [pairing.factors_at(float(x), float(y)) for x, y in zip(d, a, strict=True)], atol=1e-12)


def test_no_path_means_no_rotation_waits():
    pairing = fit_pairing([np.zeros(10)], [np.linspace(1, 0, 10)])
    assert pairing.factors_at(0.0, 1.0)[1] == 1.0
    assert pairing.factors_at(0.3, 0.1)[1] == 1.0


def test_falling_angles_are_refused():
    with pytest.raises(InputError, match="do not fall"):
        Pairing(1.0, np.array([1.0, 0.0]))
