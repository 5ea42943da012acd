"""Two settings on the same missions: McNemar's exact test, the bootstrap of paired differences, Holm's correction."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.evaluation.statistics.intervals import CONFIDENCE, Interval
from trundle.geometry import FloatArray
from trundle.values import check_count

RESAMPLES = 10_000
_MOST_DRAWS = 2 * 10**8
"""Of very many missions fewer resamples are drawn: their means vary little."""
_FEWEST_RESAMPLES = 1_000
_DRAWS_AT_ONCE = 2 * 10**6


def mcnemar_exact(only_first: int, only_second: int) -> float:
    """McNemar's exact two-sided p: whether two settings succeed equally often on the same missions.

    It is the binomial test of one half on the missions where the two differ (McNemar, Psychometrika 12, 1947).

    Args:
        only_first: Number of missions where only the first succeeds.
        only_second: Number where only the second does.
    """
    n = check_count("only_first", only_first, 0, 10**9) + check_count("only_second", only_second, 0, 10**9)
    if n == 0:
        return 1.0
    fewer = np.arange(min(only_first, only_second) + 1)
    logs = math.lgamma(n + 1) - _lgamma(fewer + 1) - _lgamma(n - fewer + 1) - n * math.log(2.0)
    return min(1.0, 2.0 * float(np.exp(logs).sum()))


def holm(ps: Sequence[float]) -> list[float]:
    """Holm's adjusted p of several comparisons made at once, in the given order (Scand. J. Statist. 6, 1979).

    A comparison of NaN (there is nothing to tell from) stays NaN and does not count.
    """
    order = sorted((p, place) for place, p in enumerate(ps) if not math.isnan(p))
    adjusted = [math.nan] * len(ps)
    largest = 0.0
    for rank, (p, place) in enumerate(order):
        largest = max(largest, min(1.0, (len(order) - rank) * p))
        adjusted[place] = largest
    return adjusted


@dataclass(frozen=True, slots=True)
class Mean:
    """A mean with what its bootstrap says.

    Attributes:
        value: The mean; NaN without any value.
        interval: Its percentile interval; NaN for fewer than two values.
        p: Two-sided bootstrap p of a mean of zero; NaN for fewer than two values.
        n: Number of values.
    """

    value: float
    interval: Interval
    p: float
    n: int


def paired_bootstrap(
    differences: npt.ArrayLike,
    clusters: npt.ArrayLike,
    *,
    seed: int = 0,
    resamples: int = RESAMPLES,
    confidence: float = CONFIDENCE,
) -> tuple[float, Interval]:
    """Mean of paired differences, and its bootstrap interval clustered by world; see `bootstrap_means`."""
    (mean,) = bootstrap_means(
        np.asarray(differences, dtype=float)[:, None], clusters, seed=seed, resamples=resamples, confidence=confidence
    )
    return mean.value, mean.interval


def bootstrap_means(
    values: npt.ArrayLike,
    clusters: npt.ArrayLike,
    *,
    seed: int = 0,
    resamples: int = RESAMPLES,
    confidence: float = CONFIDENCE,
) -> list[Mean]:
    """Means of columns, with percentile intervals of one bootstrap that all columns share.

    A resample draws as many worlds as there are, with replacement, and in each of them as many of its missions (the
    two-stage bootstrap of Davison and Hinkley, "Bootstrap Methods and their Application", 1997, section 3.8). So
    missions of one world are not taken for independent, and a single world can be used as well. Where there are few
    worlds, the intervals are rather wide than narrow.

    Args:
        values: Shape (N, K); NaN where a column has no value.
        clusters: The world of each row, shape (N,).
        seed: Of the resamples; the same one gives the same intervals.
        resamples: How many; fewer are drawn for more than 20,000 rows.
        confidence: Of the intervals.

    Raises:
        InputError: If the shapes do not fit.
    """
    table = np.asarray(values, dtype=float)
    _, cluster = np.unique(np.asarray(clusters), return_inverse=True)
    if table.ndim != 2 or cluster.shape != table.shape[:1]:
        raise InputError(f"a bootstrap needs a cluster for each of its rows, got {table.shape} and {cluster.shape}")
    resamples = check_count("resamples", resamples, 1, 10**7)
    known = ~np.isnan(table)
    counts = known.sum(axis=0)
    if len(table) == 0:
        return [_no_mean(math.nan, 0) for _ in counts]
    filled = np.where(known, table, 0.0)
    drawn = min(resamples, max(_FEWEST_RESAMPLES, _MOST_DRAWS // len(table)))
    sums, weights = _resample(filled, known, cluster, drawn, np.random.default_rng(seed))
    with np.errstate(invalid="ignore", divide="ignore"):
        means, resampled = filled.sum(axis=0) / counts, sums / weights
    edge = (1.0 - confidence) / 2.0
    results: list[Mean] = []
    for column, n in enumerate(counts):
        found = resampled[~np.isnan(resampled[:, column]), column]
        if n < 2 or len(found) == 0:
            results.append(_no_mean(float(means[column]), int(n)))
            continue
        low, high = np.quantile(found, [edge, 1.0 - edge])
        tail = min(int((found <= 0.0).sum()), int((found >= 0.0).sum()))
        p = min(1.0, 2.0 * (tail + 1) / (len(found) + 1))
        results.append(Mean(float(means[column]), Interval(low, high), p, int(n)))
    return results


def _no_mean(value: float, n: int) -> Mean:
    return Mean(value, Interval(math.nan, math.nan), math.nan, n)


def _resample(
    filled: FloatArray,
    known: npt.NDArray[np.bool_],
    cluster: npt.NDArray[np.intp],
    resamples: int,
    rng: np.random.Generator,
) -> tuple[FloatArray, FloatArray]:
    """Sums of the columns, and how many values they have, in each resample, both of shape (resamples, K)."""
    n, columns = filled.shape
    order = np.argsort(cluster, kind="stable")
    both = np.concatenate([filled[order], known[order].astype(float)], axis=1)
    sizes = np.bincount(cluster)
    starts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    parts: list[FloatArray] = []
    chunk = max(1, _DRAWS_AT_ONCE // n)
    for first in range(0, resamples, chunk):
        count = min(chunk, resamples - first)
        draws = _draw_one_stage(n, count, rng) if len(sizes) in (1, n) else _draw(sizes, starts, count, rng)
        weights = np.bincount(draws, minlength=count * n).reshape(count, n)
        parts.append(weights.astype(float) @ both)
    whole = np.concatenate(parts)
    return whole[:, :columns], whole[:, columns:]


def _draw_one_stage(n: int, count: int, rng: np.random.Generator) -> npt.NDArray[np.int64]:
    """Rows of `count` resamples, as resample * n + row: of one world, or of as many worlds as there are rows."""
    rows = rng.integers(n, size=(count, n))
    return (rows + n * np.arange(count)[:, None]).ravel()


def _draw(
    sizes: npt.NDArray[np.intp], starts: npt.NDArray[np.intp], count: int, rng: np.random.Generator
) -> npt.NDArray[np.int64]:
    """Likewise in two stages: worlds, then missions in each."""
    n, worlds = int(sizes.sum()), len(sizes)
    picked = rng.integers(worlds, size=(count, worlds))
    lengths = sizes[picked].ravel()
    offsets = (starts[picked] + n * np.arange(count)[:, None]).ravel()
    total = int(lengths.sum())
    within = (rng.random(total) * np.repeat(lengths, lengths)).astype(np.int64)
    return np.repeat(offsets, lengths) + within


def _lgamma(values: npt.NDArray[np.int64]) -> FloatArray:
    return np.array([math.lgamma(value) for value in values.tolist()])
