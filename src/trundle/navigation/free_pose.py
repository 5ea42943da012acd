"""`nearest_free_pose`: where a robot can stand near a pose that something occupies."""

from __future__ import annotations

import numpy as np

from trundle.costmap import INSCRIBED, Costmap
from trundle.geometry import Pose2D

_STEP_M = 0.05
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
