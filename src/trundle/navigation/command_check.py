"""What of a command may be sent: `CommandCheck`, with `slow_down_in_unseen`; by hand, `assist_teleop`.

`SpeedLimiter` says how fast the robot may drive now, so that it keeps the limits of a speed mask here and ahead;
`limits_along` and `fastest_s` say the same of a whole path before anything moves.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle.control.collision import FOOTPRINT_PADDING_M, can_stop
from trundle.costmap import LETHAL, Costmap
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.maps.masks import SpeedMask
from trundle.navigation.progress import FollowedPath
from trundle.navigation.sensing import SensedMap
from trundle.navigation.state import Snapshot
from trundle.path import Path
from trundle.planning import PathCheck
from trundle.robots import Limits, Robot

BRAKING_SHARE = 0.5
"""Share of the robot's deceleration that is used to slow down to a limit ahead."""

BESIDE_M = 0.1
"""A limit this far beside the path [m] counts too: controllers cut corners."""

_STEP_M = 0.025  # half of a usual cell, so that no cell of a mask is skipped
_FARTHEST_M = 1000.0
_DRIVING_MPS = 0.05  # slower, the robot counts as standing: the curvature w / v would be noise

_SLOWER = (1.0, 0.75, 0.5, 0.25, 0.1)
"""Shares of a command that are tried, the fastest first: few, as each costs a check of the footprint's sweep."""
_CREEP_MPS, _CREEP_RADPS = 0.05, 0.2
"""So slowly the robot drives into what it cannot see [m/s, rad/s]; it then stops within a few millimetres."""
_MARGIN_M = 0.2  # added to what it may touch while it stops, to cut that part out of the costmap
_HIDDEN_CELLS = 1.5
"""So many cells round its footprint a robot hides from its lidars; taken as unseen, they made it creep at a start."""


class CommandCheck:
    """Checks the commands of a controller, of a behavior, and by hand.

    Args:
        robot: The robot.
        sensed: The costmap with what its scans saw.
        limiter: Limits speeds by the speed mask; None without one.
        dt: Control period [s].

    Attributes:
        speed_limit: What the speed mask allowed when it was last asked [m/s], infinite where it limits nothing.
    """

    def __init__(self, robot: Robot, sensed: SensedMap, limiter: SpeedLimiter | None, dt: float) -> None:
        self._robot, self._sensed, self._limiter, self._dt = robot, sensed, limiter, dt
        self._padded = robot.planar.padded(FOOTPRINT_PADDING_M).outline
        self.begin()

    def begin(self) -> None:
        """Forget the last speed limit: there is another goal."""
        self.speed_limit = math.inf

    def set_path(self, followed: FollowedPath) -> None:
        """Look ahead along this path from now on."""
        if self._limiter is not None:
            self._limiter.set_path(followed.check)

    def limit_speed(self, now: Snapshot, followed: FollowedPath | None, *, backwards: bool = False) -> float | None:
        """Return the speed [m/s] that the mask allows here and ahead on the path; None without a mask."""
        if self._limiter is None:
            return None
        index = 0 if followed is None else followed.index
        self.speed_limit = self._limiter.limit(now.pose, now.twist, index, self._dt, backwards=backwards)
        return self.speed_limit

    def slow_down(self, command: Twist2D, now: Snapshot, followed: FollowedPath | None) -> Twist2D:
        """Return the same arc within the speed limit of now, and within what was seen."""
        self.limit_speed(now, followed, backwards=command.v < 0.0)
        return self.cut(command, now)

    def cut(self, command: Twist2D, now: Snapshot) -> Twist2D:
        """Return the same arc within the last speed limit, and within what was seen."""
        command = slow_down(command, self.speed_limit)
        if not self._sensed.is_active:
            return command
        limits = self._robot.limits
        return slow_down_in_unseen(now.costmap, limits, now.pose, now.twist, command, self._dt, padded=self._padded)

    def can_stop(self, command: Twist2D, now: Snapshot) -> bool:
        """Return whether a command leaves the robot room to stop before it touches something."""
        limits = self._robot.limits
        return can_stop(now.costmap, limits, now.pose, now.twist, command, self._dt, padded=self._padded)


@dataclass(frozen=True, slots=True)
class AssistedCommand:
    """What may be sent of a command by hand.

    Attributes:
        command: The same arc, as fast as it may be driven; (0, 0) where it may not.
        reason: What held it back; empty where nothing did.
    """

    command: Twist2D
    reason: str = ""


def assist_teleop(
    wish: Twist2D, allowed: Twist2D, can_stop: Callable[[Twist2D], bool], obstacle: str
) -> AssistedCommand:
    """Slow a command by hand down until the robot can stop before it touches something, after Nav2's AssistedTeleop.

    Args:
        wish: The command, within the robot's limits.
        allowed: The same arc within the speed limit, and within what was seen.
        can_stop: Whether a command leaves the robot room to stop.
        obstacle: What it would touch, for the reason.
    """
    for share in _SLOWER:
        slower = Twist2D(share * allowed.v, share * allowed.w)
        if can_stop(slower):
            if share < 1.0:
                return AssistedCommand(slower, f"slowed down before {obstacle}")
            return AssistedCommand(slower, "" if slower == wish else "slowed down by a speed limit or unseen space")
    return AssistedCommand(Twist2D(), f"stopped before {obstacle}")


