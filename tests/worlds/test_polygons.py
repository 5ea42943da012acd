import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trundle.geometry import Pose3D
from trundle.worlds.tessellate import convex_hull, triangulate


def area(points, faces):
    a, b, c = np.moveaxis(points[faces], 1, 0)
    return np.cross(b - a, c - a).sum(axis=0) / 2.0


def doubled_area(points, faces):
    a, b, c = np.moveaxis(points[faces], 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()


TURNS = [(1, 0, 0, 0), (0.5, 0.5, 0.5, 0.5), (0.5, -0.5, 0.5, 0.5), (0, 1, 0, 0), (0.3, 0.4, -0.2, 0.8)]

SHAPES = {
    "L": [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)],
    "dart": [(0, 0), (2, 1), (0, 2), (0.5, 1)],
    "dart from its notch": [(0.5, 1), (0, 0), (2, 1), (0, 2)],
    "comb": [(0, 0), (5, 0), (5, 2), (4, 2), (4, 1), (3, 1), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)],
    "slit to a hole": [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)],
    "octagon": [(np.cos(a), np.sin(a)) for a in np.arange(8) * np.pi / 4],
    "straight corner": [(0, 0), (1, 0), (2, 0), (2, 1), (0, 1)],
}


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("backwards", [False, True])
def test_a_polygon_is_covered_once_whichever_way_it_faces(name, backwards, turn):
    flat = np.array(SHAPES[name], dtype=float)[:: -1 if backwards else 1]
    points = Pose3D(quaternion=turn).transform_points(np.column_stack([flat, np.zeros(len(flat))]))
    x, y = flat.T
    expected = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2.0
    faces, owners = triangulate(points, np.array([len(points)]), np.arange(len(points)))
    assert set(owners) == {0}
    np.testing.assert_allclose(area(points, faces), expected * Pose3D(quaternion=turn).rotation()[:, 2], atol=1e-12)
    assert doubled_area(points, faces) == pytest.approx(2.0 * abs(expected))


@given(st.integers(0, 2**32 - 1), st.integers(4, 200), st.sampled_from(TURNS), st.booleans())
def test_a_star_of_random_rays_is_covered_once(seed, corners, turn, backwards):
    generator = np.random.default_rng(seed)
    angles = (np.arange(corners) + generator.uniform(0.05, 0.95, corners)) * 2.0 * np.pi / corners
    x, y = generator.uniform(0.1, 1.0, corners) * np.array([np.cos(angles), np.sin(angles)])
    if backwards:
        x, y = x[::-1], y[::-1]
    expected = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2.0
    points = Pose3D((100.0, -50.0, 3.0), turn).transform_points(np.column_stack([x, y, np.zeros(corners)]))
    faces, _ = triangulate(points, np.array([corners]), np.arange(corners))
    assert doubled_area(points, faces) == pytest.approx(2.0 * abs(expected))
    np.testing.assert_allclose(area(points, faces), expected * Pose3D(quaternion=turn).rotation()[:, 2], atol=1e-9)


def test_a_polygon_of_ten_thousand_notches_is_covered_once():
    corners = 20_000
    angles = np.arange(corners) * 2.0 * np.pi / corners
    radius = np.where(np.arange(corners) % 2, 1.0, 0.5)
    x, y = radius * np.cos(angles), radius * np.sin(angles)
    points = np.column_stack([x, y, np.zeros(corners)])
    faces, _ = triangulate(points, np.array([corners]), np.arange(corners))
    assert len(faces) == corners - 2
    assert doubled_area(points, faces) == pytest.approx((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())


def test_polygons_of_all_sizes_keep_their_order():
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 1.5, 0]], dtype=float)
    faces, owners = triangulate(points, np.array([4, 2, 3, 5]), np.array([0, 1, 2, 3, 0, 1, 3, 2, 4, 0, 1, 2, 4, 3]))
    assert owners.tolist() == [0, 0, 2, 3, 3, 3]
    assert faces[2].tolist() == [3, 2, 4]


def test_triangles_that_name_a_vertex_twice_are_left_out():
    faces, _ = triangulate(np.eye(3), np.array([3, 3]), np.array([0, 1, 1, 0, 1, 2]))
    assert faces.tolist() == [[0, 1, 2]]


def test_a_hull_is_closed_and_faces_outwards():
    points = np.random.default_rng(3).normal(size=(200, 3))
    hull = convex_hull(points)
    a, b, c = np.moveaxis(hull.vertices[hull.faces], 1, 0)
    normals = np.cross(b - a, c - a)
    assert ((points[:, None] - a) * normals).sum(axis=2).max() < 1e-9
    assert len(hull.vertices) - len(hull.faces) / 2 == 2


def test_a_flat_hull_is_flat_and_a_line_has_none():
    points = np.array([[0, 0, 1], [2, 0, 1], [2, 2, 1], [0, 2, 1], [1, 1, 1]], dtype=float)
    hull = convex_hull(points)
    assert doubled_area(hull.vertices, hull.faces) == pytest.approx(8.0)
    assert convex_hull(np.array([[0.0, 0, 0], [1, 1, 1], [2, 2, 2]])) is None
    assert convex_hull(np.array([[0.0, 0, 0]])) is None
