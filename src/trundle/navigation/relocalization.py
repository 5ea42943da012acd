"""`Relocalization`: what a robot does while its localizer does not know where it is."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from trundle.control.sensed_points import SensedPoints
from trundle.geometry import FloatArray, Pose2D, Twist2D, wrap_angle
from trundle.navigation.state import Decision
from trundle.navigation.status import NavigationStatus
from trundle.observation import Estimate, Scan
from trundle.robots import Robot

NOT_LOCALIZED = "not localized"
"""The reason of the control periods in which the robot does not drive to its goal, as it does not know where it is."""

_STAND = Twist2D(0.0, 0.0)
_DOUBT_S = 1.0
"""So long it stands first: most doubts pass within a second, and a robot that turns at each would never arrive."""
_TURN_RADPS, _SEEK_MPS = 0.4, 0.2
"""Slow: two lidars of 10 Hz then see each direction every 2°, and the robot stops within a few centimetres."""
_SEEK_M = 2.0
"""After so far it looks around again. Hypotheses are told apart by driving; more of it is more risk."""
_FACING_RAD = 0.15
_MARGIN_M = 0.1
"""Kept clear on both sides, and around a turn."""
_AHEAD_M = 0.4
"""Kept clear ahead, for what comes the robot's way while it stops."""
_RECENT_S = 0.5
"""Older scans do not say what is free now."""
_DIRECTIONS = np.linspace(-math.pi, math.pi, 72, endpoint=False)
_BEAM_ASIDE_RAD = math.radians(3.0)
_LONGEST_M = 5.0
CORRECTED_M = 0.3
"""A pose that is farther from where the robot believed to be has put what it sensed meanwhile into wrong places."""
GIVES_UP_S = 120.0
"""So long it tries: 8 turns, and 10 m between them."""


class Relocalization:
    """Stands, turns slowly to see more, and drives a little where its scans show free space, until it is localized.

    The map says nothing then, so only what the latest scans see counts as free; a direction without a beam does not.
    What no lidar's plane crosses is not seen. A collision monitor checks the commands as it checks all others.

    Args:
        robot: The robot.

    Attributes:
        is_active: Whether the robot does not know where it is.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot, self._points = robot, SensedPoints(robot.planar)
        outline = robot.planar.outline
        self._half_width = float(np.abs(outline[:, 1]).max()) + _MARGIN_M
        self._front = float(outline[:, 0].max())
        self._radius = float(np.hypot(outline[:, 0], outline[:, 1]).max()) + _MARGIN_M
        self.reset()

    def reset(self) -> None:
        """Forget what it did so far."""
        self._points.clear()
        self._scans: dict[str, Scan] = {}
        self.is_active = False
        self._T_map_odom: Pose2D | None = None
        self._began = 0.0
        self._look_around(None)

    def corrected_m(self, estimate: Estimate) -> float:
        """How far the robot is from where it believed to be, continued by its odometry, when it lost its way [m]."""
        if self._T_map_odom is None:
            return math.inf
        return estimate.pose.distance_to(self._T_map_odom @ estimate.odom_pose)

    def decide(self, estimate: Estimate, scans: Sequence[Scan], time: float) -> Decision:
        """Say what to do in this control period.

        Args:
            estimate: What the localizer says.
            scans: Those that arrived in this period.
            time: Now [s].
        """
        if not self.is_active:
            self.is_active, self._began = True, time
            self._T_map_odom = estimate.T_map_odom
            self._look_around(None)
        odometry = estimate.odom_pose
        self._points.add(scans, time, odometry)
        self._scans.update((scan.lidar, scan) for scan in scans)
        if time - self._began > GIVES_UP_S:
            return Decision(
                _STAND,
                status=NavigationStatus.STUCK,
                message=f"the robot has not found out in {GIVES_UP_S:g} s where it is",
            )
        command = _STAND if time - self._began < _DOUBT_S else self._move(odometry, time)
        return Decision(command, message=_describe(estimate), reasons=(NOT_LOCALIZED,), restarts_progress=True)

    def _look_around(self, yaw: float | None) -> None:
        """Begin a turn at this yaw of the odometry, or at the next one."""
        self._last_yaw, self._turned = yaw, 0.0
        self._heading: float | None = None
        self._from: Pose2D | None = None

    def _move(self, odometry: Pose2D, time: float) -> Twist2D:
        if not any(scan.time >= time - _RECENT_S for scan in self._scans.values()):
            return _STAND
        hits = self._points.around(time, odometry, _LONGEST_M + self._radius, 0.0, time - _RECENT_S).places
        turns = bool((np.hypot(hits[:, 0], hits[:, 1]) > self._radius).all())
        limits = self._robot.limits
        if self._from is None:
            if self._last_yaw is not None:
                self._turned += abs(wrap_angle(odometry.yaw - self._last_yaw))
            self._last_yaw = odometry.yaw
            if turns and self._turned < 2.0 * math.pi and self._heading is None:
                return Twist2D(0.0, min(_TURN_RADPS, limits.angular_speed))
            self._heading, self._from = self._choose(hits, odometry, turns=turns), odometry
        if self._heading is None:
            self._look_around(odometry.yaw)
            return _STAND
        off = wrap_angle(self._heading - odometry.yaw)
        if abs(off) > _FACING_RAD and self._from.distance_to(odometry) < 0.05:
            return Twist2D(0.0, math.copysign(min(_TURN_RADPS, limits.angular_speed), off)) if turns else _STAND
        if self._from.distance_to(odometry) > _SEEK_M or self._free(hits, 0.0, odometry, time) < _AHEAD_M:
            self._look_around(odometry.yaw)
            return _STAND
        return Twist2D(min(_SEEK_MPS, limits.linear_speed), 0.0)

    def _choose(self, hits: FloatArray, odometry: Pose2D, *, turns: bool) -> float | None:
        """The yaw [rad], odom frame, in which the most space was seen; None where there is none to drive."""
        time = max(scan.time for scan in self._scans.values())
        headings = _DIRECTIONS if turns else np.zeros(1)
        free = [self._free(hits, float(heading), odometry, time) for heading in headings]
        best = int(np.argmax(free))
        return wrap_angle(odometry.yaw + float(headings[best])) if free[best] > 2.0 * _AHEAD_M else None

    def _free(self, hits: FloatArray, heading: float, odometry: Pose2D, time: float) -> float:
        """How far the robot's front may go in a direction [rad], base_link, without touching a hit [m]."""
        if not self._sees(heading, time):
            return 0.0
        cos, sin = math.cos(heading), math.sin(heading)
        along, aside = hits @ (cos, sin), hits @ (-sin, cos)
        within = along[(np.abs(aside) < self._half_width) & (along > 0.0)]
        return min(_LONGEST_M, float(within.min()) if len(within) else _LONGEST_M) - self._front

    def _sees(self, heading: float, time: float) -> bool:
        """Whether a lidar has a beam in this direction that measured something, or nothing within its range."""
        for scan in self._scans.values():
            if scan.time < time - _RECENT_S:
                continue
            off = np.abs(np.remainder(scan.angles + scan.mount.yaw - heading + math.pi, 2.0 * math.pi) - math.pi)
            if (scan.ranges[off < _BEAM_ASIDE_RAD] > 0.0).any():
                return True
        return False


def _describe(estimate: Estimate) -> str:
    if estimate.state == "ambiguous":
        places = f"at one of {len(estimate.hypotheses)} places" if len(estimate.hypotheses) > 1 else "not sure where"
        return f"the robot is {places}: looking around"
    return "the robot does not know where it is: looking around"
