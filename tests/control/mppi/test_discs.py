import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import Point, Polygon
from shapely.ops import unary_union

from trundle.control.mppi.fields import MOST_DISCS, cover_with_discs
from trundle.geometry import Footprint
from trundle.robots import Robot


@pytest.mark.parametrize(("name", "count"), [("nova_carter", 3), ("jackal", 2)])
def test_the_robots_of_the_catalogue_need_few_discs(name, count):
    assert len(cover_with_discs(Robot.load(name).planar)) == count


def test_a_round_robot_is_one_disc():
    angles = np.linspace(0.0, math.tau, 24, endpoint=False)
    discs = cover_with_discs(Footprint(0.2 * np.column_stack([np.cos(angles), np.sin(angles)])))
    assert discs == pytest.approx(np.array([[0.0, 0.2]]), abs=1e-3)


@given(
    st.lists(st.floats(0.0, math.tau), min_size=3, max_size=9, unique=True),
    st.floats(0.05, 1.0),
    st.floats(0.2, 5.0),
    st.floats(0.0, 0.1),
)
def test_discs_cover_every_outline(angles, size, aspect, padding):
    corners = size * np.array([(aspect * math.cos(angle), math.sin(angle)) for angle in angles])
    hull = Polygon(corners).convex_hull
    if hull.area < 1e-4 * size or hull.geom_type != "Polygon":
        return
    centre = hull.centroid
    outline = np.array(hull.exterior.coords)[:-1] - (centre.x, centre.y)
    try:
        footprint = Footprint(outline)
    except ValueError:  # a corner on a straight edge
        return
    discs = cover_with_discs(footprint, padding)
    assert 1 <= len(discs) <= MOST_DISCS
    covered = unary_union([Point(x, 0.0).buffer(radius + 1e-6, 256) for x, radius in discs])
    padded = Polygon(footprint.padded(padding).outline) if padding else Polygon(footprint.outline)
    assert padded.difference(covered.buffer(1e-4 * max(1.0, discs[:, 1].max()))).area < 1e-6


def test_padding_widens_them():
    planar = Robot.load("nova_carter").planar
    assert cover_with_discs(planar, 0.05)[:, 1].max() > cover_with_discs(planar)[:, 1].max() + 0.04
