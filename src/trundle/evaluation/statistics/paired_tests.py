"""Two settings on the same missions: McNemar's exact test, the bootstrap of paired differences, Holm's correction."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.evaluation.statistics.intervals import CONFIDENCE, Interval
from trundle.geometry import FloatArray
from trundle.values import check_count

RESAMPLES = 10_000
_MOST_UNITS = 10_000
"""More missions than this are taken together in blocks, each of one world; the means of blocks vary as theirs do."""
_DRAWS_AT_ONCE = 10**6


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
    """Return the mean of paired differences, and its bootstrap interval clustered by world; see `bootstrap_means`."""
    (mean,) = bootstrap_means([differences], clusters, seed=seed, resamples=resamples, confidence=confidence)
    return mean.value, mean.interval


def bootstrap_means(
    columns: Iterable[npt.ArrayLike],
    clusters: npt.ArrayLike,
    *,
    seed: int = 0,
    resamples: int = RESAMPLES,
    confidence: float = CONFIDENCE,
) -> list[Mean]:
    """Return means of columns, with percentile intervals of one bootstrap that all columns share.

    A resample draws as many worlds as there are, with replacement, and in each of them as many of its missions (the
    two-stage bootstrap of Davison and Hinkley, "Bootstrap Methods and their Application", 1997, section 3.8). So
    missions of one world are not treated as independent, and a single world can be used as well. Where there are few
    worlds, the intervals are rather wide than narrow.

    Args:
        columns: Each of shape (N,), used once and one after the other; NaN where a column has no value.
        clusters: The world of each row, shape (N,).
        seed: Seed of the resamples; the same one gives the same intervals.
        resamples: How many.
        confidence: Confidence of the intervals.

    Raises:
        InputError: If the lengths differ.
    """
    unit, sizes = _make_units(np.asarray(clusters))
    resamples = check_count("resamples", resamples, 1, 10**7)
    sums: list[FloatArray] = []
    counts: list[FloatArray] = []
    for column in columns:
        values = np.asarray(column, dtype=float)
        if values.shape != unit.shape:
            raise InputError(f"a bootstrap needs a cluster for each of its rows, got {values.shape} and {unit.shape}")
        known = ~np.isnan(values)
        sums.append(np.bincount(unit[known], values[known], minlength=int(sizes.sum())).astype(float))
        counts.append(np.bincount(unit[known], minlength=int(sizes.sum())).astype(float))
    if len(unit) == 0 or not sums:
        return [_no_mean(math.nan, 0) for _ in sums]
    drawn = _resample(np.stack([*sums, *counts], axis=1), sizes, resamples, np.random.default_rng(seed))
    results: list[Mean] = []
    for place, (total, count) in enumerate(zip(sums, counts, strict=True)):
        n = round(float(count.sum()))
        value = float(total.sum()) / n if n else math.nan
        with np.errstate(invalid="ignore", divide="ignore"):
            means = drawn[:, place] / drawn[:, len(sums) + place]
        results.append(_summarise(value, means[~np.isnan(means)], n, confidence))
    return results


def _summarise(value: float, means: FloatArray, n: int, confidence: float) -> Mean:
    if n < 2 or len(means) == 0:
        return _no_mean(value, n)
    edge = (1.0 - confidence) / 2.0
    low, high = np.quantile(means, [edge, 1.0 - edge])
    tail = min(int((means <= 0.0).sum()), int((means >= 0.0).sum()))
    return Mean(value, Interval(low, high), min(1.0, 2.0 * (tail + 1) / (len(means) + 1)), n)


def _no_mean(value: float, n: int) -> Mean:
    return Mean(value, Interval(math.nan, math.nan), math.nan, n)


def _make_units(clusters: npt.NDArray[Any]) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Return what is drawn: the unit of each row, numbered world by world, and how many units each world has.

    A unit is a row, or of very many rows a block of them.
    """
    _, cluster = np.unique(clusters, return_inverse=True)
    rows = np.bincount(cluster) if len(cluster) else np.zeros(0, dtype=np.intp)
    block = max(1, -(-len(cluster) // _MOST_UNITS))
    sizes = -(-rows // block)
    order = np.argsort(cluster, kind="stable")
    within = np.arange(len(cluster)) - np.repeat(np.cumsum(rows) - rows, rows)
    unit = np.empty(len(cluster), dtype=np.intp)
    unit[order] = np.repeat(np.cumsum(sizes) - sizes, rows) + within // block
    return unit, sizes


def _resample(table: FloatArray, sizes: npt.NDArray[np.intp], resamples: int, rng: np.random.Generator) -> FloatArray:
    """Return sums of the columns of `table`, shape (units, K), in each resample, shape (resamples, K)."""
    n = len(table)
    starts = np.cumsum(sizes) - sizes
    parts: list[FloatArray] = []
    chunk = max(1, _DRAWS_AT_ONCE // n)
    for first in range(0, resamples, chunk):
        count = min(chunk, resamples - first)
        draws = _draw_one_stage(n, count, rng) if len(sizes) in (1, n) else _draw(sizes, starts, count, rng)
        weights = np.bincount(draws, minlength=count * n).reshape(count, n)
        parts.append(weights.astype(float) @ table)
    return np.concatenate(parts)


def _draw_one_stage(n: int, count: int, rng: np.random.Generator) -> npt.NDArray[np.int64]:
    """Return rows of `count` resamples, as resample * n + row: of one world, or of as many worlds as there are rows."""
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
