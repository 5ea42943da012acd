"""Where a plan starts and ends: beside what occupies a pose, `free_ends`; in a moving window, `goal_in_window`."""

from __future__ import annotations

import math

import numpy as np

from trundle._core import label_components
from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import BlockedPoseError
from trundle.geometry import Goal, Pose2D

_STEP_M = 0.05
_START_OFF_M = 0.35  # as far as something may push a robot into what it sees; less than across anything
_STOPS_WITHIN_M = 0.05
_YAWS = np.arange(16) * (np.pi / 8.0)


def nearest_free_pose(costmap: Costmap, pose: Pose2D, within_m: float, *, any_yaw: bool = False) -> Pose2D | None:
    """The pose nearest to one where the footprint touches nothing, on a grid of 5 cm; None if there is none.

    Args:
        costmap: Where it stands.
        pose: Where it should stand, map frame.
        within_m: How far off the free pose may be [m].
        any_yaw: Whether any yaw will do; it is tried in 16 directions, and the given one stays where it fits.
    """
    count = int(within_m / _STEP_M + 1e-9)
    steps = np.arange(-count, count + 1) * _STEP_M
    dx, dy = (part.ravel() for part in np.meshgrid(steps, steps))
    distances = np.hypot(dx, dy)
    near = np.flatnonzero(distances <= within_m + 1e-9)
    near = near[distances[near].argsort(kind="stable")]
    x, y = pose.x + dx[near], pose.y + dy[near]
    reachable = np.flatnonzero(costmap.cost_at(x, y) < INSCRIBED)
    yaws = np.concatenate([[pose.yaw], pose.yaw + _YAWS[1:]]) if any_yaw else np.array([pose.yaw])
    for index in reachable.tolist():
        poses = np.column_stack([np.full(len(yaws), x[index]), np.full(len(yaws), y[index]), yaws])
        free = np.flatnonzero(~costmap.footprint_collides(poses))
        if len(free):
            return Pose2D(float(x[index]), float(y[index]), float(yaws[free[0]]))
    return None


def free_ends(
    costmap: Costmap, static: Costmap | None, start: Pose2D, goal: Goal, tolerance_m: float
) -> tuple[Pose2D, Goal]:
    """Where to plan from and to: beside the robot and the goal, where what was sensed is too close to them.

    Args:
        costmap: With what was sensed.
        static: Without that; None without a map. A goal that is occupied there is left to the planner.
        start: Where the robot is, map frame.
        goal: The goal.
        tolerance_m: How far from the goal the robot may stop [m].

    Raises:
        BlockedPoseError: If the goal is occupied by something that is not on the map.
    """
    if costmap.footprint_collides(start.as_tuple())[0]:
        start = nearest_free_pose(costmap, start, _START_OFF_M) or start
    if not _is_occupied(costmap, goal) or (static is not None and _is_occupied(static, goal)):
        return start, goal
    found = nearest_free_pose(costmap, goal.pose, max(0.0, tolerance_m - _STOPS_WITHIN_M), any_yaw=goal.yaw_free)
    if found is None:
        raise BlockedPoseError(
            f"the goal ({goal.pose.x:.2f}, {goal.pose.y:.2f}) is occupied by something that is not on the map, and the "
            f"robot does not fit anywhere within the tolerance of {tolerance_m:g} m; clear it, or choose another goal",
            pose=goal.pose.as_tuple(),
        )
    return start, Goal(found.x, found.y, None if goal.yaw_free else found.yaw)


def _is_occupied(costmap: Costmap, goal: Goal) -> bool:
    if goal.yaw_free:
        return int(costmap.cost_at(goal.pose.x, goal.pose.y)) >= INSCRIBED
    return bool(costmap.footprint_collides(goal.pose.as_tuple())[0])


_FROM_EDGE_M = 0.1
_COST_M = 1.0  # a place at an obstacle counts as so much farther away from the goal


def goal_in_window(costmap: Costmap, start: Pose2D, goal: Goal) -> Goal:
    """The goal itself where the costmap contains it, otherwise the place nearest to it that the robot can get to.

    That is judged by the inscribed circle and in a straight line, so a window has dead ends that a map does not have.

    Args:
        costmap: The window.
        start: Where the robot is, map frame.
        goal: Where it is to go.

    Returns:
        A goal within the costmap, to be reached with any yaw where it is not the goal itself; the goal itself also
        where the robot cannot get anywhere.
    """
    edge = math.ceil((costmap.circumscribed_radius + _FROM_EDGE_M) / costmap.resolution)
    rows, cols = costmap.shape
    row, col = (int(index) for index in costmap.world_to_cell(goal.x, goal.y))
    if edge <= row < rows - edge and edge <= col < cols - edge:
        return goal
    labels, _ = label_components((costmap.data < INSCRIBED).view(np.uint8), diagonal=False)
    row, col = (int(index) for index in costmap.world_to_cell(start.x, start.y))
    if not costmap.contains(row, col) or labels[row, col] == 0:
        return goal
    inner = labels[edge : rows - edge, edge : cols - edge]
    places = np.argwhere(inner == labels[row, col]) + edge
    if len(places) == 0:
        return goal
    x, y = costmap.cell_to_world(places[:, 0], places[:, 1])
    cost = costmap.data[places[:, 0], places[:, 1]] / (INSCRIBED - 1)
    nearest = int((np.hypot(x - goal.x, y - goal.y) + _COST_M * cost).argmin())
    return Goal(float(x[nearest]), float(y[nearest]))
