import math

import numpy as np
import pytest
import scipy

from trundle.errors import InputError
from trundle.evaluation.statistics.paired_tests import bootstrap_means, holm, mcnemar_exact, paired_bootstrap


@pytest.mark.parametrize(("first", "second"), [(0, 0), (0, 7), (3, 3), (5, 19), (400, 460), (1, 0), (900, 2)])
def test_mcnemars_test_equals_that_of_statsmodels(first, second):
    from statsmodels.stats.contingency_tables import mcnemar

    expected = mcnemar([[10, first], [second, 5]], exact=True).pvalue if first + second else 1.0
    assert mcnemar_exact(first, second) == pytest.approx(expected, rel=1e-8)


def test_seven_missions_lost_and_none_won_give_the_p_that_is_known():
    assert mcnemar_exact(0, 7) == pytest.approx(2 / 2**7)


def test_holms_correction_equals_that_of_statsmodels():
    from statsmodels.stats.multitest import multipletests

    ps = [0.01, 0.04, 0.03, 0.005, 0.2, 0.01]
    assert holm(ps) == pytest.approx(multipletests(ps, method="holm")[1])
    assert holm([]) == []
    with_gap = holm([0.01, math.nan, 0.04])
    assert with_gap[::2] == pytest.approx([0.02, 0.04])
    assert math.isnan(with_gap[1])


@pytest.mark.parametrize("clusters", ["one world", "a world for each"])
def test_the_bootstrap_agrees_with_scipys_where_clusters_do_not_matter(clusters):
    rng = np.random.default_rng(3)
    values = rng.gamma(2.0, 1.0, 120) - 1.0
    worlds = np.zeros(120) if clusters == "one world" else np.arange(120)
    mean, interval = paired_bootstrap(values, worlds, seed=1)
    scipys = scipy.stats.bootstrap(
        (values,), np.mean, n_resamples=10_000, method="percentile", rng=2
    ).confidence_interval
    assert mean == pytest.approx(values.mean())
    assert interval == pytest.approx((scipys.low, scipys.high), abs=0.03)


def test_where_worlds_differ_the_interval_is_as_wide_as_that_of_clustered_errors():
    from statsmodels.regression.linear_model import OLS

    rng = np.random.default_rng(4)
    worlds = np.repeat(np.arange(60), 30)
    values = rng.normal(size=60)[worlds] + 0.5 * rng.normal(size=1800)
    _, interval = paired_bootstrap(values, worlds, seed=1)
    fit = OLS(values, np.ones(1800)).fit(cov_type="cluster", cov_kwds={"groups": worlds})
    width = interval.high - interval.low
    assert width == pytest.approx(2 * 1.96 * fit.bse[0], rel=0.1)
    assert width > 3 * (2 * 1.96 * values.std() / math.sqrt(1800))


def test_columns_with_gaps_have_the_means_of_what_they_have():
    values = np.array([[1.0, math.nan], [2.0, 5.0], [3.0, 7.0], [4.0, math.nan]])
    means = bootstrap_means(values.T, np.zeros(4))
    assert [mean.value for mean in means] == [2.5, 6.0]
    assert [mean.n for mean in means] == [4, 2]
    assert means[1].interval == pytest.approx((5.0, 7.0))


def test_the_same_seed_gives_the_same_interval_and_worlds_may_be_named():
    values, worlds = np.arange(40.0), np.array(["a", "b", "c", "d"] * 10)
    assert paired_bootstrap(values, worlds, seed=5) == paired_bootstrap(values, worlds, seed=5)
    assert paired_bootstrap(values, worlds, seed=5) != paired_bootstrap(values, worlds, seed=6)


def test_means_of_nothing_have_no_interval():
    (none,) = bootstrap_means([[]], [])
    assert math.isnan(none.value)
    assert none.n == 0
    (one,) = bootstrap_means([[2.0]], [0])
    assert one.value == 2.0
    assert math.isnan(one.interval.low)


def test_the_bootstraps_p_is_small_where_all_differ_one_way_and_1_where_none_differs():
    differ, same = bootstrap_means([[1.1] * 30, [0.0] * 30], np.zeros(30))
    assert differ.p < 0.001
    assert same.p == 1.0


@pytest.mark.slow
def test_blocks_of_very_many_missions_give_the_interval_of_single_ones():
    rng = np.random.default_rng(0)
    values, worlds = rng.normal(0.1, 1.0, 300_000), rng.integers(3, size=300_000)
    mean, interval = paired_bootstrap(values, np.zeros(300_000))
    assert mean == pytest.approx(values.mean())
    assert interval.high - interval.low == pytest.approx(2 * 1.96 / math.sqrt(300_000), rel=0.06)
    _, of_worlds = paired_bootstrap(values, worlds)
    assert of_worlds.low < mean < of_worlds.high


def test_clusters_of_another_length_are_refused():
    with pytest.raises(InputError, match="a cluster for each"):
        paired_bootstrap([1.0, 2.0], [0])
