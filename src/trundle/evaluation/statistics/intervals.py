"""Intervals of shares: Wilson's, what a share without any failure is bounded by, and how many more episodes decide."""

from __future__ import annotations

import math
from statistics import NormalDist

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.values import check_count, check_number

CONFIDENCE = 0.95
"""The confidence of every interval, unless another one is asked for."""

_MOST = 10**12


class Interval(tuple[float, float]):
    """The low and the high end of a confidence interval; NaN for both where there is nothing to tell from."""

    __slots__ = ()

    def __new__(cls, low: float, high: float) -> Interval:
        """Make it of its two ends."""
        return super().__new__(cls, (float(low), float(high)))

    def __getnewargs__(self) -> tuple[float, float]:
        return self[0], self[1]

    @property
    def low(self) -> float:
        """The low end."""
        return self[0]

    @property
    def high(self) -> float:
        """The high end."""
        return self[1]

    def holds(self, value: float) -> bool:
        """Return whether a value lies in it, its ends included; never in an interval of NaN."""
        return self[0] <= value <= self[1]


def quantile(confidence: float) -> float:
    """Return how many standard deviations of a normal distribution a two-sided interval reaches to each side.

    Raises:
        InputError: If the confidence is not between 0 and 1.
    """
    if not 0.0 < check_number("confidence", confidence, 0.0, 1.0) < 1.0:
        raise InputError(f"confidence must be between 0 and 1, got {confidence:g}")
    return NormalDist().inv_cdf(0.5 + confidence / 2.0)


def wilson(successes: int, n: int, confidence: float = CONFIDENCE) -> Interval:
    """Return the interval of a share, from a count of successes: Wilson's score interval (JASA 22, 1927).

    Args:
        successes: 0..n.
        n: Number of trials; without any, the share may be anything from 0 to 1.
        confidence: Confidence of the two-sided interval.

    Raises:
        InputError: If the counts are not such counts.
    """
    n = check_count("n", n, 0, _MOST)
    successes = check_count("successes", successes, 0, n)
    return _wilson(float(successes), float(n), quantile(confidence))


def no_failure_bound(n: int, confidence: float = CONFIDENCE) -> float:
    """The largest failure rate that `n` episodes without a failure leave possible: the far end of Wilson's interval."""
    return 1.0 - wilson(n, n, confidence).low


def episodes_to_decide(successes: int, n: int, wanted: float, confidence: float = CONFIDENCE) -> int | None:
    """Return how many more episodes decide whether a share is at least `wanted`, if they go as those so far.

    Returns:
        0 where the interval lies on one side of `wanted` already; None where no number would do, as the share so far
        is `wanted` itself.
    """
    low, high = wilson(successes, n, confidence)
    if low >= wanted or high < wanted:
        return 0
    share = successes / n if n else 1.0
    if share == wanted or (share < wanted and n == 0):
        return None
    z = quantile(confidence)

    def decides(total: int) -> bool:
        ends = _wilson(share * total, float(total), z)
        return ends.low >= wanted or ends.high < wanted

    upper = max(1, n)
    while not decides(upper):
        upper *= 2
        if upper > _MOST:
            return None
    lower = n
    while upper - lower > 1:
        middle = (lower + upper) // 2
        lower, upper = (lower, middle) if decides(middle) else (middle, upper)
    return upper - n


def _wilson(successes: float, n: float, z: float) -> Interval:
    if n == 0.0:
        return Interval(0.0, 1.0)
    share = successes / n
    middle = share + z * z / (2.0 * n)
    half = z * math.sqrt(share * (1.0 - share) / n + z * z / (4.0 * n * n))
    whole = 1.0 + z * z / n
    low = 0.0 if successes == 0.0 else max(0.0, (middle - half) / whole)
    high = 1.0 if successes == n else min(1.0, (middle + half) / whole)
    return Interval(low, high)


def rank_correlation(x: npt.ArrayLike, y: npt.ArrayLike, confidence: float = CONFIDENCE) -> tuple[float, Interval]:
    """Compute Spearman's rank correlation and its interval by Fisher's transformation.

    Its standard error is that of Bonett and Wright, "Sample size requirements for estimating Pearson, Kendall and
    Spearman correlations" (Psychometrika 65, 2000).

    Args:
        x: Numbers, shape (N,); pairs with a NaN are left out.
        y: Numbers, shape (N,).
        confidence: Confidence of the interval.

    Returns:
        The correlation, -1..1, and its interval; NaN where one of the two does not vary, and an interval of -1 to 1 for
        fewer than 5 pairs.

    Raises:
        InputError: If they differ in length.
    """
    first, second = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if first.ndim != 1 or first.shape != second.shape:
        raise InputError(f"a rank correlation needs two rows of one length, got {first.shape} and {second.shape}")
    known = ~(np.isnan(first) | np.isnan(second))
    ranks = mean_ranks(first[known]), mean_ranks(second[known])
    n = int(known.sum())
    if n < 2 or any(np.ptp(rank) == 0.0 for rank in ranks):
        return math.nan, Interval(math.nan, math.nan)
    rho = float(np.clip(np.corrcoef(*ranks)[0, 1], -1.0, 1.0))
    z = quantile(confidence)
    if n < 5:
        return rho, Interval(-1.0, 1.0)
    if abs(rho) > 1.0 - 1e-12:
        return rho, Interval(rho, rho)
    half = z * math.sqrt((1.0 + rho * rho / 2.0) / (n - 3))
    middle = math.atanh(rho)
    return rho, Interval(math.tanh(middle - half), math.tanh(middle + half))


def mean_ranks(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return ranks from 1, shape (N,); equal values share the mean of theirs."""
    _, place, counts = np.unique(values, return_inverse=True, return_counts=True)
    last = np.cumsum(counts)
    return (last - (counts - 1) / 2.0)[place]
