"""What a number of successes says about a success rate. Standard library only."""

from __future__ import annotations

from math import comb, sqrt
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


def mcnemar(only_first: int, only_second: int) -> float:
    """Exact two-sided p-value of McNemar's test: chance that pairs that differ split at least as unevenly, were both alike.

    Parameters
    ----------
    only_first, only_second : int
        Pairs in which only the one or only the other succeeded.

    Raises
    ------
    InputError
        A negative count.
    """
    if min(only_first, only_second) < 0:
        raise InputError(f"counts of pairs cannot be negative, got {only_first} and {only_second}")
    n = only_first + only_second
    tail = sum(comb(n, k) for k in range(min(only_first, only_second) + 1))
    return min(1.0, tail / 2 ** (n - 1)) if n else 1.0


def paired_difference(
    both: int, only_first: int, only_second: int, neither: int, *, confidence: float = 0.95
) -> tuple[float, float]:
    """Interval of the difference (first minus second) of two success rates over the same trials.

    Newcombe's method 10: Wilson's intervals of the two rates, put together with the correlation of the pairs.

    Parameters
    ----------
    both, only_first, only_second, neither : int
        How many pairs succeeded in which way.

    Raises
    ------
    InputError
        A negative count, no pair, or a confidence out of range.

    Notes
    -----
    R. G. Newcombe, "Improved confidence intervals for the difference between binomial proportions based on paired data",
    Statistics in Medicine 17 (1998), 2635-2650.
    """
    a, b, c, d = both, only_first, only_second, neither
    if min(a, b, c, d) < 0:
        raise InputError(f"counts of pairs cannot be negative, got {(a, b, c, d)}")
    n = a + b + c + d
    (low1, high1), (low2, high2) = (wilson(k, n, confidence=confidence) for k in (a + b, a + c))
    p1, p2 = (a + b) / n, (a + c) / n
    spread = (a + b) * (c + d) * (a + c) * (b + d)
    cross = float(a * d - b * c)
    if cross > 0.0:  # continuity correction
        cross = max(cross - n / 2, 0.0)
    phi = cross / sqrt(spread) if spread else 0.0
    down, up = p1 - low1, high1 - p1
    other_down, other_up = p2 - low2, high2 - p2
    delta = sqrt(max(0.0, down**2 - 2 * phi * down * other_up + other_up**2))
    epsilon = sqrt(max(0.0, up**2 - 2 * phi * up * other_down + other_down**2))
    return p1 - p2 - delta, p1 - p2 + epsilon
