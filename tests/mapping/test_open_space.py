"""Open space: scans that meet nothing show free floor, and the odometry alone says where the robot is."""

from __future__ import annotations

import math

import numpy as np
import pytest

import trundle
from trundle import Mapper, Observation, Pose2D, Robot, Scan, Twist2D
from trundle.mission import Outcome
from trundle.worlds import World

ANGLES = np.linspace(-math.pi, math.pi, 360, endpoint=False)
RANGE_M, WALL_X = 10.0, 45.0

pytestmark = pytest.mark.filterwarnings("ignore:no beam of the scans")


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("nova_carter")


def see(mapper: Mapper, time: float, x: float, ranges: np.ndarray) -> trundle.Estimate:
    pose = Pose2D(x, 0.0)
    scan = Scan("laser", time, Pose2D(0.0, 0.0), 0.3, ANGLES, ranges, 0.05, RANGE_M)
    return mapper.update(Observation(time, Twist2D(), pose, (scan,)))


def before_a_wall(x: float) -> np.ndarray:
    """Ranges before one wall across."""
    ahead = np.cos(ANGLES)
    ranges = np.where(ahead > 0.0, (WALL_X - x) / np.maximum(ahead, 1e-9), np.inf)
    return np.where(ranges > RANGE_M, np.inf, ranges)


def drive(mapper: Mapper, along: np.ndarray) -> list[trundle.Estimate]:
    begin = 0.0 if not len(mapper.graph().times) else float(mapper.graph().times[-1]) + 10.0
    return [see(mapper, begin + i, float(x), before_a_wall(float(x))) for i, x in enumerate(along)]


def test_what_a_robot_sees_in_the_open_is_free_from_its_first_scan_on(robot: Robot) -> None:
    mapper = Mapper(robot)
    mapper.reset(Pose2D(-8.0, 3.0))
    see(mapper, 0.0, 0.0, np.full(360, np.inf))
    grid = mapper.grid()
    row, col = grid.world_to_cell(np.array([-8.0, -4.5, -8.0]), np.array([3.0, 3.0, 6.5]))
    assert (grid.data[row, col] == 0).all()


def test_the_map_grows_in_the_open_and_a_wall_that_comes_is_matched(robot: Robot) -> None:
    mapper = Mapper(robot)
    there = drive(mapper, np.arange(0.0, 44.0, 0.25))
    sigma = [float(estimate.covariance[0, 0]) for estimate in there]
    assert sigma[120] > 10.0 * sigma[4]  # the odometry alone
    assert sigma[-1] < 0.01  # the wall
    assert {estimate.state for estimate in there} == {"localized"}
    back = drive(mapper, np.arange(44.0, 0.0, -0.25))
    again = drive(mapper, np.arange(0.0, 44.0, 0.25))
    assert back[-1].pose.distance_to(Pose2D(0.25, 0.0)) < 0.1
    assert again[-1].pose.distance_to(Pose2D(43.75, 0.0)) < 0.1
    graph = mapper.graph()
    assert set(graph.parts.tolist()) == {0}
    grid = mapper.grid()
    row, col = grid.world_to_cell(np.arange(0.0, 43.0, 1.0), np.zeros(43))
    assert (grid.data[row, col] == 0).all()


def test_scans_without_any_measurement_draw_nothing_and_the_empty_map_lies_where_the_robot_is(robot: Robot) -> None:
    mapper = Mapper(robot)
    mapper.reset(Pose2D(-8.0, 3.0))
    for k in range(3):
        see(mapper, float(k), float(k), np.full(360, np.nan))
    assert not len(mapper.graph().times)
    grid = mapper.grid()
    assert (grid.data == -1).all()
    assert grid.contains(*grid.world_to_cell(-8.0, 3.0))


def test_an_explorer_in_a_hall_wider_than_its_lidar_sees_drives_on(robot: Robot) -> None:
    burger = Robot.load("turtlebot3_burger")
    with trundle.simulate(World("floor", ()), burger, backend="kinematic", lidar=True) as sim:
        episode = trundle.run(sim, "explorer", (-8.0, -8.0), None, localizer="slam", time_limit_s=25.0)
    assert episode.outcome is Outcome.TIMED_OUT
    assert episode.own_map is not None
    assert (episode.own_map.grid.data == 0).sum() * 0.05**2 > 20.0
