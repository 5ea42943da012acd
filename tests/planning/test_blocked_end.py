"""What is said of an end where the robot cannot stand, and what that takes."""

import contextlib
import math
import tracemalloc

import numpy as np
import pytest

from trundle.costmap import INSCRIBED, LETHAL, Costmap
from trundle.errors import BlockedPoseError
from trundle.geometry import Goal, Pose2D
from trundle.maps import OccupancyGrid
from trundle.planning import create_planner
from trundle.planning.queries.ends import MOST_POSES, REACH_CELLS, find_nearest
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")


def wide(step):
    """4096² cells, with a wall at every so many columns; between them no cost says that the footprint does not fit."""
    data = np.full((4096, 4096), 100, np.uint8)
    data[:, ::step] = LETHAL
    return Costmap(data, 0.05, Pose2D(0.0, 0.0), CARTER.outline, 0.9)


@contextlib.contextmanager
def little_memory():
    """A block that takes less than 50 MB."""
    tracemalloc.start()
    try:
        yield
        assert tracemalloc.get_traced_memory()[1] < 50e6
    finally:
        tracemalloc.stop()


@pytest.fixture(scope="module")
def too_narrow():
    """For the robot, whatever its yaw."""
    return wide(8)


@pytest.fixture
def counted(monkeypatch):
    """How many poses are tried."""
    tried, check = [], Costmap.footprint_collides

    def count(self, poses, **options):
        tried.append(np.size(poses) // 3)
        return check(self, poses, **options)

    monkeypatch.setattr(Costmap, "footprint_collides", count)
    return tried


@pytest.mark.parametrize("name", ["auto", "least_cost", "astar", "hybrid_astar"])
@pytest.mark.parametrize("free_yaw", [False, True])
def test_a_start_where_no_yaw_fits_is_explained_without_a_look_at_the_whole_map(name, free_yaw, too_narrow, counted):
    start, goal = Pose2D(100.0, 100.0, 0.7), Pose2D(3.0, 3.0)
    message = r"with this yaw it fits nowhere within .* m of there"
    with little_memory(), pytest.raises(BlockedPoseError, match=message) as raised:
        create_planner(name).plan(too_narrow, start, Goal(goal.x, goal.y, None if free_yaw else goal.yaw))
    assert raised.value.nearest_free_m is None
    assert 1000 < sum(counted) <= MOST_POSES + 1000


@pytest.mark.parametrize("yaws", [1, 180])
def test_looking_for_the_nearest_place_is_bounded(yaws, too_narrow, counted):
    with little_memory():
        place, looked = find_nearest(too_narrow, Pose2D(100.0, 100.0), np.linspace(0.0, 6.0, yaws))
    assert place is None
    assert MOST_POSES - 4096 < sum(counted) <= MOST_POSES
    assert 0.0 < looked < REACH_CELLS * 0.05


def test_manhattan_astar_looks_no_farther():
    solid = Costmap(np.full((4096, 4096), LETHAL, np.uint8), 0.05, Pose2D(0.0, 0.0), CARTER.outline, 0.9)
    with little_memory(), pytest.raises(BlockedPoseError, match=r"no cell within 12\.8 m is free"):
        create_planner("manhattan_astar").plan(solid, Pose2D(100.0, 100.0), Pose2D(101.0, 100.0))


@pytest.mark.parametrize("seed", range(6))
def test_the_nearest_place_is_the_nearest_of_all(seed):
    generator = np.random.default_rng(seed)
    grid = OccupancyGrid((generator.random((120, 150)) < 0.004).astype(np.int8) * 100, 0.05)
    costmap = Costmap.from_grid(grid, CARTER)
    pose = Pose2D(*generator.uniform(2.0, 5.0, 2), 1.0)
    yaws = np.array([1.0]) if seed % 2 else np.arange(0.0, 2.0 * math.pi, math.radians(30.0))
    rows, cols = np.nonzero(costmap.data < INSCRIBED)
    x, y = costmap.cell_to_world(rows, cols)
    fits = np.zeros(len(x), bool)
    for yaw in yaws:
        fits |= ~costmap.footprint_collides(np.column_stack([x, y, np.full(len(x), yaw)]))
    place, looked = find_nearest(costmap, pose, yaws)
    assert place is not None
    assert place[2] == looked == pytest.approx(np.hypot(x - pose.x, y - pose.y)[fits].min())
    assert math.hypot(place[0] - pose.x, place[1] - pose.y) == pytest.approx(looked)
    assert any(not costmap.footprint_collides([(place[0], place[1], yaw)])[0] for yaw in yaws)


def test_a_place_farther_than_the_first_rings_is_found():
    data = np.full((600, 600), 100, np.int8)
    data[280:320, 480:] = 0
    costmap = Costmap.from_grid(OccupancyGrid(data, 0.05), CARTER)
    with pytest.raises(BlockedPoseError, match=r"the nearest place where it does is 9\.") as raised:
        create_planner("least_cost").plan(costmap, Pose2D(15.0, 15.0), Pose2D(28.0, 15.0))
    assert raised.value.nearest_free_m == pytest.approx(9.5, abs=0.4)