def slow_down_in_unseen(
    costmap: Costmap, limits: Limits, pose: Pose2D, twist: Twist2D, command: Twist2D, dt: float, *, padded: FloatArray
) -> Twist2D:
    """Return the same arc, as slow as it takes to stop before the first cell that was never seen.

    Where it stands, and in what it hides from its own lidars there, nothing is taken to be in its way.

    Where no share of the command does, the robot creeps, at 0.05 m/s and 0.2 rad/s at most: it then stops within a few
    millimetres, and what its lidars cannot see from where it stands does not hold it for ever.

    Args:
        costmap: Where it drives; without `unseen` cells the command stays as it is.
        limits: Limits of the robot.
        pose: Where it is, map frame.
        twist: How it moves, base_link.
        command: The command.
        dt: Time for which the command is sent [s].
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
    """Return the part of a costmap around a pose, with unseen cells occupied; None if all of it was seen."""
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


# The speed mask -------------------------------------------------------------------------------------------------------


class SpeedLimiter:
    """The limit at the robot's base_link, and ahead as far as it needs to brake.

    Ahead is along the path, 0.1 m to both sides of it, and along the arc that the robot drives now.

    Args:
        mask: The limits.
        robot: Its top speed, of which the limits are a share, and its deceleration count.
    """

    def __init__(self, mask: SpeedMask, robot: Robot) -> None:
        self._mask = mask
        self._top_speed = robot.limits.linear_speed
        self._braking = BRAKING_SHARE * robot.limits.linear_acceleration
        self._check: PathCheck | None = None
        self._limits: FloatArray = np.zeros(0)

    def set_path(self, check: PathCheck) -> None:
        """Look ahead along this path from now on."""
        self._check, self._limits = check, limits_along(check.poses, self._mask, self._top_speed)

    def limit(self, pose: Pose2D, twist: Twist2D, index: int, dt: float, *, backwards: bool = False) -> float:
        """Return the speed [m/s] that may be driven for `dt` [s]; infinite where nothing limits it.

        Args:
            pose: Where the robot is, map frame.
            twist: How it moves, base_link.
            index: Position on the path: the index of the `PathCheck`'s pose.
            dt: Control period [s].
            backwards: Whether the next command drives backwards.
        """
        braking_m = self._top_speed * (dt + self._top_speed / (2.0 * self._braking))
        reach = min(braking_m, _FARTHEST_M) + BESIDE_M + _STEP_M
        s = np.arange(0.0, reach + _STEP_M, _STEP_M)
        x, y = _arc(pose, twist, -s if backwards or twist.v < -_DRIVING_MPS else s)
        limits, distances = self._mask.limit_at(x, y, self._top_speed), s - _STEP_M
        if self._check is not None:
            along = self._check.along
            ahead = slice(index, int(along.searchsorted(float(along[index]) + reach)) + 1)
            places = self._check.poses[ahead, :2]
            # No path to a place is shorter than the straight line.
            straight = np.hypot(places[:, 0] - pose.x, places[:, 1] - pose.y)
            limits = np.concatenate([limits, self._limits[ahead]])
            distances = np.concatenate([distances, straight - BESIDE_M - _STEP_M])
        some = np.isfinite(limits)
        return float(self._allow(limits[some], distances[some], dt).min()) if some.any() else math.inf

    def _allow(self, limits: FloatArray, distances: FloatArray, dt: float) -> FloatArray:
        """Return speeds v with v² = limit² + 2 · braking · (distance − v · dt), and the limit where v is below it."""
        step = self._braking * dt
        room = np.maximum(distances - limits * dt, 0.0)
        return np.sqrt((limits + step) ** 2 + 2.0 * self._braking * room) - step


def slow_down(command: Twist2D, limit: float) -> Twist2D:
    """Return the same arc within a speed limit [m/s]."""
    if abs(command.v) <= limit:
        return command
    share = limit / abs(command.v)
    return Twist2D(share * command.v, share * command.w)


def limits_along(poses: FloatArray, mask: SpeedMask, top_speed: float) -> FloatArray:
    """Return limits [m/s] at poses (x, y, yaw) [m, m, rad], and 0.1 m to both sides of each: the least of the three.

    Args:
        poses: Map frame, shape (N, 3).
        mask: The limits.
        top_speed: The robot's [m/s].

    Returns:
        Shape (N,); infinite where nothing limits the speed.
    """
    x, y, yaw = poses[:, 0], poses[:, 1], poses[:, 2]
    beside = np.array([[-BESIDE_M], [0.0], [BESIDE_M]])
    limits: FloatArray = mask.limit_at(x - beside * np.sin(yaw), y + beside * np.cos(yaw), top_speed).min(axis=0)
    return limits


def fastest_s(path: Path, robot: Robot, mask: SpeedMask | None) -> float:
    """Driving time [s] of a path at the robot's top speed, or at the mask's limits; turns in place not counted."""
    top = robot.limits.linear_speed
    if mask is None:
        return path.length / top
    check = PathCheck(path)
    speeds = np.minimum(limits_along(check.poses, mask, top), top)
    return float((np.diff(check.along) / np.minimum(speeds[1:], speeds[:-1])).sum())


def _arc(pose: Pose2D, twist: Twist2D, s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return where the robot is [m] after s [m] on its present arc; straight on if it stands or turns in place."""
    curvature = twist.w / twist.v if abs(twist.v) > _DRIVING_MPS else 0.0
    if abs(curvature) < 1e-6:
        return pose.x + s * math.cos(pose.yaw), pose.y + s * math.sin(pose.yaw)
    yaw = pose.yaw + curvature * s
    return (
        pose.x + (np.sin(yaw) - math.sin(pose.yaw)) / curvature,
        pose.y - (np.cos(yaw) - math.cos(pose.yaw)) / curvature,
    )
