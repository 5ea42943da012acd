import math

import numpy as np
import pytest
import scipy

from trundle.errors import InputError
from trundle.evaluation.statistics.intervals import mean_ranks, rank_correlation


@pytest.mark.parametrize("seed", range(5))
def test_it_is_spearmans_with_ties_too(seed):
    rng = np.random.default_rng(seed)
    x, y = rng.integers(0, 6, 80).astype(float), rng.normal(size=80)
    y += 0.4 * x
    assert rank_correlation(x, y)[0] == pytest.approx(scipy.stats.spearmanr(x, y).statistic, abs=1e-12)
    assert mean_ranks(x) == pytest.approx(scipy.stats.rankdata(x))


def test_the_interval_covers_the_true_correlation_as_often_as_it_says():
    rng = np.random.default_rng(1)
    true = 6.0 / math.pi * math.asin(0.6 / 2.0)  # Spearman's of a normal pair with a correlation of 0.6
    covered = 0
    for _ in range(400):
        x = rng.normal(size=60)
        y = 0.6 * x + 0.8 * rng.normal(size=60)
        covered += rank_correlation(x, y)[1].holds(true)
    assert 0.92 <= covered / 400 <= 0.98


def test_pairs_with_a_gap_are_left_out():
    x, y = np.array([1.0, 2.0, math.nan, 4.0, 5.0, 6.0]), np.array([1.0, 3.0, 9.0, math.nan, 4.0, 5.0])
    assert rank_correlation(x, y)[0] == pytest.approx(1.0)


def test_what_does_not_vary_has_no_correlation_and_few_pairs_say_nothing():
    assert math.isnan(rank_correlation([1.0, 1.0, 1.0], [1.0, 2.0, 3.0])[0])
    assert math.isnan(rank_correlation([], [])[0])
    assert rank_correlation([1.0, 2.0, 3.0], [1.0, 3.0, 2.0])[1] == (-1.0, 1.0)


def test_rows_of_two_lengths_are_refused():
    with pytest.raises(InputError, match="two rows of one length"):
        rank_correlation([1.0, 2.0], [1.0])
