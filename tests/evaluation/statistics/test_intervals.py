import math
import pickle

import pytest
import scipy

from trundle.errors import InputError
from trundle.evaluation.statistics.intervals import Interval, episodes_to_decide, no_failure_bound, wilson


@pytest.mark.parametrize(
    ("successes", "n"), [(0, 1), (1, 1), (0, 7), (3, 7), (193, 200), (381, 381), (99_000, 100_000)]
)
@pytest.mark.parametrize("confidence", [0.9, 0.95, 0.99])
def test_wilsons_interval_equals_that_of_statsmodels_and_scipy(successes, n, confidence):
    from statsmodels.stats.proportion import proportion_confint

    found = wilson(successes, n, confidence)
    assert found == pytest.approx(proportion_confint(successes, n, 1.0 - confidence, method="wilson"), abs=1e-12)
    scipys = scipy.stats.binomtest(successes, n).proportion_ci(confidence, method="wilson")
    assert found == pytest.approx((scipys.low, scipys.high), abs=1e-12)


def test_without_episodes_the_share_may_be_anything():
    assert wilson(0, 0) == (0.0, 1.0)


def test_the_interval_ends_at_exactly_0_and_1_where_all_or_none_succeed():
    assert wilson(0, 50).low == 0.0
    assert wilson(50, 50).high == 1.0


def test_381_episodes_without_a_failure_bound_the_failure_rate_to_1_percent():
    assert no_failure_bound(381) <= 0.01 < no_failure_bound(380)


@pytest.mark.parametrize("counts", [(-1, 5), (6, 5), (1.5, 5), (1, True)])
def test_counts_that_cannot_be_are_refused(counts):
    with pytest.raises(InputError, match="must be an integer"):
        wilson(*counts)


@pytest.mark.parametrize("confidence", [0.0, 1.0, math.nan, "x"])
def test_a_confidence_that_is_none_is_refused(confidence):
    with pytest.raises(InputError, match="confidence must be"):
        wilson(1, 2, confidence)


@pytest.mark.parametrize(
    ("successes", "n", "wanted"), [(100, 100, 0.99), (95, 100, 0.9), (70, 100, 0.75), (0, 0, 0.99)]
)
def test_the_episodes_that_decide_are_the_fewest_that_do(successes, n, wanted):
    more = episodes_to_decide(successes, n, wanted)
    share = successes / n if n else 1.0
    for total, decided in ((n + more, True), (n + more - 1, False)):
        z = scipy.stats.norm.ppf(0.975)
        middle, half = share + z * z / (2 * total), z * math.sqrt(share * (1 - share) / total + z * z / 4 / total**2)
        low, high = (middle - half) / (1 + z * z / total), (middle + half) / (1 + z * z / total)
        assert (low >= wanted or high < wanted) == decided


def test_nothing_more_is_needed_where_the_interval_decides_and_no_number_is_enough_on_the_bound():
    assert episodes_to_decide(500, 500, 0.99) == 0
    assert episodes_to_decide(10, 500, 0.99) == 0
    assert episodes_to_decide(99, 100, 0.99) is None


def test_an_interval_is_copied_and_says_what_it_holds():
    interval = Interval(0.1, 0.4)
    assert pickle.loads(pickle.dumps(interval)) == interval
    assert interval.holds(0.1)
    assert not interval.holds(0.5)
    assert not Interval(math.nan, math.nan).holds(0.0)
