import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import MultiPoint

from trundle.errors import WorldError
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.sim.sections import Disc, Polygon, convex_hull, outline_segments, slab_section

TETRAHEDRON = Mesh(
    np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]), np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
)


def area(section):
    x, y = section.corners.T
    return (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2.0


def test_an_upright_box_is_its_rectangle():
    section = slab_section(Solid("b", Box((2.0, 1.0, 1.0)), Pose3D.planar(3.0, 4.0, 0.5, math.pi / 2)), 0.1, 0.6)
    assert area(section) == pytest.approx(2.0)
    assert section.corners.min(axis=0) == pytest.approx((2.5, 3.0))


def test_what_lies_above_or_below_is_not_there():
    shelf = Solid("s", Box((1.0, 1.0, 0.1)), Pose3D((0.0, 0.0, 1.0)))
    assert slab_section(shelf, 0.1, 0.6) is None
    assert slab_section(Solid("c", Cylinder(0.2, 0.1), Pose3D((0.0, 0.0, 1.0))), 0.1, 0.6) is None
    assert slab_section(Solid("c", Sphere(0.2), Pose3D((0.0, 0.0, 1.0))), 0.1, 0.6) is None


def test_a_sphere_is_widest_where_the_slab_comes_nearest():
    ball = Solid("s", Sphere(0.5), Pose3D((1.0, 2.0, 1.0)))
    assert slab_section(ball, 0.1, 1.4) == Disc(1.0, 2.0, 0.5)
    assert slab_section(ball, 0.1, 0.7).radius == pytest.approx(0.4)


def test_a_lying_cylinder_is_a_rectangle():
    quarter = math.sqrt(0.5)
    roll = Solid("r", Cylinder(0.3, 2.0), Pose3D((0.0, 0.0, 0.3), (quarter, 0.0, quarter, 0.0)))
    assert area(slab_section(roll, 0.1, 0.62)) == pytest.approx(2.0 * 0.6, rel=1e-3)


def test_a_box_on_its_corner_is_cut_where_the_slab_ends():
    tilted = Solid(
        "b", Box((1.0, 1.0, 1.0)), Pose3D((0.0, 0.0, 0.0), (math.cos(math.pi / 8), math.sin(math.pi / 8), 0, 0))
    )
    # Turned by 45° about x it is a roof with slopes of 45°: at height h it is 2 (√½ − h) wide.
    assert area(slab_section(tilted, 0.2, 2.0)) == pytest.approx(2.0 * (math.sqrt(0.5) - 0.2))


def test_a_mesh_is_cut_as_its_hull():
    section = slab_section(Solid("t", TETRAHEDRON), 0.5, 2.0)
    assert isinstance(section, Polygon)
    assert area(section) == pytest.approx(0.125)


def test_a_meshs_outline_is_that_of_its_triangles():
    segments = outline_segments(Solid("t", TETRAHEDRON), 0.5)
    lengths = np.hypot(segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1])
    assert sorted(lengths) == pytest.approx([0.5, 0.5, math.sqrt(0.5)])


def test_blocked_cells_have_no_convex_section():
    with pytest.raises(WorldError, match="no convex section"):
        slab_section(Solid("m", OccupancyCells(np.ones((2, 2)), 0.05, 1.0)), 0.1, 0.6)


@given(st.lists(st.tuples(st.integers(-5, 5), st.integers(-5, 5)), min_size=3, max_size=30))
def test_the_hull_is_shapelys(points):
    hull = convex_hull(np.array(points, dtype=float))
    expected = MultiPoint(points).convex_hull
    if len(hull) >= 3:
        assert area(Polygon(hull)) == pytest.approx(expected.area)
        assert len(hull) == len(expected.exterior.coords) - 1
    else:
        assert expected.area == 0.0
