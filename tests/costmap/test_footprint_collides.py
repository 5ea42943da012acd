"""The footprint against cells of a costmap: collisions and clearances, against shapely."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from support.cost_grids import LONG, SQUARE, make_grid
from trundle._core import footprint_clearance, footprint_collides
from trundle.costmap import LETHAL, Costmap
from trundle.errors import InputError
from trundle.geometry import Pose2D
from trundle.maps.grid import OccupancyGrid


def boxes_of(costmap):
    """Every blocked cell as a shapely box in grid units."""
    rows, cols = np.nonzero(costmap.data >= LETHAL)
    return shapely.box(cols, rows, cols + 1, rows + 1)


def placed(costmap, pose):
    """The footprint at a pose as a shapely polygon in grid units."""
    in_map = Pose2D(*pose).transform_points(costmap.footprint)
    return shapely.Polygon(costmap.origin.inverse().transform_points(in_map) / costmap.resolution)


def cases(seed, density=0.02):
    grid = make_grid(40, 50, density, seed)
    costmap = Costmap.from_grid(OccupancyGrid(grid.data, 0.05, Pose2D(-1.0, 0.5, 0.3)), LONG)
    rng = np.random.default_rng(seed)
    x, y = costmap.cell_to_world(rng.uniform(-3, 43, 60), rng.uniform(-3, 53, 60))
    return costmap, np.column_stack([x, y, rng.uniform(-4, 4, 60)])


@pytest.mark.parametrize("seed", range(12))
def test_footprint_collides_as_shapely_says(seed):
    costmap, poses = cases(seed, density=0.02 if seed % 2 else 0.002)
    boxes, area = shapely.STRtree(boxes_of(costmap)), shapely.box(0, 0, costmap.shape[1], costmap.shape[0])
    hits = costmap.footprint_collides(poses)
    for pose, hit in zip(poses, hits, strict=True):
        polygon = placed(costmap, pose)
        grown, shrunk = polygon.buffer(1e-6), polygon.buffer(-1e-6)
        touches_grown = len(boxes.query(grown, "intersects")) > 0 or not area.contains(grown)
        touches_shrunk = len(boxes.query(shrunk, "intersects")) > 0 or not area.contains(shrunk)
        if touches_grown == touches_shrunk:
            assert hit == touches_grown


@pytest.mark.parametrize("seed", range(8))
def test_clearance_is_shapelys_distance(seed):
    costmap, poses = cases(seed, density=0.01 if seed % 2 else 0.0005)
    frame = shapely.box(0, 0, costmap.shape[1], costmap.shape[0])
    outside = frame.buffer(100.0).difference(frame)
    blocked = shapely.union_all([*boxes_of(costmap), outside])
    cap = 0.5 + 0.25 * seed
    for pose, clearance in zip(poses, costmap.clearance(poses, cap), strict=True):
        polygon = placed(costmap, pose)
        assert clearance == pytest.approx(min(cap, polygon.distance(blocked) * 0.05), abs=1e-9)


def test_touching_a_wall_is_no_collision_and_reaching_into_it_is():
    data = np.zeros((20, 20), np.int8)
    data[:, 10:] = 100
    costmap = Costmap.from_grid(OccupancyGrid(data, 0.1), SQUARE)
    assert not costmap.footprint_collides([(0.8, 1.0, 0.0)])[0]
    assert not costmap.footprint_collides([(0.8, 1.0, math.pi / 2)])[0]
    assert costmap.footprint_collides([(0.8 + 1e-6, 1.0, 0.0)])[0]
    assert costmap.clearance([(0.8, 1.0, 0.0)])[0] == pytest.approx(0.0, abs=1e-12)
    assert costmap.clearance([(0.7, 1.0, 0.0)])[0] == pytest.approx(0.1)


def test_an_off_centre_footprint_swings_its_tail():
    data = np.zeros((60, 60), np.int8)
    data[:, 40:] = 100
    costmap = Costmap.from_grid(OccupancyGrid(data, 0.05), LONG)
    x = 40 * 0.05 - 0.3
    assert not costmap.footprint_collides([(x, 1.5, 0.0)])[0]
    assert costmap.footprint_collides([(x, 1.5, math.pi)])[0]


def test_leaving_the_map_collides():
    costmap = Costmap.from_grid(OccupancyGrid(np.zeros((20, 20), np.int8), 0.1), SQUARE)
    poses = [(1.0, 1.0, 0.3), (0.1, 1.0, 0.0), (1.0, 1.95, 0.0), (50.0, 1.0, 0.0), (0.2, 0.2, 0.0)]
    assert costmap.footprint_collides(poses).tolist() == [False, True, True, True, False]


def test_a_pose_that_is_not_finite_collides():
    costmap = Costmap.from_grid(OccupancyGrid(np.zeros((20, 20), np.int8), 0.1), SQUARE)
    assert costmap.footprint_collides([(math.nan, 1, 0), (1, math.inf, 0), (1, 1, math.nan), (1e300, 1, 0)]).all()


def test_clearance_is_capped():
    costmap = Costmap.from_grid(OccupancyGrid(np.zeros((200, 200), np.int8), 0.1), SQUARE)
    assert costmap.clearance([(10.0, 10.0, 0.4)]).tolist() == [2.0]
    assert costmap.clearance([(10.0, 10.0, 0.0)], cap=100.0)[0] == pytest.approx(9.8)
    for cap in (0.0, math.nan, "1"):
        with pytest.raises(InputError, match="cap"):
            costmap.clearance([(10.0, 10.0, 0.0)], cap=cap)


def test_one_pose_and_no_pose_are_batches_too():
    costmap = Costmap.from_grid(OccupancyGrid(np.zeros((20, 20), np.int8), 0.1), SQUARE)
    assert costmap.footprint_collides((1.0, 1.0, 0.0)).shape == (1,)
    assert costmap.footprint_collides(np.empty((0, 3))).shape == (0,)
    with pytest.raises(InputError, match="shape"):
        costmap.footprint_collides([(1.0, 1.0)])


@pytest.mark.parametrize("corners", [np.zeros((3, 3)), SQUARE[:2], [(1, 1), (math.nan, 1), (0, -1)], "corners", None])
def test_an_outline_that_is_none_is_refused(corners):
    costmap = Costmap.from_grid(OccupancyGrid(np.zeros((20, 20), np.int8), 0.1), SQUARE)
    with pytest.raises(InputError, match="outline"):
        costmap.footprint_collides([(1.0, 1.0, 0.0)], outline="" if corners is None else corners)
    with pytest.raises(InputError, match="footprint"):
        Costmap.from_grid(OccupancyGrid(np.zeros((20, 20), np.int8), 0.1), "carter" if corners is None else corners)


def test_poses_that_are_no_numbers_are_refused():
    costmap = Costmap.from_grid(OccupancyGrid(np.zeros((20, 20), np.int8), 0.1), SQUARE)
    with pytest.raises(InputError, match="numbers"):
        costmap.footprint_collides([("a", 1.0, 0.0)])


@pytest.mark.parametrize("resolution", [0.0, -0.1, math.nan, math.inf])
def test_the_kernel_takes_no_resolution_that_is_no_size(resolution):
    arguments = (np.zeros((4, 4), np.uint8), resolution, 0.0, 0.0, 0.0, np.array(SQUARE), np.zeros((1, 3)))
    with pytest.raises(ValueError, match="resolution"):
        footprint_collides(*arguments)
    with pytest.raises(ValueError, match="resolution"):
        footprint_clearance(*arguments, 1.0)


def test_a_frame_that_is_no_number_makes_every_pose_collide():
    costs, pose = np.zeros((40, 40), np.uint8), np.array([[1.0, 1.0, 0.0]])
    for frame in ((math.nan, 0.0, 0.0), (0.0, math.inf, 0.0), (0.0, 0.0, math.nan), (1e308, -1e308, 0.3)):
        assert footprint_collides(costs, 0.1, *frame, np.array(SQUARE), pose)[0]
    with pytest.raises(ValueError, match="finite"):
        footprint_collides(costs, 0.1, 0.0, 0.0, 0.0, np.full((4, 2), math.nan), pose)


@settings(max_examples=40, deadline=None)
@given(x=st.floats(-5, 5), y=st.floats(-5, 5), yaw=st.floats(-6.28, 6.28), turn=st.floats(-3.1, 3.1))
def test_collision_does_not_depend_on_the_maps_frame(x, y, yaw, turn):
    grid = make_grid(30, 30, 0.02, 5)
    local = Costmap.from_grid(grid, LONG)
    moved = Costmap.from_grid(OccupancyGrid(grid.data, 0.05, Pose2D(x, y, turn)), LONG)
    pose = Pose2D(0.75, 0.75, yaw)
    there = Pose2D(x, y, turn) @ pose
    clearance = local.clearance([pose.as_tuple()])[0]
    if abs(clearance) > 1e-6:
        assert moved.clearance([there.as_tuple()])[0] == pytest.approx(clearance, abs=1e-6)
