"""`Relocalization`: what a robot does while its localizer does not know where it is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trundle.control.sensed_points import Edges, SensedPoints
from trundle.geometry import FloatArray, Pose2D, Twist2D, wrap_angle
from trundle.navigation.state import Decision, NavigationStatus
from trundle.observation import Estimate, Scan
from trundle.robots import Robot

NOT_LOCALIZED = "not localized"
"""The reason of the control periods in which the robot does not drive to its goal, as it does not know where it is."""

_STAND = Twist2D(0.0, 0.0)
_DOUBT_S = 1.0
"""So long it stands first: most doubts pass within a second, and a robot that turns at each would never arrive."""
_TURN_RADPS, _SEEK_MPS = 0.6, 0.5
"""Slow: two lidars of 10 Hz then see each direction every 3.5°, and the robot stops within a few centimetres."""
_ENOUGH_RAD = 1.3
"""A robot that sees all round turns so far: it sees nothing new by that, but hypotheses part by turning, too."""
_SEEK_M = 2.0
"""After so far it looks around again. Hypotheses are told apart by driving; more of it is more risk."""
_MARGIN_M = 0.1
"""Kept clear all round, where the robot does not stand nearer to something already."""
_LEAST_M, _AHEAD_M = 0.5, 0.4
"""It sets off where it sees so much room, and drives on while it sees so much: something may come its way."""
_FACING_RAD, _LEAST_TURN_RAD = 0.05, 0.2
_BACK_COST_M, _RETURN_COST_M, _TURN_COST_M = 0.5, 1.5, 0.1
"""Room that is worth less: behind the robot, where it has come from (within 1 rad), and for each rad to turn."""
_RECENT_S = 0.5
"""Older scans do not say what is free now."""
_TURNS = np.radians(np.arange(5.0, 181.0, 5.0))
_STEPS_M = np.arange(0.1, 3.01, 0.1)
_BEAM_ASIDE_RAD = math.radians(3.0)
CORRECTED_M = 0.3
"""A pose that is farther from where the robot believed to be has put what it sensed meanwhile into wrong places."""
_IN_VAIN, _SAME_PLACE_M = 3, 1.5
"""After so many doubts within so far [m] that all ended where the robot believed to be, it drives on through the next.

