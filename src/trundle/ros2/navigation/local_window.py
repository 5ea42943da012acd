"""`local_window`: the part of a costmap around the robot, which stands for Nav2's local costmap."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle.costmap import NO_INFORMATION, Costmap
from trundle.geometry import Pose2D

WINDOW_M = 3.0
"""Width and height of Nav2's local costmap by default [m]."""


def local_window(costmap: Costmap, pose: Pose2D, size: float = WINDOW_M) -> tuple[npt.NDArray[np.uint8], Pose2D]:
    """Costs in a square around a pose, aligned with the costmap, and the pose of its lower left corner.

    Cells outside the costmap are unknown.

    Args:
        costmap: The costmap.
        pose: Where the robot is, map frame.
        size: Edge of the square [m].
    """
    cells = max(1, round(size / costmap.resolution))
    row, col = (int(index) - cells // 2 for index in costmap.world_to_cell(pose.x, pose.y))
    window = np.full((cells, cells), NO_INFORMATION, np.uint8)
    rows, cols = costmap.shape
    low, high = (max(0, row), max(0, col)), (min(rows, row + cells), min(cols, col + cells))
    if low[0] < high[0] and low[1] < high[1]:
        inside = slice(low[0] - row, high[0] - row), slice(low[1] - col, high[1] - col)
        window[inside] = costmap.data[low[0] : high[0], low[1] : high[1]]
    corner = Pose2D(col * costmap.resolution, row * costmap.resolution)
    return window, costmap.origin @ corner
