"""The query of a planner, and the errors that say why there is no path."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from trundle import _core
from trundle.costmap import INSCRIBED, LETHAL, Costmap
from trundle.errors import NoPathError, PlanningStoppedError
from trundle.geometry import FloatArray
from trundle.planning.cancellation import Patience
from trundle.planning.motions import Motion, motions_along
from trundle.planning.queries.ends import End, place_to_turn


@dataclass(frozen=True, slots=True)
class Query:
    """The query of a plan.

    Attributes:
        costmap: What to stay clear of.
        start: Where the robot stands.
        goal: Where it is to stand.
        leave: Where the search begins: the start, or a place straight ahead of it.
        enter: Where the search ends: the goal, or a place straight behind it.
        yaw_free: Whether it may end with any yaw.
    """

    costmap: Costmap
    start: End
    goal: End
    leave: End
    enter: End
    yaw_free: bool

    def motions(self, vertices: FloatArray) -> list[Motion]:
        """Return motions from the start along the vertices from `leave` to `enter`, and on to the goal."""
        start, goal = self.start.pose, self.goal.pose
        corners = np.concatenate([[[start.x, start.y]], vertices, [[goal.x, goal.y]]])
        return motions_along(corners, start.yaw, None if self.yaw_free else goal.yaw)

    @property
    def ends(self) -> str:
        """Both ends in words, for messages."""
        start, goal = self.start.pose, self.goal.pose
        return f"from ({start.x:.2f}, {start.y:.2f}) to ({goal.x:.2f}, {goal.y:.2f})"

    def with_straight_ends(self) -> Query | None:
        """Return the query straight out of a start and into a goal where the robot cannot turn; None where it can."""
        leave = place_to_turn(self.costmap, self.start, 1.0)
        enter = self.goal if self.yaw_free else place_to_turn(self.costmap, self.goal, -1.0)
        straight = replace(self, leave=leave, enter=enter)
        return None if straight == self else straight


def cell_at(costmap: Costmap, x: float, y: float) -> tuple[int, int]:
    """Return the (row, col) that holds a point [m] of the map frame."""
    row, col = costmap.world_to_cell(x, y)
    return int(row), int(col)


def none_found(query: Query, hit: FloatArray, replans: int) -> PlanningStoppedError:
    """Make the error for a footprint that collides on every path tried, on the last one at a pose (x, y, yaw).

    There may be another path: only some were tried, all of them driven forwards.
    """
    x, y, yaw = hit.tolist()
    return PlanningStoppedError(
        f"no path {query.ends}: none found within {replans + 1} plan{'s' if replans else ''}; the footprint hits "
        f"something on each, on the last at ({x:.2f}, {y:.2f}, {math.degrees(yaw):.0f}°); planner auto or hybrid_astar "
        "also searches paths that are driven backwards",
        pose=(x, y, yaw),
        cell=cell_at(query.costmap, x, y),
        status="exhausted",
    )


def no_path(query: Query, patience: Patience) -> NoPathError:
    """Make the error for ends that no path of the inscribed circle connects.

    Raises:
        PlanningStoppedError: If patience ends before the reason is known.
    """
    costmap, start, goal = query.costmap, query.leave, query.enter
    # For a point, with as few steps as possible through what is too narrow for the robot.
    weights = np.ones(256, dtype=np.uint16)
    weights[INSCRIBED], weights[LETHAL:] = 10_000, 0
    cells, cost = _core.grid_search(costmap.data, weights, start.cell, goal.cell, 4, patience.seconds, patience.flag)
    if len(cells) == 0:
        if math.isnan(cost):
            patience.check()
        return NoPathError(
            f"no path {query.ends}: they are separated by occupied or unknown space, and no robot could get there",
            pose=goal.pose.as_tuple(),
            cell=goal.cell,
        )
    narrow = np.flatnonzero(costmap.data[cells[:, 0], cells[:, 1]] == INSCRIBED)
    first_gap = narrow[: int(np.argmax(np.diff(narrow, append=len(cells) + 2) > 1)) + 1]
    row, col = (int(index) for index in cells[first_gap[len(first_gap) // 2]])
    x, y = costmap.cell_to_world(row, col)
    return NoPathError(
        f"no path {query.ends}: a path exists for a point, but this robot is too wide for it at ({x:.2f}, {y:.2f}); "
        f"its inscribed circle alone needs {2.0 * costmap.inscribed_radius:.2f} m",
        pose=(float(x), float(y), 0.0),
        cell=(row, col),
    )
