import math

import pytest

from trundle.evaluation.statistics.figures import write_number, write_share


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"), (-0.00001, "0"), (0.00376, "0.0038"), (-0.19, "-0.19"), (9.876, "9.88"), (31.049, "31"),
        (99.95, "100"), (123.44, "123.4"), (12345.6, "12346"), (math.nan, "–"),
    ],
)  # fmt: skip
def test_numbers_have_the_digits_of_a_table(value, text):
    assert write_number(value) == text


@pytest.mark.parametrize(
    ("share", "n", "text"),
    [
        (1.0, 50, "100 %"), (0.965, 200, "96.5 %"), (0.99999, 100_000, "99.99 %"), (0.9996, 500, "99.9 %"),
        (0.0, 3, "0 %"),
    ],
)  # fmt: skip
def test_only_all_of_them_are_100_percent(share, n, text):
    assert write_share(share, n) == text
