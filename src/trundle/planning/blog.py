"""`BlogPlanner`: the planner of the post that this project began with, by name `blog`."""

from __future__ import annotations

import numpy as np

from trundle import _core
from trundle.costmap import LETHAL, NO_INFORMATION, Costmap
from trundle.errors import BlockedPoseError, NoPathError, OutsideMapError
from trundle.geometry import FloatArray, Pose2D
from trundle.path import Path
from trundle.planning.motions import motions_along, poses_of

_WEIGHTS = np.ones(256, dtype=np.uint16)
_WEIGHTS[LETHAL:] = 0


class BlogPlanner:
    """4-connected A* with Manhattan heuristic and unit cost, for comparison.

    Only occupied and unknown cells block: it knows neither inflation nor footprint, so its ways scrape along walls.
    """

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D) -> Path:
        """Plan from `start` to `goal`, poses in the map frame.

        Raises:
            OutsideMapError: If the start or the goal lies outside the map.
            BlockedPoseError: If one of them lies in an occupied or unknown cell.
            NoPathError: If no way joins them.
        """
        first, last = _free_cell(costmap, start, "start"), _free_cell(costmap, goal, "goal")
        cells, _ = _core.grid_search(costmap.data, _WEIGHTS, first, last, 4)
        if len(cells) == 0:
            raise NoPathError(
                f"no path from ({start.x:.2f}, {start.y:.2f}) to ({goal.x:.2f}, {goal.y:.2f}): they are separated by "
                "occupied or unknown space",
                pose=goal.as_tuple(),
                cell=last,
            )
        centres = np.column_stack(costmap.cell_to_world(cells[:, 0], cells[:, 1]))
        vertices: FloatArray = np.concatenate([[[start.x, start.y]], centres[1:-1], [[goal.x, goal.y]]])
        motions = motions_along(vertices, start.yaw, goal.yaw)
        poses = poses_of(motions, np.array(start.as_tuple()), np.array(goal.as_tuple()), 2.0 * costmap.resolution)
        path = Path(poses, planner="blog")
        return Path(poses, cost=path.length, planner="blog")


def _free_cell(costmap: Costmap, pose: Pose2D, what: str) -> tuple[int, int]:
    row, col = (int(index) for index in costmap.world_to_cell(pose.x, pose.y))
    if not costmap.contains(row, col):
        raise OutsideMapError(
            f"the {what} ({pose.x:.2f}, {pose.y:.2f}) lies outside the map", pose=pose.as_tuple(), cell=(row, col)
        )
    if costmap.data[row, col] < LETHAL:
        return row, col
    where = "unknown space" if costmap.data[row, col] == NO_INFORMATION else "an obstacle"
    rows, cols = np.nonzero(costmap.data < LETHAL)
    x, y = costmap.cell_to_world(rows, cols)
    nearest = float(np.hypot(x - pose.x, y - pose.y).min()) if len(rows) else None
    hint = "no cell of the map is free" if nearest is None else f"the nearest free cell is {nearest:.2f} m away"
    raise BlockedPoseError(
        f"the {what} ({pose.x:.2f}, {pose.y:.2f}) lies in {where}; {hint}",
        pose=pose.as_tuple(),
        cell=(row, col),
        nearest_free_m=nearest,
    )
