"""Rank correlation with its interval: how strongly a figure goes with what was varied."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.evaluation.statistics.intervals import CONFIDENCE, Interval, quantile


def rank_correlation(x: npt.ArrayLike, y: npt.ArrayLike, confidence: float = CONFIDENCE) -> tuple[float, Interval]:
    """Spearman's rank correlation and its interval by Fisher's transformation.

    Its standard error is that of Bonett and Wright, "Sample size requirements for estimating Pearson, Kendall and
    Spearman correlations" (Psychometrika 65, 2000).

    Args:
        x: Numbers, shape (N,); pairs with a NaN are left out.
        y: Likewise.
        confidence: Of the interval.

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
    """Ranks from 1, shape (N,); equal values share the mean of theirs."""
    _, place, counts = np.unique(values, return_inverse=True, return_counts=True)
    last = np.cumsum(counts)
    return (last - (counts - 1) / 2.0)[place]
