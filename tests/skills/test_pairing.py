import numpy as np
import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.skills.pairing import Pairing, fit_pairing


def along(d: np.ndarray, a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Errors whose sizes are d and a."""
    return d[:, None] * np.array([1.0, 0, 0]), a[:, None] * np.array([0, 0, 1.0])


STEPS = np.linspace(1.0, 0.0, 200)


@pytest.mark.parametrize(
    ("d", "a"),
    [
        (STEPS, 1.2 * STEPS**2),
        (np.minimum(1.0, 2 * STEPS), 1.5 * np.maximum(0.0, 2 * STEPS - 1)),  # turns first, in place, then moves
        (np.maximum(0.0, 2 * STEPS - 1), 1.5 * np.minimum(1.0, 2 * STEPS)),  # moves first, then turns in place
    ],
    ids=["together", "turns first", "moves first"],
)
def test_on_the_demonstrated_curve_nobody_waits(d, a):
    pairing = fit_pairing([along(d, a), along(d, a)], np.eye(3))
    for i in range(0, 200, 10):
        position, rotation = pairing.factors(d[i], a[i])
        assert position > 0.7
        assert rotation > 0.7


def test_who_is_ahead_waits():
    pairing = Pairing(1.0, 1.0, np.zeros(3))
    assert pairing.factors(0.5, 0.5) == (1.0, 1.0)
    assert pairing.factors(0.5, 0.1) == (1.0, 0.1)
    assert pairing.factors(0.5, 1.5) == (0.25, 1.0)
    assert pairing.factors(0.0, 0.0) == (1.0, 1.0)


def test_ends_that_differ_do_not_count():
    d, a = STEPS, 1.2 * STEPS**2
    e_p, e_q = along(d, a)
    off = np.array([0.1, -0.05, 0.02])
    one, two = fit_pairing([(e_p, e_q)], np.eye(3)), fit_pairing([(e_p, e_q + STEPS[::-1, None] ** 2 * off)], np.eye(3))
    assert np.abs(one.difference - two.difference).max() < 0.05


def test_no_path_means_no_rotation_waits():
    for e_p, e_q in (along(0 * STEPS, STEPS), along(STEPS, 0 * STEPS)):
        pairing = fit_pairing([(e_p, e_q)], np.eye(3))
        assert pairing.factors(0.0, 1.0)[1] == 1.0
        assert pairing.factors(0.3, 0.1)[1] == 1.0


@pytest.mark.parametrize(
    "bad", [(0.0, 1.0, np.zeros(3)), (1.0, 0.0, np.zeros(3)), (1.0, 1.0, np.zeros(1)), (1.0, 1.0, np.array([0.0, np.nan]))]
)
def test_numbers_that_make_no_curve_are_refused(bad):
    with pytest.raises(InputError, match="a pairing needs"):
        Pairing(*bad)