Things that are on the map alone, or in the world alone, may look doubtful from one yaw only: a robot that turned to its
path, doubted, turned back to look and turned to its path again did so for 90 s.
"""
GIVES_UP_S = 120.0
"""So long it tries: about 25 m at the speed at which it looks around."""


class Relocalization:
    """Stands, turns slowly to see more, and drives a little where its scans show free space, until it is localized.

    The map says nothing then, so only what the latest scans see counts as free; a direction without a beam does not.
    What no lidar's plane crosses is not seen. It turns as far as its footprint has room, drives forward or backward to
    where it sees the most, and rather not back to where it came from. A collision monitor checks the commands as it
    checks all others.

    Args:
        robot: The robot.

    Attributes:
        is_active: Whether the robot does not know where it is.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot, self._points = robot, SensedPoints(robot.planar)
        self._edges, self._radius = Edges(robot.planar), robot.planar.circumscribed_radius
        self.reset()

    def reset(self) -> None:
        """Forget what it did so far."""
        self._in_vain = 0
        self._doubted_at: Pose2D | None = None
        self._T_known: Pose2D | None = None
        self._begin()

    def _begin(self) -> None:
        self._points.clear()
        self._scans: dict[str, Scan] = {}
        self.is_active = False
        self._T_map_odom: Pose2D | None = None
        self._began = 0.0
        self._came: float | None = None
        self._look_around()

    def is_needed(self, estimate: Estimate) -> bool:
        """Whether the robot does not know where it is, by what the localizer says and how such doubts ended here."""
        if estimate.state == "localized":
            self._T_known = estimate.T_map_odom
            return False
        at, known = self._doubted_at, self._T_known
        if self.is_active or self._in_vain < _IN_VAIN or at is None or known is None:
            return True  # a search that has begun goes on: it may come to a place where none would begin
        is_here = estimate.pose.distance_to(at) <= _SAME_PLACE_M
        return not is_here or estimate.pose.distance_to(known @ estimate.odom_pose) > CORRECTED_M

    def end(self, estimate: Estimate) -> bool:
        """Stop, as the robot knows where it is; return whether that is elsewhere than where it believed to be."""
        believed = None if self._T_map_odom is None else self._T_map_odom @ estimate.odom_pose
        is_elsewhere = believed is None or estimate.pose.distance_to(believed) > CORRECTED_M
        if self._doubted_at is None or estimate.pose.distance_to(self._doubted_at) > _SAME_PLACE_M:
            self._doubted_at, self._in_vain = estimate.pose, 0
        self._in_vain = 0 if is_elsewhere else self._in_vain + 1
        self._begin()
        return is_elsewhere

    def decide(self, estimate: Estimate, scans: Sequence[Scan], time: float) -> Decision:
        """Return what to do in this control period.

        Args:
            estimate: What the localizer says.
            scans: Scans that arrived in this period.
            time: Now [s].
        """
        if not self.is_active:
            self.is_active, self._began = True, time
            self._T_map_odom = estimate.T_map_odom
            self._came = None
            self._look_around()
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

    def _look_around(self) -> None:
        """Begin to turn."""
        self._turned, self._left = 0.0, 1.0
        self._last_yaw: float | None = None
        self._to_turn: float | None = None  # how far; not looked at yet
        self._seek: _Seek | None = None

    def _move(self, odometry: Pose2D, time: float) -> Twist2D:
        if not any(scan.time >= time - _RECENT_S for scan in self._scans.values()):
            return _STAND
        reach = float(_STEPS_M[-1]) + self._radius + _MARGIN_M
        room = _Room(self._edges, self._points.around(time, odometry, reach, 0.0, time - _RECENT_S).places)
        if self._seek is None:
            turn = self._turn(room, odometry, time)
            if turn is not None:
                return turn
            self._seek = self._choose(room, odometry, time)
            if self._seek is None:
                self._look_around()
                return _STAND
        command = self._drive(self._seek, room, odometry, time)
        if command is None:
            self._came = wrap_angle(self._seek.direction + math.pi)
            self._look_around()
            return _STAND
        return command

    def _turn(self, room: _Room, odometry: Pose2D, time: float) -> Twist2D | None:
        """Turn on the spot; None if it has turned far enough, or has no room on either side."""
        if self._last_yaw is not None:
            self._turned += abs(wrap_angle(odometry.yaw - self._last_yaw))
        self._last_yaw = odometry.yaw
        if self._to_turn is None:
            self._to_turn = 2.0 * math.pi if self._has_gaps(time) else _ENOUGH_RAD if self._came is None else 0.0
        if self._turned >= self._to_turn:
            return None
        if room.turn(self._left) < _LEAST_TURN_RAD:
            self._left = -self._left
            if room.turn(self._left) < _LEAST_TURN_RAD:
                return None
        return Twist2D(0.0, self._left * min(_TURN_RADPS, self._robot.limits.angular_speed))

    def _choose(self, room: _Room, odometry: Pose2D, time: float) -> _Seek | None:
        """Return where to drive: the yaw and the gear with the most room; None where there is none."""
        best, found = 0.0, None
        left, right = room.turn(1.0), room.turn(-1.0)
        for turn in (0.0, *_TURNS[2::3][_TURNS[2::3] <= left], *-_TURNS[2::3][_TURNS[2::3] <= right]):
            yaw = wrap_angle(odometry.yaw + float(turn))
            for gear in (1.0, -1.0):
                ahead = float(turn) if gear > 0.0 else wrap_angle(float(turn) + math.pi)
                direction = wrap_angle(odometry.yaw + ahead)
                free = room.drive(float(turn), gear) if self._sees(ahead, time) else 0.0
                if free < _LEAST_M:
                    continue
                worth = free - _TURN_COST_M * abs(float(turn)) - (0.0 if gear > 0.0 else _BACK_COST_M)
                if self._came is not None and abs(wrap_angle(direction - self._came)) < 1.0:
                    worth -= _RETURN_COST_M
                if found is None or worth > best:
                    best, found = worth, _Seek(yaw, gear, direction, odometry)
        return found

    def _drive(self, seek: _Seek, room: _Room, odometry: Pose2D, time: float) -> Twist2D | None:
        """Turn to where it is to drive, and drive; None where that ends."""
        limits = self._robot.limits
        off = wrap_angle(seek.yaw - odometry.yaw)
        if seek.begin.distance_to(odometry) < 0.05 and abs(off) > _FACING_RAD:
            if room.turn(math.copysign(1.0, off)) < min(abs(off), _LEAST_TURN_RAD) - 1e-9:
                return None
            return Twist2D(0.0, math.copysign(min(_TURN_RADPS, limits.angular_speed), off))
        ahead = 0.0 if seek.gear > 0.0 else math.pi
        if seek.begin.distance_to(odometry) > _SEEK_M or not self._sees(ahead, time):
            return None
        if room.drive(0.0, seek.gear) < _AHEAD_M:
            return None
        return Twist2D(seek.gear * min(_SEEK_MPS, limits.linear_speed), 0.0)

    def _has_gaps(self, time: float) -> bool:
        """Return whether there are directions without a beam."""
        return not all(self._sees(float(direction), time) for direction in np.radians(np.arange(0.0, 360.0, 10.0)))

    def _sees(self, heading: float, time: float) -> bool:
        """Return whether a lidar has a beam in this direction that measured something, or nothing within its range."""
        for scan in self._scans.values():
            if scan.time < time - _RECENT_S:
                continue
            off = np.abs(np.remainder(scan.angles + scan.mount.yaw - heading + math.pi, 2.0 * math.pi) - math.pi)
            if (scan.ranges[off < _BEAM_ASIDE_RAD] > 0.0).any():
                return True
        return False


