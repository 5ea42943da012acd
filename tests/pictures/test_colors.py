from trundle.pictures.colors import speed_color


def test_a_speed_beyond_the_range_has_the_colour_of_its_end():
    assert speed_color(1.3) == speed_color(1.0) != speed_color(0.9)
    assert speed_color(-0.2) == speed_color(0.0) != speed_color(0.1)
