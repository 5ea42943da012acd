import math

import pytest

from trundle.geometry.angles import is_in_degrees, parse_angle


@pytest.mark.parametrize(
    ("text", "angle"),
    [
        ("1.57", 1.57),
        ("90deg", math.pi / 2.0),
        ("-90 deg", -math.pi / 2.0),
        ("180°", math.pi),
        ("1.5rad", 1.5),
        ("1e1deg", math.radians(10.0)),
        (".5", 0.5),
    ],
)
def test_angles_are_radians_unless_they_have_another_unit(text, angle):
    assert parse_angle(text) == pytest.approx(angle, abs=1e-12)


@pytest.mark.parametrize("text", ["", "north", "deg", "90degrees", "nan", "infdeg", "1e999deg", "90 grad"])
def test_what_is_no_angle_is_refused(text):
    with pytest.raises(ValueError, match=r".*"):
        parse_angle(text)


def test_more_than_a_whole_turn_is_in_degrees():
    assert not is_in_degrees(math.tau)
    assert not is_in_degrees(-math.tau)
    assert is_in_degrees(7.0)
    assert is_in_degrees(-90.0)
