"""Distances from footprints to solids, held against Shapely."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import example, given, settings
from hypothesis import strategies as st

from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.robots import Robot
from trundle.sim.clearance import least_clearance, map_world, polygon_distances
from trundle.sim.sections import cut_triangles
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
LOW, HIGH = CARTER.body.clearance, CARTER.body.height
TAIL, NOSE = -0.607, 0.14

cube = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)], dtype=float) - 0.5
FACES = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2)]
FACES += [(1, 3, 7), (1, 7, 5)]


def mesh(x: float, y: float, z: float) -> Mesh:
    return Mesh(cube * np.array([x, y, z]), np.array(FACES))


def clearance(solids: list[Solid], poses: list[tuple[float, float, float]], resolution: float = 0.05) -> float:
    world, driven = World("w", tuple(solids)), np.array(poses, dtype=np.float64)
    true_map = map_world(world, CARTER, driven[:, :2], resolution=resolution, margin=2.0 + 0.7)
    coarse = true_map.clearance(driven, 2.0)
    return least_clearance(world, CARTER, driven, coarse, resolution=resolution, cap=2.0)


@pytest.mark.parametrize(
    ("solid", "expected"),
    [
        (Solid("box", Box((0.2, 0.4, 1.0)), Pose3D((1.0, 0.0, 0.5))), 0.9 - NOSE),
        (Solid("post", Cylinder(0.1, 1.0), Pose3D((1.0, 0.0, 0.5))), 0.9 - NOSE),
        (Solid("ball", Sphere(0.3), Pose3D((1.0, 0.0, 0.3))), 0.7 - NOSE),
        (Solid("high", Box((0.2, 0.4, 1.0)), Pose3D((1.0, 0.0, HIGH + 0.51))), 2.0),
        (Solid("low", Box((0.2, 0.4, 0.05)), Pose3D((1.0, 0.0, 0.025))), 2.0),
        (Solid("mesh", mesh(0.2, 0.4, 1.0), Pose3D((1.0, 0.0, 0.5))), 0.9 - NOSE),
        (Solid("behind", mesh(0.2, 0.4, 1.0), Pose3D((-1.0, 0.0, 0.5))), 0.9 + TAIL),
        (Solid("under", Box((0.1, 0.1, 1.0)), Pose3D((-0.2, 0.0, 0.5))), 0.0),
        (Solid("around", mesh(0.05, 0.05, 1.0), Pose3D((-0.2, 0.0, 0.5))), 0.0),
        (Solid("far", Box((0.2, 0.4, 1.0)), Pose3D((5.0, 0.0, 0.5))), 2.0),
        (Solid("map", OccupancyCells(np.eye(1, dtype=bool), 0.1, 1.0), Pose3D((0.95, -0.05, 0.0))), 0.95 - NOSE),
    ],
    ids=lambda value: value.name if isinstance(value, Solid) else "",
)
def test_the_distance_is_that_to_the_solid_and_not_to_a_cell(solid: Solid, expected: float) -> None:
    assert clearance([solid], [(0.0, 0.0, 0.0)]) == pytest.approx(expected, abs=1e-9)


def test_a_hollow_mesh_is_not_its_hull() -> None:
    low, high = np.array([-3.0, -3.0, -0.1]), np.array([3.0, 3.0, 1.1])
    room = Mesh(np.where(cube > 0, high, low), np.array(FACES)[:, ::-1])
    assert clearance([Solid("room", room)], [(1.5, 0.0, 0.0)]) == pytest.approx(1.5 - NOSE)


def test_the_nearest_of_all_poses_counts() -> None:
    wall = Solid("wall", Box((0.2, 9.0, 1.0)), Pose3D((3.0, 0.0, 0.5)))
    poses = [(x, 0.0, 0.0) for x in np.linspace(0.0, 2.0, 41)]
    assert clearance([wall], poses + poses[::-1]) == pytest.approx(0.9 - NOSE, abs=1e-9)


def shape_of(solid: Solid) -> shapely.Geometry:
    x, y, _ = solid.pose.position
    match solid.shape:
        case Sphere(radius) | Cylinder(radius, _):
            return shapely.Point(x, y).buffer(radius, quad_segs=512)
        case Box(size):
            corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.array(size[:2]) / 2.0
        case Mesh(vertices, _):
            corners = vertices[:4][[0, 1, 3, 2], :2]
        case cells:
            rows, cols = np.nonzero(cells.blocked)
            squares = [shapely.box(c, r, c + 1, r + 1) for r, c in zip(rows.tolist(), cols.tolist(), strict=True)]
            placed = shapely.transform(shapely.union_all(squares), lambda points: points * cells.resolution)
            return shapely.transform(placed, Pose2D(x, y, solid.pose.yaw()).transform_points)
    return shapely.Polygon(Pose2D(x, y, solid.pose.yaw()).transform_points(corners))


numbers = st.floats(-2.5, 2.5)
sizes = st.floats(0.05, 1.5)
upright = st.builds(
    lambda x, y, yaw: Pose3D((x, y, 0.4), (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))),
    numbers,
    numbers,
    st.floats(-3.0, 3.0),
)
shapes = st.one_of(
    st.builds(lambda x, y: Box((x, y, 2.0)), sizes, sizes),
    st.builds(lambda r: Cylinder(r, 2.0), sizes),
    st.builds(lambda x, y: mesh(x, y, 2.0), sizes, sizes),
    st.builds(
        lambda bits: OccupancyCells(np.array(bits).reshape(3, 3), 0.2, 1.0),
        st.lists(st.booleans(), min_size=9, max_size=9),
    ),
)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(shapes, upright), min_size=1, max_size=5),
    st.lists(st.tuples(numbers, numbers, st.floats(-3.0, 3.0)), min_size=1, max_size=6),
    st.sampled_from([0.05, 0.3]),
)
@example([(mesh(1.5, 1.0, 2.0), Pose3D((0.0, 0.0, 0.4)))], [(0.0, 0.0, 0.0)], 0.05)  # wholly inside a mesh
def test_it_agrees_with_shapely(found, poses, resolution) -> None:
    solids = [Solid(str(number), shape, pose) for number, (shape, pose) in enumerate(found)]
    outlines = [shapely.Polygon(outline) for outline in CARTER.planar.at_poses(np.array(poses))]
    expected = min(
        [
            2.0,
            *(
                shape_of(solid).distance(outline)
                for solid in solids
                for outline in outlines
                if not shape_of(solid).is_empty
            ),
        ]
    )
    assert clearance(solids, poses, resolution) == pytest.approx(expected, abs=2e-5)


def test_a_triangle_is_cut_to_a_band_of_heights() -> None:
    upright_triangle = np.array([[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]]])
    (cut,) = cut_triangles(upright_triangle, 0.5, 1.0)
    assert (cut[:, 0].min(), cut[:, 0].max()) == pytest.approx((0.0, 1.5))
    assert (cut[:, 1] == 0.0).all()
    level = np.array([[[0.0, 0.0, 0.7], [2.0, 0.0, 0.7], [0.0, 1.0, 0.7]]])
    assert shapely.Polygon(cut_triangles(level, 0.5, 1.0)[0]).area == pytest.approx(1.0)
    assert len(cut_triangles(level, 0.8, 1.0)) == 0
    slope = np.array([[[0.0, 0.0, 0.0], [3.0, 0.0, 3.0], [0.0, 3.0, 0.0]]])
    assert shapely.Polygon(cut_triangles(slope, 1.0, 2.0)[0]).area == pytest.approx(4.5 * (4 / 9 - 1 / 9))


def test_polygons_of_either_sense_and_lines_are_measured() -> None:
    outline = np.array([[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]])
    square = np.array([[2.0, 0.0], [3.0, 0.0], [3.0, 1.0], [2.0, 1.0]])
    large = 10.0 * square - np.array([25.0, 5.0])
    line = np.array([[1.5, -5.0], [1.5, 5.0], [1.5, 5.0], [1.5, 5.0]])
    through = line - np.array([1.0, 0.0])
    for polygon, distance in ((square, 1.0), (square[::-1], 1.0), (large, 0.0), (large[::-1], 0.0), (line, 0.5)):
        assert polygon_distances(outline, polygon[None])[0] == pytest.approx(distance)
    assert polygon_distances(outline, through[None])[0] == 0.0
    beyond = np.array([[0.5, 5.0], [0.5, 6.0], [0.5, 7.0], [0.5, 7.0]])  # Its line crosses, it does not.
    assert polygon_distances(outline, beyond[None])[0] == pytest.approx(4.0)
