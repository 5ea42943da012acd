"""`AnyAnglePlanner`: the shortest path of a point in any direction, by name `any_angle`."""

from __future__ import annotations

from typing import Unpack

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap import Costmap
from trundle.geometry import FloatArray, path_length
from trundle.planning.cancellation import Patience
from trundle.planning.grid_planners.binary_planner import BinaryPlanner
from trundle.planning.grid_planners.footprint_planner import FootprintOptions, to_grid, to_map
from trundle.planning.queries.ends import End


class AnyAnglePlanner(BinaryPlanner):
    """Finds the shortest path of a point around cells of 253 and more, in any direction (`any_angle_path`).

    Between the centres of the cells that hold the start and the goal it is the Euclidean optimum. It is joined to their
    poses directly where the straight line is free, and through the centres of these cells otherwise. The robot's centre
    touches the corners of cells of 253, where it may be up to 0.71 of a cell nearer to an obstacle than the inscribed
    radius, and never enters one. Whether the robot fits is decided by its footprint alone: every pose is checked with
    it, and after a collision the path is planned again around those cells, as with every grid planner. The result is
    the shortest path of a point around the cells that are blocked by then. `Path.cost` is its length [m]; the costs of
    cells below 253 do not count. For the options see `FootprintPlanner`.
    """

    name = "any_angle"

    def __init__(self, **options: Unpack[FootprintOptions]) -> None:
        super().__init__("jps", **options)

    def _find_path(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: End, goal: End, patience: Patience
    ) -> tuple[FloatArray, float] | None:
        with self._search(costmap, costs) as search:
            path = search.any_angle_path(start.cell, goal.cell, deadline_s=patience.seconds, cancel=patience.cancel)
        if path.status in ("timeout", "cancelled"):
            raise patience.stopped(path.status)
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
        return vertices, path_length(vertices)

    def _is_free(self, costs: npt.NDArray[np.uint8], a: FloatArray, b: FloatArray) -> bool:
        """Return whether the line between two points in grid units is clear of blocked cells, but for its ends."""
        return bool(np.isfinite(_core.line_costs(costs, self._line_weights, a.reshape(1, 2), b.reshape(1, 2))[0]))
