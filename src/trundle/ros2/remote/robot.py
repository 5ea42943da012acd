"""`RemoteRobot`: a robot that is somewhere else, in the place of a simulator."""

from __future__ import annotations

import time as system
from collections.abc import Callable

from trundle.geometry import Pose2D, Twist2D
from trundle.observation import Observation, Scan, make_scan
from trundle.robots import Robot, WheelSpeeds
from trundle.ros2.remote.commands import CommandOutput
from trundle.ros2.remote.guard import Reasons
from trundle.ros2.remote.inputs import RobotInputs
from trundle.ros2.remote.localizer import RemoteLocalizer, TfLocalizer
from trundle.sim import RobotState, Simulator
from trundle.worlds import World

_STILL = WheelSpeeds(0.0, 0.0)
_ORIGIN, _STAND = Pose2D(0.0, 0.0), Twist2D()

TIMER_SHARE = 1.4
"""Where scans come about as often as the control period, the timer waits so many periods for the next one."""

LEAST_SHARE = 0.5
"""Scans that come sooner than this share of a control period after the last one wait: lidars take turns."""

LEAST_STEP_S = 1e-3
"""The time of a run goes on by at least this in each control period [s], also where that of the robot stands."""

WAKE_S = 0.2
"""A robot that sends no odometry gets a command to stand so often [s]: some send it only while they are commanded."""

UNASKED_S = 1.0
"""A robot that sends odometry so long after the last command [s] sends it without being commanded."""

BLIND_TRIES, BLIND_PAUSE_S = 3, 2.0
"""How often a robot sets off without odometry, which some send only when they move, and the pause after each [s]."""


class RunTime:
    """The time of the run [s], which always goes on, whatever the robot's clock does.

    Attributes:
        offset: What the robot's clock is ahead of it [s].
    """

    def __init__(self) -> None:
        self.offset = 0.0
        self._last: float | None = None
        self._clock: tuple[int, int, bool] | None = None

    def begin(self) -> None:
        """Begin a run at 0."""
        self._last = None

    def at(self, now: float, clock: tuple[int, int, bool]) -> float:
        """Return the time of the run at a time of the robot's clock [s].

        Args:
            now: What time it is there.
            clock: Which clock that is; see `RobotClock.epoch`.
        """
        if self._last is None:
            self._last, self._clock, self.offset = 0.0, clock, now
            return 0.0
        least = self._last + LEAST_STEP_S
        if clock != self._clock:
            self._clock = clock
            self.offset = now - least
        time = max(now - self.offset, least)
        self._last = time
        return time


