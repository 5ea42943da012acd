"""`ManhattanAstarPlanner`: 4-connected A* that knows no footprint, by name `manhattan_astar`."""

from __future__ import annotations

import math

import numpy as np

from trundle import _core
from trundle.costmap import LETHAL, NO_INFORMATION, Costmap
from trundle.errors import BlockedPoseError, NoPathError, OutsideMapError
from trundle.geometry import FloatArray, Goal, Pose2D
from trundle.path import Path
from trundle.planning.cancellation import Patience
from trundle.planning.grid.grid_search import GridSearch
from trundle.planning.motions import motions_along, poses_of
from trundle.planning.queries.ends import REACH_CELLS, cells_near
from trundle.planning.queries.query import QueryPlanner
from trundle.values import check_flag

_WEIGHTS = np.ones(256, dtype=np.uint16)
_WEIGHTS[LETHAL:] = 0


class ManhattanAstarPlanner(QueryPlanner):
    """4-connected A* with the Manhattan heuristic and unit cost, as many tutorials have it, for comparison.

    Only occupied and unknown cells block: inflation and footprint are ignored, so its paths touch walls.

    Args:
        allow_partial: Where the goal cannot be reached, or is blocked, plan to the reachable cell nearest to it.
        deadline_s: Give up after this time [s]. If None, plan as long as it takes.

    Raises:
        InputError: If an option is out of range.
    """

    def __init__(self, *, allow_partial: bool = False, deadline_s: float | None = None) -> None:
        super().__init__(deadline_s)
        self._allow_partial = check_flag("allow_partial", allow_partial)

    def _plan(self, costmap: Costmap, start: Pose2D, goal: Goal, patience: Patience) -> Path:
        end = goal.pose
        first, last = _cell_at(costmap, start, "start"), _cell_at(costmap, end, "goal")
        _check_free(costmap, start, first, "start")
        if not self._allow_partial:
            _check_free(costmap, end, last, "goal")
        target = GridSearch(costmap.data >= LETHAL, 4).nearest_reachable(first, last) if self._allow_partial else last
        cells, cost = _core.grid_search(costmap.data, _WEIGHTS, first, target, 4, patience.seconds, patience.flag)
        if len(cells) == 0:
            if math.isnan(cost):
                patience.check()
            raise NoPathError(
                f"no path from ({start.x:.2f}, {start.y:.2f}) to ({goal.x:.2f}, {goal.y:.2f}): they are separated by "
                "occupied or unknown space",
                pose=goal.as_tuple(),
                cell=last,
            )
        if target != last:
            x, y = costmap.cell_to_world(*target)
            end = start if target == first else Pose2D(float(x), float(y), end.yaw)
        centres = np.column_stack(costmap.cell_to_world(cells[:, 0], cells[:, 1]))
        vertices: FloatArray = np.concatenate([[[start.x, start.y]], centres[1:-1], [[end.x, end.y]]])
        motions = motions_along(vertices, start.yaw, None if goal.yaw_free else end.yaw)
        if goal.yaw_free:  # it ends as it arrives
            end = Pose2D(end.x, end.y, motions[-1].yaw if motions else start.yaw)
        poses = poses_of(motions, np.array(start.as_tuple()), np.array(end.as_tuple()), 2.0 * costmap.resolution)
        return Path(
            poses,
            cost=Path(poses).length,
            planner="manhattan_astar",
            status="found" if target == last else "partial",
            remaining_m=0.0 if target == last else end.distance_to(goal),
        )


def _cell_at(costmap: Costmap, pose: Pose2D, what: str) -> tuple[int, int]:
    row, col = (int(index) for index in costmap.world_to_cell(pose.x, pose.y))
    if costmap.contains(row, col):
        return row, col
    raise OutsideMapError(
        f"the {what} ({pose.x:.2f}, {pose.y:.2f}) lies outside the map", pose=pose.as_tuple(), cell=(row, col)
    )


def _check_free(costmap: Costmap, pose: Pose2D, cell: tuple[int, int], what: str) -> None:
    if costmap.data[cell] < LETHAL:
        return
    where = "unknown space" if costmap.data[cell] == NO_INFORMATION else "an obstacle"
    reach = REACH_CELLS * costmap.resolution
    distances = cells_near(costmap, pose, reach, LETHAL)[2]
    nearest = float(distances[0]) if len(distances) else None
    hint = (
        f"no cell within {reach:g} m is free" if nearest is None else f"the nearest free cell is {nearest:.2f} m away"
    )
    raise BlockedPoseError(
        f"the {what} ({pose.x:.2f}, {pose.y:.2f}) lies in {where}; {hint}",
        pose=pose.as_tuple(),
        cell=cell,
        nearest_free_m=nearest,
    )
