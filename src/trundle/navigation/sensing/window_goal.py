"""`goal_in_window`: where to drive while the goal lies outside of a costmap that moves with the robot."""

from __future__ import annotations

import math

import numpy as np

from trundle._core import label_components
from trundle.costmap import INSCRIBED, Costmap
from trundle.geometry import Goal, Pose2D

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
