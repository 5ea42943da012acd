"""`RemoteRole`: trundle's navigator on a robot that is somewhere else; `GoalDrive`: drives to goals and ends."""

from __future__ import annotations

import math
import time as system
from collections.abc import Callable, Sequence
from pathlib import Path

from trundle.control.latency import Latency
from trundle.errors import InputError, TrundleError
from trundle.geometry import Goal, Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission import End, Episode, Observer, RunInfo, Session, SetGoal, SetGoals, Step, TaskEnd
from trundle.mission.setup import SessionOptions
from trundle.ros2.navigator_role.role import LoadedMap, NavigatorRole
from trundle.ros2.outputs.output import Output
from trundle.ros2.remote.guard import Guard, GuardedMonitor
from trundle.ros2.remote.inputs import RobotInputs
from trundle.ros2.remote.localizer import RemoteLocalizer, TfLocalizer
from trundle.ros2.remote.publishing import StartPose
from trundle.ros2.remote.robot import RemoteRobot
from trundle.ros2.remote.setting import RemoteOptions, make_parts, prepare
from trundle.ros2.role import BridgeContext

NOT_LOCATED = "the robot does not know yet where it is: give its pose on /initialpose, or with --start"

WAITS_S = 60.0
"""A drive to goals is given up where the robot may not drive for so long [s of real time]."""

SETTLES_S = 2.0
"""Goals are taken for so long after a map was loaded [s of real time]: the first scans on it locate the robot."""

_LATENCY_S, _LATENCY_STEP_S, _MOST_LATENCY_S = 1.0, 0.02, 0.3


class LocatedOutput:
    """Publishes where the robot is, once it knows that.

    Args:
        inner: The output.
        localizer: Knows whether it knows.
        published: Called before each message.
    """

    def __init__(self, inner: Output, localizer: RemoteLocalizer | TfLocalizer, published: Callable[[], None]) -> None:
        self._inner, self._localizer, self._published = inner, localizer, published

    def publish(self, step: Step, time: float) -> None:
        """Publish it, if the robot knows where it is."""
        if self._localizer.is_located:
            self._published()
            self._inner.publish(step, time)


class RemoteRole(NavigatorRole):
    """The navigator, whose robot is on the network.

    Args:
        context: What it plugs into.
        robot: The robot.
        inputs: What it sends.
        localizer: Where it is.
        guard: Why it must stand.
        monitor: What every command passes.
        locates: Whether trundle locates it, and publishes map → odom; else others do.
        delay_s: How late commands arrive [s]; None where that is taken from the age of stamps.
    """

    def __init__(
        self,
        context: BridgeContext,
        robot: RemoteRobot,
        inputs: RobotInputs,
        localizer: RemoteLocalizer | TfLocalizer,
        guard: Guard,
        monitor: GuardedMonitor,
        *,
        locates: bool,
        delay_s: float | None,
    ) -> None:
        super().__init__(context)
        self._robot, self._inputs, self._localizer, self._guard = robot, inputs, localizer, guard
        self._monitor, self._locates, self._delay_s = monitor, locates, delay_s
        self._applied_s, self._looked_s = -1.0, -math.inf
        self._settles_until = -math.inf

    def open(self) -> None:
        """Open topics, services and actions."""
        super().open()
        self._kit.beliefs.find = self._inputs.find_on_robot
        kept = [one for one in self._outputs if one is not self._pose_output]
        if self._locates:
            kept.insert(0, LocatedOutput(self._pose_output, self._localizer, self._note_map_odom))
        self._outputs = kept

    def use_start(self, start: StartPose) -> None:
        """Let what is published on /initialpose not come back as a pose from others."""
        self._kit.is_own_pose = start.is_own

    def use_drive(self, drive: GoalDrive) -> None:
        """End a drive, too, when the robot is stopped."""
        self._kit.tasks.ends.append(drive.stop)

    def begin(self, observers: Sequence[Observer], seed: int | None) -> Session:
        """Begin a run where the robot is; it waits for goals."""
        loaded = self._take_map()
        self._localizer.begin()
        self._applied_s, self._looked_s = -1.0, -math.inf  # the session sets the latency to 0, and its time begins at 0
        options: SessionOptions = {"localizer": self._localizer, "latency": None, "monitor": self._monitor}
        return self._begin(loaded, [_First(self), *observers], seed, options)

    def _prepare(self, path: Path) -> LoadedMap:
        """Make map, navigator and localizer from the file of another map."""
        mission, inputs = self._context.mission, self._inputs
        if not mission.scenario.known_map:
            raise InputError("the robot makes its map itself, as it drives: start trundle with a map, and amcl")
        scenario = mission.scenario.model_copy(update={"map": str(path), "world": None})
        setting = prepare(scenario, self._context.profile, RemoteOptions(), robot=mission.robot)
        localizer = self._localizer
        parts = make_parts(setting, has_scans=bool(inputs.sensors)) if isinstance(localizer, RemoteLocalizer) else None

        def use() -> None:
            self._robot.use_world(setting.world)
            if parts is not None and isinstance(localizer, RemoteLocalizer):
                localizer.use_map(*parts, self._start_on(setting.grid))
            self._settles_until = system.monotonic() + SETTLES_S

        return LoadedMap(setting, use)

    def _start_on(self, grid: OccupancyGrid) -> Pose2D | None:
        """Return where the robot is on a map that was loaded: where it was; None where that is not on it."""
        here = self._kit.beliefs.now.pose
        return here if bool(grid.contains(*grid.world_to_cell(here.x, here.y))) else None

    def follow(self, step: Step) -> None:
        """Keep the time of the network, the latency, and whether goals are taken."""
        context = self._context
        context.clock.offset = self._robot.offset
        context.clock.set(step.state.time)
        context.origin = self._robot.T_run_odom
        tasks, localizer = self._kit.tasks, self._localizer
        settles = system.monotonic() < self._settles_until and not localizer.waits_for_pose
        takes = localizer.is_located or settles
        tasks.refuse("location", "" if takes else localizer.why or NOT_LOCATED)
        if step.state.time - self._looked_s >= _LATENCY_S:
            self._looked_s = step.state.time
            self._compensate()

    def _compensate(self) -> None:
        """Set the latency, so that the navigator plans for the pose at which a command arrives.

        Odometry is taken as of now, by its stamps. Nobody stamps when a command takes effect: it is taken to travel for
        as long as the stamps say that odometry does.
        """
        delay = min(self._inputs.clock.age, _MOST_LATENCY_S) if self._delay_s is None else self._delay_s
        if abs(delay - self._applied_s) < _LATENCY_STEP_S:
            return
        self._applied_s = delay
        latency = Latency(command_delay_s=delay)
        self._context.mission.navigator.set_latency(latency)
        self._monitor.set_latency(latency)

    def _note_map_odom(self) -> None:
        self._inputs.map_odom.published.append(self._kit.beliefs.now.map_odom)


