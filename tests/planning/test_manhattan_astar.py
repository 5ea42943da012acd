import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import BlockedPoseError, NoPathError, OutsideMapError
from trundle.geometry import Goal, Pose2D
from trundle.maps.grid import OccupancyGrid
from trundle.planning.grid_planners.manhattan_astar import ManhattanAstarPlanner

SQUARE = ((0.4, 0.4), (-0.4, 0.4), (-0.4, -0.4), (0.4, -0.4))


def costmap_of(data):
    return Costmap.from_grid(OccupancyGrid(np.asarray(data, np.int8), 0.1), SQUARE)


def test_it_goes_along_rows_and_columns_at_unit_cost():
    path = ManhattanAstarPlanner().plan(costmap_of(np.zeros((30, 30))), Pose2D(0.55, 0.55), Pose2D(2.05, 1.25, 1.0))
    assert path.length == pytest.approx(1.5 + 0.7)
    assert path.cost == pytest.approx(path.length)
    assert path.planner == "manhattan_astar"
    steps = np.abs(np.diff(path.poses[:, :2], axis=0))
    assert (steps.min(axis=1) < 1e-9).all()


def test_it_ends_as_it_arrives_where_any_yaw_will_do():
    costmap = costmap_of(np.zeros((30, 30)))
    path = ManhattanAstarPlanner().plan(costmap, Pose2D(0.55, 2.05), Goal(0.55, 0.55))
    assert path.goal.as_tuple() == pytest.approx((0.55, 0.55, -np.pi / 2))
    assert path.poses[-1, 2] == path.poses[-2, 2]  # no turn in place at the end
    here = ManhattanAstarPlanner().plan(costmap, Pose2D(0.55, 0.55, 2.0), Goal(0.55, 0.55))
    assert (here.start.yaw, here.goal.yaw) == (2.0, 2.0)


def test_a_partial_path_ends_as_it_arrives_where_any_yaw_will_do():
    data = np.zeros((20, 20))
    data[10, :] = 100
    planner = ManhattanAstarPlanner(allow_partial=True)
    path = planner.plan(costmap_of(data), Pose2D(1.05, 0.35), Goal(1.05, 1.55))
    assert path.status == "partial"
    assert path.goal.as_tuple() == pytest.approx((1.05, 0.95, np.pi / 2))


def test_it_scrapes_along_walls_and_goes_through_gaps_of_one_cell():
    data = np.zeros((20, 20))
    data[10, :] = 100
    data[10, 7] = 0
    path = ManhattanAstarPlanner().plan(costmap_of(data), Pose2D(1.0, 0.5), Pose2D(1.0, 1.5))
    assert np.isclose(path.poses[:, :2], (0.75, 1.05)).all(axis=1).any()


def test_start_and_goal_in_one_cell():
    path = ManhattanAstarPlanner().plan(costmap_of(np.zeros((5, 5))), Pose2D(0.21, 0.21, 0.0), Pose2D(0.28, 0.21, 1.0))
    assert path.length == pytest.approx(0.07)
    assert path.start == Pose2D(0.21, 0.21, 0.0)
    assert path.goal == Pose2D(0.28, 0.21, 1.0)


def test_it_refuses_with_typed_errors():
    data = np.zeros((20, 20))
    data[10, :] = 100
    data[12, 3] = -1
    costmap = costmap_of(data)
    with pytest.raises(NoPathError, match="separated"):
        ManhattanAstarPlanner().plan(costmap, Pose2D(1.0, 0.5), Pose2D(1.0, 1.5))
    with pytest.raises(OutsideMapError, match="goal"):
        ManhattanAstarPlanner().plan(costmap, Pose2D(1.0, 0.5), Pose2D(1.0, 2.5))
    with pytest.raises(BlockedPoseError, match=r"an obstacle; the nearest free cell is 0\.10 m away"):
        ManhattanAstarPlanner().plan(costmap, Pose2D(1.05, 1.05), Pose2D(1.0, 1.5))
    with pytest.raises(BlockedPoseError, match="unknown space"):
        ManhattanAstarPlanner().plan(costmap, Pose2D(1.0, 1.5), Pose2D(0.35, 1.25))
    with pytest.raises(BlockedPoseError, match=r"no cell within .* m is free"):
        ManhattanAstarPlanner().plan(costmap_of(np.full((3, 3), 100)), Pose2D(0.1, 0.1), Pose2D(0.2, 0.2))
