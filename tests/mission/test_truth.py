"""A run is measured on the world, whatever the robot's map says of it."""

import math

import numpy as np
import pytest

import trundle
from trundle.costmap import Costmap
from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome
from trundle.mission.metrics import shortest_length
from trundle.worlds import World

WALLS = (
    Solid("west", Box((0.1, 6.0, 1.0)), Pose3D((-2.0, 0.0, 0.5))),
    Solid("east", Box((0.1, 6.0, 1.0)), Pose3D((8.0, 0.0, 0.5))),
)


def drive(*unmapped: Solid, backend: str = "mujoco"):
    """Straight along x from 0 to 5, on a map without some solids."""
    robot = trundle.Robot.load("nova_carter")
    grid = OccupancyGrid.from_world(World("mapped", WALLS), resolution=0.05, z_range=robot.z_range)
    with trundle.simulate(World("true", (*WALLS, *unmapped)), robot, backend=backend) as sim:
        return trundle.run(sim, trundle.Navigator(grid, robot), (0.0, 0.0, 0.0), (5.0, 0.0))


@pytest.mark.parametrize("backend", ["mujoco", "kinematic"])
def test_a_crash_into_a_crate_that_the_map_has_not_has_no_clearance(backend: str) -> None:
    episode = drive(Solid("crate", Box((0.4, 0.4, 0.4)), Pose3D((2.5, 0.0, 0.2))), backend=backend)
    assert episode.outcome is Outcome.COLLIDED
    assert episode.metrics.min_clearance_m == 0.0
    assert episode.metrics.measured_on == "world"
    assert episode.metrics.shortest_path_m is None
    assert episode.metrics.spl == 0.0


def test_a_crate_that_the_map_has_not_is_passed_at_its_true_distance() -> None:
    episode = drive(Solid("crate", Box((0.4, 0.4, 0.4)), Pose3D((2.5, 0.6, 0.2))), backend="kinematic")
    assert episode.outcome is Outcome.ARRIVED
    assert episode.metrics.min_clearance_m == pytest.approx(0.4 - 0.25, abs=2e-3)
    assert episode.metrics.shortest_path_m == pytest.approx(5.0, abs=1e-9)
    assert episode.metrics.spl == 1.0


def test_a_detour_that_the_world_does_not_need_costs_success() -> None:
    robot = trundle.Robot.load("nova_carter")
    phantom = Solid("phantom", Box((0.4, 4.0, 1.0)), Pose3D((2.5, 0.0, 0.5)))
    grid = OccupancyGrid.from_world(World("mapped", (*WALLS, phantom)), resolution=0.05, z_range=robot.z_range)
    with trundle.simulate(World("true", WALLS), robot, backend="kinematic") as sim:
        metrics = trundle.run(sim, trundle.Navigator(grid, robot), (0.0, 0.0, 0.0), (5.0, 0.0)).metrics
    assert metrics.shortest_path_m == pytest.approx(5.0, abs=1e-9)
    assert metrics.path_length_m > 6.0
    assert metrics.spl == pytest.approx(5.0 / metrics.distance_m)


def costmap_of(data: np.ndarray, resolution: float = 0.05) -> Costmap:
    return Costmap.from_grid(OccupancyGrid(data, resolution), trundle.Robot.load("turtlebot3_burger").outline)


def test_the_shortest_path_is_taut_round_the_inflated_corner() -> None:
    data = np.zeros((120, 160), dtype=np.int8)
    data[:60, 80:82] = 100
    costmap = costmap_of(data)
    radius = costmap.inscribed_radius
    points = np.array([[2.0, 1.0], [6.0, 1.0]])
    driven = np.array([[2.0, 1.0], [2.0, 5.0], [6.0, 5.0], [6.0, 1.0]])
    length = shortest_length(costmap, points, driven)
    over = 3.0 + radius - 1.0
    exact = math.hypot(2.0 - radius, over) + math.hypot(1.9 - radius, over) + 0.1 + 2.0 * radius
    assert length == pytest.approx(exact, abs=0.15)
    assert length > math.hypot(2.0, 2.0) + math.hypot(1.9, 2.0)
    legs = shortest_length(costmap, np.array([*points, points[0]]), driven)
    assert legs == pytest.approx(2.0 * length)


def test_where_the_robot_drove_is_free_for_its_disc() -> None:
    data = np.zeros((60, 80), dtype=np.int8)
    data[:, 40] = 100  # A door that is lost in the cells.
    points = np.array([[1.0, 1.5], [3.0, 1.5]])
    assert shortest_length(costmap_of(data), points, points) == pytest.approx(2.0)
    around = np.array([[1.0, 1.5], [1.0, 2.5], [3.0, 2.5], [3.0, 1.5]])
    assert 2.0 < shortest_length(costmap_of(data), points, around) <= 4.0


def test_an_end_that_the_cells_block_is_moved() -> None:
    data = np.zeros((60, 80), dtype=np.int8)
    data[28:32, 60:64] = 100
    points = np.array([[1.0, 1.5], [3.1, 1.5]])
    assert 2.1 < shortest_length(costmap_of(data), points, points[:1]) < 2.6
    data[:, 30] = 100
    assert shortest_length(costmap_of(data), points, points[:1]) == pytest.approx(2.1), "no path is shorter"


def test_a_map_that_is_turned_is_measured_alike() -> None:
    data = np.zeros((60, 80), dtype=np.int8)
    data[10:40, 40] = 100
    frame = Pose2D(3.0, -2.0, 0.7)
    points = np.array([[1.0, 1.5], [3.0, 1.5]])
    driven = np.array([[1.0, 1.5], [1.0, 2.6], [3.0, 2.6], [3.0, 1.5]])
    straight = shortest_length(costmap_of(data), points, driven)
    outline = trundle.Robot.load("turtlebot3_burger").outline
    turned = Costmap.from_grid(OccupancyGrid(data, 0.05, frame), outline)
    assert shortest_length(turned, frame.transform_points(points), frame.transform_points(driven)) == pytest.approx(
        straight, abs=1e-6
    )