class _First:
    """Comes before all other observers: they need the time of the network."""

    def __init__(self, role: RemoteRole) -> None:
        self._role = role

    def on_start(self, run: RunInfo) -> None:
        """Do nothing: the first period tells the time."""

    def on_step(self, step: Step) -> None:
        """Keep the time of the network."""
        self._role.follow(step)

    def on_end(self, episode: Episode) -> None:
        """Do nothing."""


class GoalDrive:
    """Drives to goals once the robot knows where it is, and ends the run; an observer.

    Args:
        goals: The goals, in order.
        context: The bridge.
        localizer: Knows whether the robot may drive.
        guard: Why it must stand.

    Attributes:
        waits_s: The drive is given up where the robot may not drive for so long [s of real time].
        arrived: Whether it has arrived at all of them.
        message: How it ended.
    """

    def __init__(
        self,
        goals: Sequence[Goal],
        context: BridgeContext,
        localizer: RemoteLocalizer | TfLocalizer,
        guard: Guard,
        *,
        waits_s: float = WAITS_S,
    ) -> None:
        self._goals, self._context, self._localizer, self._guard = tuple(goals), context, localizer, guard
        self.waits_s = waits_s
        self._begun = self._given = False
        self._left = self._goals
        self._stopped = ""
        self._held_since: float | None = None
        self.arrived = False
        self.message = ""

    def on_start(self, run: RunInfo) -> None:
        """Do nothing: the goals wait for the robot."""

    def on_step(self, step: Step) -> None:
        """Give the goals once the robot may drive; give up where it may not for too long."""
        if self.message:  # the run was about to begin again as the drive ended
            self._context.driver.steering.put(End(self.message), by="--goal")
            return
        if self._stopped:
            self._end(self._stopped)
            return
        now = system.monotonic()
        if self._given and step.steering is not None:
            self._left = step.steering.goals[step.goal :]
        reasons = self._guard.reasons
        if not reasons:
            self._held_since = None
            if not self._given:
                self._begun = self._given = True
                goals = self._goals
                directive = SetGoal(goals[0]) if len(goals) == 1 else SetGoals(goals, through=False)
                self._left = goals
                self._context.driver.steering.put(directive, by="--goal", watcher=self)
            return
        if self._held_since is None:
            self._held_since = now
        elif now - self._held_since > self.waits_s:
            self._end(f"the robot had to stand for {self.waits_s:g} s: {'; '.join(reasons.values())}")

    def on_end(self, episode: Episode) -> None:
        """Do nothing."""

    def stop(self, why: str) -> None:
        """End a drive that was begun: the robot is stopped. Any thread may call it."""
        if self._begun:
            self._stopped = why

    def begin(self, time: float) -> None:
        """Do nothing: the run has taken up the goals."""

    def refuse(self, error: TrundleError) -> None:
        """End: there is no path; where the run is about to begin again, the next one gets the goals."""
        if self._context.driver.steering.is_restarting:
            self._given = False
        else:
            self._end(str(error))

    def end(self, end: TaskEnd) -> None:
        """End: the goals are reached, or given up; a run on another map goes on with those that are left."""
        if end.result == "stopped":
            self._given, self._goals = False, self._left or self._goals
            return
        self.arrived = end.result == "succeeded"
        self._end("arrived" if self.arrived else self._stopped or end.message or end.result)

    def _end(self, message: str) -> None:
        if not self.message:
            self.message = message
            self._context.driver.steering.put(End(message), by="--goal")
