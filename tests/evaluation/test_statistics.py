import pytest
from hypothesis import given
from hypothesis import strategies as st

from symskill_pddl.errors import InputError
from symskill_pddl.evaluation.statistics import mcnemar, median, paired_difference, wilson


def test_wilson_agrees_with_published_values() -> None:
    # Newcombe 1998, table I: method 3 (score), 81 of 263 and 15 of 148, 0 of 20, 1 of 29
    assert wilson(81, 263) == pytest.approx((0.2553, 0.3662), abs=5e-5)
    assert wilson(15, 148) == pytest.approx((0.0624, 0.1605), abs=5e-5)
    assert wilson(0, 20) == pytest.approx((0.0, 0.1611), abs=5e-5)
    assert wilson(1, 29) == pytest.approx((0.0061, 0.1718), abs=5e-5)


@given(st.integers(1, 500).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_wilson_holds_the_rate_and_is_symmetric(counts: tuple[int, int]) -> None:
    k, n = counts
    low, high = wilson(k, n)
    assert 0.0 <= low <= k / n <= high <= 1.0
    assert high - low > 0
    mirrored = wilson(n - k, n)
    assert (1 - mirrored[1], 1 - mirrored[0]) == pytest.approx((low, high))


def test_wilson_narrows_with_trials_and_widens_with_confidence() -> None:
    def width(interval: tuple[float, float]) -> float:
        return interval[1] - interval[0]

    assert width(wilson(80, 100)) < width(wilson(8, 10))
    assert width(wilson(8, 10, confidence=0.99)) > width(wilson(8, 10))


@pytest.mark.parametrize(("k", "n"), [(0, 0), (-1, 3), (4, 3)])
def test_impossible_counts_are_refused(k: int, n: int) -> None:
    with pytest.raises(InputError, match="successes"):
        wilson(k, n)


@pytest.mark.parametrize("confidence", [0.0, 1.0, 95.0])
def test_impossible_confidence_is_refused(confidence: float) -> None:
    with pytest.raises(InputError, match="confidence"):
        wilson(1, 2, confidence=confidence)


def test_median() -> None:
    assert median([]) is None
    assert median([3.0]) == 3.0
    assert median([4.0, 1.0, 3.0]) == 3.0
    assert median([4.0, 1.0, 3.0, 2.0]) == 2.5


def test_paired_differences_are_newcombes() -> None:
    # the first two rows of the examples in Newcombe's paper, method 10
    assert paired_difference(36, 12, 2, 0) == pytest.approx((0.0569, 0.3404), abs=5e-5)
    assert paired_difference(20, 12, 2, 16) == pytest.approx((0.0562, 0.3292), abs=5e-5)


@given(st.integers(0, 30), st.integers(0, 30), st.integers(0, 30), st.integers(1, 30))
def test_a_paired_difference_lies_in_its_interval(a: int, b: int, c: int, d: int) -> None:
    low, high = paired_difference(a, b, c, d)
    assert -1.0 - 1e-12 <= low <= (b - c) / (a + b + c + d) <= high <= 1.0 + 1e-12
    assert paired_difference(a, c, b, d) == pytest.approx((-high, -low))


def test_mcnemar_is_exact() -> None:
    assert mcnemar(0, 0) == 1.0
    assert mcnemar(1, 0) == 1.0
    assert mcnemar(0, 9) == mcnemar(9, 0) == 2 / 2**9
    assert mcnemar(12, 2) == pytest.approx(0.012939453125)


def test_counts_of_pairs_cannot_be_negative() -> None:
    with pytest.raises(InputError, match="negative"):
        mcnemar(-1, 2)
    with pytest.raises(InputError, match="negative"):
        paired_difference(1, -1, 2, 0)
    with pytest.raises(InputError, match="at least one trial"):
        paired_difference(0, 0, 0, 0)
