"""`AnyAnglePlanner` and `ThetaStarPlanner`: ways of a point in any direction, by names `any_angle` and `theta_star`."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap import Costmap
from trundle.geometry import FloatArray
from trundle.planning.binary_planner import BinaryPlanner
from trundle.planning.ends import End
from trundle.planning.footprint_planner import to_grid, to_map
from trundle.planning.point_path import PointMethod


class _PointPlanner(BinaryPlanner):
    """Plans for a point with `GridSearch.any_angle_path`, and checks the way with the footprint."""

    def __init__(
        self,
        name: str,
        method: PointMethod,
        *,
        start_tolerance: float,
        goal_tolerance: float,
        max_replans: int,
        spacing: float,
    ) -> None:
        super().__init__(
            name,
            "jps",
            start_tolerance=start_tolerance,
            goal_tolerance=goal_tolerance,
            max_replans=max_replans,
            spacing=spacing,
        )
        self._point_method: PointMethod = method

    def _find_way(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: End, goal: End
    ) -> tuple[FloatArray, float] | None:
        path = self._search(costmap, costs).any_angle_path(start.cell, goal.cell, method=self._point_method)
        if path.status != "found":
            return None
        points = path.waypoints[:, ::-1] + 0.5
        first, last = to_grid(costmap, np.array([[end.pose.x, end.pose.y] for end in (start, goal)]))
        if len(points) <= 2:
            inner = points[:0] if self._is_free(costs, first, last) else points
        else:
            skip_first = self._is_free(costs, first, points[1])
            skip_last = self._is_free(costs, points[-2], last)
            inner = points[int(skip_first) : len(points) - int(skip_last)]
        vertices: FloatArray = to_map(costmap, np.concatenate([[first], inner, [last]]))
        vertices[0], vertices[-1] = (start.pose.x, start.pose.y), (goal.pose.x, goal.pose.y)
        return vertices, float(np.hypot(*np.diff(vertices, axis=0).T).sum())

    def _is_free(self, costs: npt.NDArray[np.uint8], a: FloatArray, b: FloatArray) -> bool:
        """Whether the line between two points in grid units keeps off blocked cells, but for its ends."""
        return bool(np.isfinite(_core.line_costs(costs, self._line_weights, a.reshape(1, 2), b.reshape(1, 2))[0]))


class AnyAnglePlanner(_PointPlanner):
    """Finds the shortest way of a point past cells of 253 and more, in any direction (`any_angle_path`).

    Between the centres of the cells that hold the start and the goal it is the Euclidean optimum. It is joined to their
    poses directly where the straight line is free, and through the centre of their cell otherwise. The robot's centre
    touches the corners of cells of 253, where it may be up to 0.71 of a cell nearer to an obstacle than the inscribed
    radius, and never enters one. Whether the robot fits is decided by its footprint alone: every pose is checked with
    it, and where it hits something the way is planned again round those cells, as with every grid planner. What
    comes of that is the shortest way of a point round the cells that are blocked by then. `Path.cost` is its length
    [m]; what the cells below 253 cost does not count. For the options see `BinaryPlanner`.
    """

    def __init__(
        self,
        *,
        start_tolerance: float = 0.05,
        goal_tolerance: float = 0.25,
        max_replans: int = 20,
        spacing: float = 0.1,
    ) -> None:
        super().__init__(
            "any_angle",
            "exact",
            start_tolerance=start_tolerance,
            goal_tolerance=goal_tolerance,
            max_replans=max_replans,
            spacing=spacing,
        )


class ThetaStarPlanner(_PointPlanner):
    """Finds a way past cells of 253 and more with Theta*, which turns at the centres of cells.

    It is short, not the shortest: `any_angle` is, and in most maps faster. Lines of sight may touch the corners of
    cells of 253. Joined to the poses, checked with the footprint and planned again like `AnyAnglePlanner`. For the
    options see `BinaryPlanner`.
    """

    def __init__(
        self,
        *,
        start_tolerance: float = 0.05,
        goal_tolerance: float = 0.25,
        max_replans: int = 20,
        spacing: float = 0.1,
    ) -> None:
        super().__init__(
            "theta_star",
            "theta_star",
            start_tolerance=start_tolerance,
            goal_tolerance=goal_tolerance,
            max_replans=max_replans,
            spacing=spacing,
        )