@dataclass(frozen=True, slots=True)
class _Seek:
    """A short drive, straight.

    Attributes:
        yaw: Yaw at which the robot drives, odom frame [rad].
        gear: Forward (1) or backward (-1).
        direction: Direction in which it moves, odom frame [rad].
        begin: Pose at which it began, odom frame.
    """

    yaw: float
    gear: float
    direction: float
    begin: Pose2D


class _Room:
    """How far a robot has room to move among points that its scans hit, (N, 2), base_link [m]."""

    def __init__(self, edges: Edges, hits: FloatArray) -> None:
        self._edges, self._hits = edges, hits
        self._margin = min(_MARGIN_M, max(0.0, float(self._apart(np.zeros((1, 3)))[0]) - 0.005))
        self._turns: dict[float, float] = {}

    def turn(self, side: float) -> float:
        """Return how far it can turn to the left (1) or to the right (-1) [rad], up to π."""
        if side not in self._turns:
            poses = np.zeros((len(_TURNS), 3))
            poses[:, 2] = side * _TURNS
            count = self._first_near(poses)
            self._turns[side] = float(_TURNS[count - 1]) if count else 0.0
        return self._turns[side]

    def drive(self, yaw: float, gear: float) -> float:
        """Return how far it can drive straight at this yaw, base_link [rad], forward (1) or backward (-1) [m]."""
        steps = gear * _STEPS_M
        poses = np.column_stack((math.cos(yaw) * steps, math.sin(yaw) * steps, np.full(len(steps), yaw)))
        count = self._first_near(poses)
        return float(_STEPS_M[count - 1]) if count else 0.0

    def _first_near(self, poses: FloatArray) -> int:
        near = self._apart(poses) < self._margin
        return int(np.argmax(near)) if near.any() else len(poses)

    def _apart(self, poses: FloatArray) -> FloatArray:
        return self._edges.distances(self._hits, poses).min(axis=1, initial=math.inf)


def _describe(estimate: Estimate) -> str:
    if estimate.state == "ambiguous":
        places = f"at one of {len(estimate.hypotheses)} places" if len(estimate.hypotheses) > 1 else "not sure where"
        return f"the robot is {places}: looking around"
    return "the robot does not know where it is: looking around"