class RemoteRobot(Simulator):
    """Sends commands to a robot on the network, and returns what it has observed; it stands in for a simulator.

    A scan ends a control period; without scans a timer does. The pose is what the localizer believes: nobody knows the
    true one. Times are those of the run; `offset` is what the robot's clock is ahead of them.

    Args:
        robot: The robot.
        world: The world of the map, for the page; None without a map.
        inputs: What the robot sends.
        commands: The commands to it.
        localizer: Where it is.
        real: Real time [s].

    Attributes:
        T_run_odom: The robot's frame of odometry in that of the run, which does not jump where the localizer can do
            with that.
    """

    def __init__(
        self,
        robot: Robot,
        world: World | None,
        inputs: RobotInputs,
        commands: CommandOutput,
        localizer: RemoteLocalizer | TfLocalizer,
        *,
        real: Callable[[], float] = system.monotonic,
    ) -> None:
        self._robot, self._world = robot, world
        self._inputs, self._commands, self._localizer, self._real = inputs, commands, localizer, real
        self._time = RunTime()
        self._stepped = real()
        self._woken = 0.0
        self._blind, self._blind_until, self._sends_unasked = 0, 0.0, False
        self._pose, self._jumps = _ORIGIN, inputs.jumps
        self.T_run_odom, self._has_jumped = _ORIGIN, False

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self._robot

    @property
    def world(self) -> World | None:
        """The world of the map."""
        return self._world

    @property
    def offset(self) -> float:
        """What the robot's clock is ahead of the time of the run [s]."""
        return self._time.offset

    def use_world(self, world: World) -> None:
        """Use the world of another map from now on."""
        self._world = world

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Begin a run where the robot is: it is not moved, and stands until it gets its first command."""
        self._commands.send(_STAND)
        self._time.begin()
        self._stepped = self._real()
        return self._observe()

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Send a command, and return what the robot observes at the next scan, or after `dt` [s]."""
        now = self._real()
        wakes = self._needs_waking(now)
        if wakes:
            self._woken = now
        self._commands.send(command, wakes=wakes)
        self._wait(dt)
        return self._observe()

    def close(self) -> None:
        """Stop the robot."""
        self._commands.stop()

    # One control period ---------------------------------------------------------------------------------------------

    def _wait(self, dt: float) -> None:
        inputs, real = self._inputs, self._real
        soonest = self._stepped + LEAST_SHARE * dt - real()
        if soonest > 0.0:
            system.sleep(soonest)
        period = inputs.scan_period
        share = TIMER_SHARE if period is not None and period <= 1.3 * dt else 1.0
        inputs.wait_for_scan(self._stepped + share * dt - real())
        self._stepped = real()

    def _observe(self) -> RobotState:
        inputs = self._inputs
        if inputs.jumps != self._jumps:  # nobody knows how the robot has moved meanwhile
            self._jumps = inputs.jumps
            self._localizer.doubt()
            self._has_jumped = True
        taken = inputs.take_scans()
        now = max([inputs.now, *(scan.time for scan in taken)])
        odometry = inputs.odometry
        time = self._time.at(now, inputs.clock.epoch)
        twist = _STAND
        if odometry is not None:
            if self._has_jumped:
                self._has_jumped = False
                bridges = self._localizer.bridges_jumps
                self.T_run_odom = self._pose @ odometry.pose.inverse() if bridges else _ORIGIN
            pose = odometry.pose
            if not inputs.odometry_silent:
                pose, twist = odometry.at(now), odometry.twist
            self._pose = self.T_run_odom @ pose
        offset = self._time.offset
        scans = tuple(_at(scan, min(scan.time - offset, time)) for scan in taken)
        seen = Observation(time, twist, self._pose, scans)
        estimate = self._localizer.update(seen)
        return RobotState(time, estimate.pose, twist, _STILL, _STILL, self._pose, scans=scans, odometry_twist=twist)

    # Odometry that is silent ----------------------------------------------------------------------------------------

    def _needs_waking(self, now: float) -> bool:
        """Return whether to send zeros to a robot without odometry: some send it only while they are commanded."""
        inputs = self._inputs
        silent = inputs.odometry is None or inputs.odometry_silent
        others = bool(self._commands.others(now))
        return silent and not others and not self._localizer.waits_for_pose and now - self._woken >= WAKE_S

    def odometry_rule(self, now: float) -> Reasons:
        """Return whether the robot has to stand as its odometry is silent; a rule of the guard.

        A robot that sends odometry only while it is commanded needs none where it stands: where it was, it still is. It
        may set off without, for as long as a silence may last, and then has to send some.
        """
        inputs, since = self._inputs, self._commands.moving_since
        if inputs.odometry is None:
            return {"odometry missing": "odometry: nothing has come yet, neither on its topic nor on tf"}
        stream = max(inputs.odometry_stream, inputs.tf_stream, key=lambda one: one.last)
        if not self._sends_unasked and stream.last - self._commands.written > UNASKED_S:
            self._sends_unasked = not self._commands.others(now)
        if not inputs.odometry_silent:
            self._blind, self._blind_until = 0, 0.0
            return {}
        silent = {"odometry silent": f"odometry: nothing new for {now - stream.last:.2f} s"}
        if self._sends_unasked:
            return silent
        if since is not None:
            if now - max(since, stream.last) > stream.allowed_s:
                self._blind += 1
                self._blind_until = now + BLIND_PAUSE_S
                return silent
            return {}
        if self._blind >= BLIND_TRIES or now < self._blind_until:
            return silent
        return {}


def _at(scan: Scan, time: float) -> Scan:
    """Return a scan, whose numbers were checked when it was read, at a time of the run [s]."""
    return make_scan(
        *(scan.lidar, time, scan.mount, scan.height, scan.angles, scan.ranges),
        *(scan.range_min, scan.range_max, scan.time_increment),
    )
