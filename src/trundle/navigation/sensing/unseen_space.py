"""`slow_down_in_unseen`: no command is faster than allows a stop within the space that was seen to be free."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from trundle.control.collision import can_stop
from trundle.costmap import LETHAL, Costmap
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.robots import Limits

_SLOWER = (1.0, 0.75, 0.5, 0.25, 0.1)
_CREEP_MPS = 0.05
_CREEP_RADPS = 0.2
_MARGIN_M = 0.2
_HIDDEN_CELLS = 1.5


def slow_down_in_unseen(
    costmap: Costmap, limits: Limits, pose: Pose2D, twist: Twist2D, command: Twist2D, dt: float, *, padded: FloatArray
) -> Twist2D:
    """The same arc, as slow as it takes to stop before the first cell that was never seen.

    Where it stands, and in what it hides from its own lidars there, nothing is taken to be in its way.

    Where no share of the command does, the robot creeps, at 0.05 m/s and 0.2 rad/s at most: it then stops within a few
    millimetres, and what its lidars cannot see from where it stands does not hold it for ever.

    Args:
        costmap: Where it drives; without `unseen` cells the command stays as it is.
        limits: Of the robot.
        pose: Where it is, map frame.
        twist: How it moves, base_link.
        command: The command.
        dt: For how long it is sent [s].
        padded: The footprint's outline [m], base_link, widened by the clearance to keep.
    """
    if costmap.unseen is None or command == Twist2D():
        return command
    fastest = max(abs(command.v), abs(twist.v))
    stop_m = fastest * (dt + fastest / (2.0 * limits.linear_acceleration))
    near = _seen_around(costmap, pose, costmap.circumscribed_radius + stop_m + _MARGIN_M)
    if near is None:
        return command
    for share in _SLOWER:
        slower = Twist2D(share * command.v, share * command.w)
        if can_stop(near, limits, pose, twist, slower, dt, padded=padded):
            return slower
    share = min(1.0, _CREEP_MPS / max(abs(command.v), 1e-9), _CREEP_RADPS / max(abs(command.w), 1e-9))
    return Twist2D(share * command.v, share * command.w)


def _stood_on(costmap: Costmap, pose: Pose2D, rows: slice, cols: slice) -> npt.NDArray[np.bool_]:
    """Cells that the robot stands on or hides from its lidars: whose centre is within its outline, or a cell beside."""
    row, col = np.mgrid[rows, cols]
    x, y = costmap.cell_to_world(row, col)
    dx, dy = x - pose.x, y - pose.y
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    ahead, left = cos * dx + sin * dy, cos * dy - sin * dx
    corners = costmap.planar.padded(_HIDDEN_CELLS * costmap.resolution).outline
    inside = np.ones(row.shape, np.bool_)
    for (x0, y0), (x1, y1) in zip(corners.tolist(), np.roll(corners, -1, axis=0).tolist(), strict=True):
        inside &= (x1 - x0) * (left - y0) - (y1 - y0) * (ahead - x0) >= 0.0
    return inside


def _seen_around(costmap: Costmap, pose: Pose2D, reach: float) -> Costmap | None:
    """The part of a costmap around a pose, with unseen cells occupied; None if all of it was seen."""
    if costmap.unseen is None:
        return None
    row, col = (int(index) for index in costmap.world_to_cell(pose.x, pose.y))
    cells = int(reach / costmap.resolution) + 1
    rows, cols = (slice(max(0, at - cells), max(0, at + cells + 1)) for at in (row, col))
    unseen = costmap.unseen[rows, cols]
    if not unseen.any():
        return None
    unseen = unseen & ~_stood_on(costmap, pose, rows, cols)
    corner = Pose2D(cols.start * costmap.resolution, rows.start * costmap.resolution)
    planar: FloatArray = costmap.planar  # type: ignore[assignment]  # taken as it is
    return Costmap(
        np.where(unseen, np.uint8(LETHAL), costmap.data[rows, cols]),
        costmap.resolution,
        costmap.origin @ corner,
        planar,
        costmap.inflation_radius,
        costmap.cost_scaling_factor,
    )
