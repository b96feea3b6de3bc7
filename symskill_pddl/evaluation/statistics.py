"""What a number of successes says about a success rate. Standard library only."""

from __future__ import annotations

from math import sqrt
from statistics import NormalDist

from symskill_pddl.errors import InputError


def wilson(successes: int, trials: int, *, confidence: float = 0.95) -> tuple[float, float]:
    """Wilson score interval of a success rate.

    Unlike the normal approximation it stays within [0, 1] and says something sensible at 0 and at all successes.

    Parameters
    ----------
    successes, trials : int
        ``0 <= successes <= trials``, at least one trial.
    confidence : float
        Coverage of the two-sided interval, strictly between 0 and 1.

    Returns
    -------
    (float, float)
        Lower and upper end.

    Raises
    ------
    InputError
        If the counts or the confidence are out of range.

    Notes
    -----
    E. B. Wilson, "Probable inference, the law of succession, and statistical inference", JASA 22 (1927), 209-212.
    """
    if trials < 1 or not 0 <= successes <= trials:
        raise InputError(f"a success rate needs 0 <= successes <= trials and at least one trial, got {successes} of {trials}")
    if not 0 < confidence < 1:
        raise InputError(f"a confidence lies strictly between 0 and 1, got {confidence}")
    z = NormalDist().inv_cdf(0.5 + confidence / 2)
    rate, shrink = successes / trials, 1 + z * z / trials
    centre = (rate + z * z / (2 * trials)) / shrink
    half = z / shrink * sqrt(rate * (1 - rate) / trials + z * z / (4 * trials * trials))
    # exact ends: rounding must not leave 1e-17 where the formula gives 0
    low = 0.0 if successes == 0 else max(0.0, centre - half)
    high = 1.0 if successes == trials else min(1.0, centre + half)
    return low, high


def median(values: list[float]) -> float | None:
    """The middle value, the mean of the two middle ones, or None of nothing."""
    ordered = sorted(values)
    n = len(ordered)
    if n == 0:
        return None
    return ordered[n // 2] if n % 2 else (ordered[n // 2 - 1] + ordered[n // 2]) / 2
