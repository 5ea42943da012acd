"""A planner: breadth-first over the cells where the robot can turn all round."""

from __future__ import annotations

import itertools
import math
from collections import deque

import numpy as np

from trundle.costmap import Costmap
from trundle.errors import BlockedPoseError, NoPathError, OutsideMapError
from trundle.geometry import Goal, Pose2D
from trundle.path import Path

Cell = tuple[int, int]


class GridWalkPlanner:
    """The path with the fewest steps between the four neighbours of a cell."""

    def plan(self, costmap: Costmap, start: Pose2D, goal: Goal) -> Path:
        # The cost at the circumscribed radius: below it, the footprint is clear at every yaw.
        margin = costmap.circumscribed_radius + costmap.resolution - costmap.inscribed_radius
        free = costmap.data < 252.0 * math.exp(-costmap.cost_scaling_factor * margin)
        first, last = (self._cell(costmap, free, pose, name) for pose, name in ((start, "start"), (goal, "goal")))
        cells = self._search(free, first, last)
        x, y = costmap.cell_to_world(*np.array(cells).T)
        steps = np.diff(np.array(cells), axis=0)
        corner = np.ones(len(cells), dtype=bool)
        corner[1:-1] = (steps[1:] != steps[:-1]).any(axis=1)
        inner = zip(x[corner].tolist(), y[corner].tolist(), strict=True)
        points = [(start.x, start.y), *inner, (goal.x, goal.y)]
        poses = [start.as_tuple()]
        for (x0, y0), (x1, y1) in itertools.pairwise(points):
            if math.hypot(x1 - x0, y1 - y0) > 1e-6:
                yaw = math.atan2(y1 - y0, x1 - x0)
                poses += [(x0, y0, yaw), (x1, y1, yaw)]
        poses.append(goal.as_tuple())
        distinct = [pose for pose, before in zip(poses, [None, *poses], strict=False) if pose != before]
        return Path(np.array(distinct), cost=float(len(cells) - 1), planner="grid_walk")

    def _cell(self, costmap: Costmap, free: np.ndarray, pose: Pose2D, name: str) -> Cell:
        row, col = (int(index) for index in costmap.world_to_cell(pose.x, pose.y))
        if not costmap.contains(row, col):
            raise OutsideMapError(f"the {name} is outside the map", pose=pose.as_tuple())
        if not free[row, col]:
            raise BlockedPoseError(f"no room to turn at the {name}", pose=pose.as_tuple(), cell=(row, col))
        return row, col

    def _search(self, free: np.ndarray, first: Cell, last: Cell) -> list[Cell]:
        came_from: dict[Cell, Cell | None] = {last: None}
        queue = deque([last])
        while queue and first not in came_from:
            row, col = queue.popleft()
            for step in ((row + 1, col), (row - 1, col), (row, col + 1), (row, col - 1)):
                inside = 0 <= step[0] < free.shape[0] and 0 <= step[1] < free.shape[1]
                if inside and free[step] and step not in came_from:
                    came_from[step] = (row, col)
                    queue.append(step)
        if first not in came_from:
            raise NoPathError("no path from the start to the goal with room to turn")
        cells: list[Cell] = []
        cell: Cell | None = first
        while cell is not None:
            cells.append(cell)
            cell = came_from[cell]
        return cells
