"""`CollisionMonitor`: stops or slows any command that leads towards what the lidars see, whatever made the command.

After Nav2's Collision Monitor, with its names. It needs no map, no plan and no costmap: only scans and odometry.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from trundle.control.collision import stopping_poses
from trundle.control.controller import Intent
from trundle.control.latency import DelayedCommands, Latency
from trundle.control.sensed_points import Edges, Points, SensedPoints, box_around
from trundle.errors import InputError
from trundle.files.yaml_config import Config, NotNegative, Positive
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.observation import Scan, check_scans
from trundle.robots import Robot
from trundle.values import as_number, check_kind

MonitorAction = Literal["none", "slow", "approach", "stop"]
"""What a monitor did with a command."""

_HERE = Pose2D(0.0, 0.0)
_STAND = Twist2D(0.0, 0.0)
_CLOSER_SHARE = 0.1  # what is within the padding already may come closer by this share of its distance
_SAME_M = 1e-6
_TICK_S = 0.05
_MARGIN_M = 0.1  # hits a little beyond what can be reached are looked at, too
_MOST_STEPS = 1000
_MOVER_STEPS = 5
_INTENT_S, _INTENT_STEPS = 2.0, 11  # an intent is known for longer than a command can be taken for granted
_SLOWEST_MPS = 0.02  # of any point of the robot: slower, it would creep until the noise of a scan lets it touch
_STRAIGHT_RAD = 1e-6
_AT_HERE, _NONE = np.zeros((1, 3)), np.zeros(0, np.intp)


class MonitorSettings(Config):
    """When a `CollisionMonitor` stops, slows down and approaches; Nav2's names where Nav2 has them.

    Attributes:
        stop_padding: The stop polygon is the footprint, wider by this on all sides [m].
        slowdown_padding: The slowdown polygon is the footprint, wider by this [m]; 0 means none.
        slowdown_ratio: Share of the commanded speed that is left while something is in the slowdown polygon.
        time_before_collision: The robot approaches what it would touch within this time [s] as slowly as to take that
            time; 0 means that it does not look ahead further than it takes to stop.
        moving_padding: Something that moves and is nearer to the footprint than this, or will be within
            `moving_time`, stops the robot unless the command takes the robot away from it [m]; 0 means no such stop.
            What moves may turn at any moment, and nothing tells how. A controller that says what it means to command,
            such as `mppi`, is judged by all of that.
        moving_clearance: A command that takes the robot away passes only if nothing that moves comes nearer than this
            [m]: a robot that is about to be touched anyway stands.
        moving_time: How far ahead that is looked [s].
        moving_hold: For so long [s] after such a stop the robot stands on, unless the command takes it away: what turns
            beside the robot seems to stand for a moment, and is about to come round. Commands that a controller's
            intention begins with are not held.
        simulation_time_step: Between two poses that are tested on the way [s].
        min_points: So many points of scans count as something.
        source_timeout: A lidar that is silent for longer than this [s] stops the robot.
        sources: Names of lidars that must send scans. If None, those that have sent one, and at least one.

    Raises:
        InputError: If a value is out of range.
    """

    stop_padding: NotNegative = 0.02
    slowdown_padding: NotNegative = 0.05
    slowdown_ratio: Annotated[float, Field(gt=0.0, le=1.0)] = 0.5
    time_before_collision: NotNegative = 1.2
    moving_padding: NotNegative = 0.4
    moving_clearance: NotNegative = 0.15
    moving_time: NotNegative = 0.8
    moving_hold: NotNegative = 0.5
    simulation_time_step: Positive = 0.05
    min_points: Annotated[int, Field(ge=1)] = 3
    source_timeout: Positive = 1.0
    sources: tuple[str, ...] | None = None


@dataclass(frozen=True, slots=True)
class MonitorReport:
    """What a monitor did with one command.

    Attributes:
        command: The twist to send.
        action: "none", "slow" (something is in the slowdown polygon), "approach" (something would be touched before
            `time_before_collision`), or "stop".
        source: Name of the lidar that saw it, or that is silent; None where nothing was done or no lidar sent a scan.
        point: Where it is when the command takes effect, base_link [m]; None where nothing was done, and for a silent
            lidar.
        time_to_contact: Of the command as it was given [s]; infinite where it leads to no contact in the time that is
            looked ahead.
    """

    command: Twist2D
    action: MonitorAction = "none"
    source: str | None = None
    point: tuple[float, float] | None = None
    time_to_contact: float = math.inf


class CollisionMonitor:
    """Stands between whatever drives and the robot, and lets no command pass that leads into what the lidars see.

    A robot that something has come close to may drive away from it: in the stop polygon, commands pass that bring the
    footprint no nearer to anything. What moves is expected to go on at its velocity, which two scans tell. It cannot
    keep others from running into the robot, and it sees only what crosses the plane of a lidar.

    Args:
        robot: The robot; points inside its footprint are its own body.
        settings: The settings. If None, the defaults.

    Attributes:
        settings: The same.
    """

    def __init__(self, robot: Robot, settings: MonitorSettings | None = None) -> None:
        check_kind(robot, Robot, "a monitor's robot", "Robot.load(name) makes one")
        self.settings = MonitorSettings() if settings is None else settings
        check_kind(self.settings, MonitorSettings, "a monitor's settings", "MonitorSettings(min_points=4) makes them")
        for name in self.settings.sources or ():
            if name not in robot.lidars:
                lidars = ", ".join(robot.lidars) or "none"
                raise InputError(f"the monitor waits for lidar {name!r}, which {robot.name} lacks; it has: {lidars}")
        self._robot = robot
        self._edges = Edges(robot.planar)
        self._points = SensedPoints(robot.planar)
        self._delayed = DelayedCommands(robot.limits)
        horizon, step = self.settings.time_before_collision, self.settings.simulation_time_step
        steps = min(math.ceil(horizon / step - 1e-9), _MOST_STEPS)
        self._ahead = np.linspace(horizon / steps, horizon, steps) if steps else np.zeros(0)  # tested at these times
        self.reset()

    def set_latency(self, latency: Latency) -> None:
        """Check commands from now on for the pose that the robot has when they take effect; a session calls it."""
        check_kind(latency, Latency, "a latency", "Latency(command_delay_s=0.1) makes one")
        self._delayed.delay_s = latency.command_delay_s

    def set_intent(self, intent: Intent | None) -> None:
        """Judge the next command by what is to follow it; a session calls it with the agent's `intent` before `check`.

        Without one, a command counts as kept up. The robot must always be able to brake in time, whatever is intended.
        """
        self._intent = intent

    def reset(self) -> None:
        """Forget all scans, at the start of a run."""
        self._intent: Intent | None = None
        self._points.clear()
        self._delayed.clear()
        self._since: float | None = None
        self._held_until = -math.inf

    def check(
        self, command: Twist2D, twist: Twist2D, scans: Sequence[Scan], time: float, odometry: Pose2D
    ) -> MonitorReport:
        """Say what to send instead of a command; call it once per control period.

        Args:
            command: What is to be sent.
            twist: How the robot moves now, base_link.
            scans: Scans that arrived since the last call.
            time: Now [s], on the clock of the scans.
            odometry: Pose of base_link in the odom frame now.

        Raises:
            InputError: If the time is no finite number, or one of the others is of another kind.
        """
        now = as_number(time, "time of the collision monitor")
        if not math.isfinite(now):
            raise InputError(f"time must be a finite number of seconds, got {time!r}")
        for given, kind, what in ((command, Twist2D, "a command"), (twist, Twist2D, "how the robot moves")):
            check_kind(given, kind, what, "Twist2D(v, w) makes one")
        self._points.add(check_scans(scans), now, Pose2D.of(odometry))
        if self._since is None or now < self._since:
            self._since = now
        report = self._judge(command, twist, now, Pose2D.of(odometry))
        self._delayed.send(report.command, now)
        return report

    def _judge(self, command: Twist2D, twist: Twist2D, now: float, odometry: Pose2D) -> MonitorReport:
        silent, name = self._silent(now)
        if silent:
            return MonitorReport(_STAND, "stop", name)
        oldest = now - self.settings.source_timeout
        there, twist = self._delayed.predict(odometry, twist, now)
        ahead_s, reach = self._reach(command, twist)
        points = self._points.around(now + self._delayed.delay_s, there, reach, ahead_s, oldest)
        if len(points.places) < self.settings.min_points:
            return MonitorReport(command)
        return self._limit(command, twist, points, now)

    def _silent(self, now: float) -> tuple[bool, str | None]:
        """Whether a lidar has sent nothing for too long, and which."""
        times, since = self._points.times, 0.0 if self._since is None else self._since
        names = self.settings.sources or tuple(times) or (None,)
        for name in names:
            last = since if name is None else times.get(name, since)
            if now - last > self.settings.source_timeout + 1e-9:
                return True, name
        return False, None

    def _reach(self, command: Twist2D, twist: Twist2D) -> tuple[float, float]:
        """How far ahead a command is looked at [s], and how far from base_link what stands can matter [m]."""
        settings, limits = self.settings, self._robot.limits
        fastest = max(abs(command.v), abs(twist.v))
        ahead_s = max(settings.time_before_collision, fastest / limits.linear_acceleration + _TICK_S)
        padding = max(settings.stop_padding, settings.slowdown_padding)
        return ahead_s, self._robot.circumscribed_radius + padding + fastest * ahead_s + _MARGIN_M

    def _limit(self, command: Twist2D, twist: Twist2D, points: Points, now: float) -> MonitorReport:
        settings = self.settings
        padding, braking = max(settings.stop_padding, settings.slowdown_padding), self._braking(command, twist)
        nearest = self._edges.clearances(points, braking, padding, settings.min_points)
        here, least = float(nearest[0]), float(nearest.min())
        contact = self._look_ahead(command, points)
        index = self._meets_mover(command, points, now)
        if index is not None:
            return _report(_STAND, "stop", points, index, contact.time)
        allowed = min(here, settings.stop_padding)
        if least < allowed - _CLOSER_SHARE * max(allowed, 0.0) - _SAME_M:
            near, apart = self._apart(braking, points, padding)
            return _report(_STAND, "stop", near, int(apart.min(axis=0).argmin()), contact.time)
        leaves = least >= here - _SAME_M  # or drives along something
        if contact.time < math.inf and not (here <= 0.0 and leaves):
            share = self._share(contact, twist)
            slower = Twist2D(share * command.v, share * command.w)
            if abs(slower.v) + abs(slower.w) * self._robot.circumscribed_radius < _SLOWEST_MPS:
                slower = _STAND
            action: MonitorAction = "stop" if slower == _STAND else "approach"
            return _report(slower, action, contact.points, contact.index, contact.time)
        if here < settings.slowdown_padding and not leaves and command != _STAND:
            slower = Twist2D(settings.slowdown_ratio * command.v, settings.slowdown_ratio * command.w)
            near, apart = self._apart(braking, points, padding)
            return _report(slower, "slow", near, int(apart[0].argmin()), contact.time)
        return MonitorReport(command, time_to_contact=contact.time)

    def _meets_mover(self, command: Twist2D, points: Points, now: float) -> int | None:
        """The nearest point of something that moves and comes too close, unless the command keeps it as far away."""
        settings = self.settings
        if settings.moving_padding <= 0.0 or command == _STAND:
            return None
        intended = self._intends(command)
        is_held = now < self._held_until and not intended
        moving = np.flatnonzero((points.velocities != 0.0).any(axis=1)) if points.moves else _NONE
        if len(moving) < settings.min_points:
            return self._nearest(points.places) if is_held else None
        ahead_s, steps = (_INTENT_S, _INTENT_STEPS) if intended else (settings.moving_time, _MOVER_STEPS)
        times = np.linspace(0.0, ahead_s, steps)
        driven = self._poses(command, times)
        places, velocities = points.places[moving], points.velocities[moving]
        kth = settings.min_points - 1
        standing, driving = (
            np.partition(self._edges.distances(places, poses, velocities, times), kth, axis=1)[:, kth].min()
            for poses in (np.zeros_like(driven), driven)
        )
        clearance = min(settings.moving_clearance, settings.moving_padding)
        if driving > standing + _SAME_M and driving >= clearance:
            return None
        if driving < settings.moving_padding or not (intended or standing >= settings.moving_padding):
            self._held_until = now + settings.moving_hold
        elif not is_held:
            return None
        return int(moving[self._nearest(places)])

    def _nearest(self, places: FloatArray) -> int:
        """Index of the place that is nearest to the footprint."""
        return int(self._edges.distances(places, _AT_HERE)[0].argmin())

    def _braking(self, command: Twist2D, twist: Twist2D) -> FloatArray:
        """Poses of one control period and then braking, from where the robot is, shape (K, 3)."""
        return stopping_poses(_HERE, twist, command, self._robot.limits, _TICK_S)

    def _intends(self, command: Twist2D) -> bool:
        return self._intent is not None and self._intent.begins_with(command)

    def _poses(self, command: Twist2D, times: FloatArray) -> FloatArray:
        """Where the robot is after these times [s], from where it is now, shape (K, 3)."""
        if self._intent is not None and self._intends(command):
            return self._intent.poses(times)
        turns, steps = command.w * times, command.v * times  # as `integrate_twist`, for all times at once
        if abs(turns[-1]) < _STRAIGHT_RAD:
            along, across = 1.0 - turns * turns / 6.0, 0.5 * turns
        else:
            straight = math.copysign(_STRAIGHT_RAD, command.w)  # before the first of these turns nothing is driven yet
            by = turns if abs(turns[0]) >= _STRAIGHT_RAD else np.where(np.abs(turns) < _STRAIGHT_RAD, straight, turns)
            along, across = np.sin(by) / by, (1.0 - np.cos(by)) / by
        poses = np.empty((len(times), 3))
        poses[:, 0], poses[:, 1], poses[:, 2] = steps * along, steps * across, turns
        return poses

    def _apart(self, poses: FloatArray, points: Points, padding: float) -> tuple[Points, FloatArray]:
        """The points that come within the polygons at any of some poses, and how far from the footprint they are."""
        near = points.within(*box_around(self._robot.planar, poses, padding))
        return near, self._edges.distances(near.places, poses)

    def _look_ahead(self, command: Twist2D, points: Points) -> _Contact:
        """The first contact of a command that is kept up."""
        times = self._ahead
        if len(times) == 0 or command == _STAND:
            return _Contact(points)
        poses = self._poses(command, times)
        (touched,) = (self._edges.clearances(points, poses, 0.0, self.settings.min_points, times) <= 0.0).nonzero()
        if len(touched) == 0:
            return _Contact(points)
        first = slice(touched[0], touched[0] + 1)
        near = points.within(*box_around(self._robot.planar, poses, 0.0))
        (apart,) = self._edges.distances(near.places, poses[first], near.velocities, times[first])
        inside = np.flatnonzero(apart <= 0.0)
        moves = bool(near.velocities[inside].any(axis=1).mean() > 0.5)
        return _Contact(near, int(apart.argmin()), float(times[first.start]), moves)

    def _share(self, contact: _Contact, twist: Twist2D) -> float:
        """Share of a command that leaves `time_before_collision` before a contact.

        Before something that moves, the time that the robot needs to stop is left too: it comes nearer by itself.
        """
        horizon = self.settings.time_before_collision
        if not contact.moves:
            return min(1.0, contact.time / horizon)
        stop_s = abs(twist.v) / self._robot.limits.linear_acceleration + 2.0 * _TICK_S
        return max(0.0, min(1.0, (contact.time - stop_s) / horizon))


@dataclass(frozen=True, slots=True, eq=False)
class _Contact:
    """The first contact that a command leads to: when [s], with which of these points, and whether that moves."""

    points: Points
    index: int = 0
    time: float = math.inf
    moves: bool = False


def _report(command: Twist2D, action: MonitorAction, points: Points, index: int, contact_s: float) -> MonitorReport:
    x, y = points.places[index].tolist()
    return MonitorReport(command, action, points.lidar_of(index), (x, y), contact_s)
