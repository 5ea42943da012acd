"""`RemoteBridge`: trundle's navigator on a robot that is somewhere else in ROS 2."""

from __future__ import annotations

import time as system
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from trundle.control import CollisionMonitor, MonitorSettings
from trundle.errors import UnknownNameError
from trundle.mission import Observer, Scenario
from trundle.mission.scenario import Setting
from trundle.ros2.inlet import MOST_A_SECOND, Record
from trundle.ros2.names import Names
from trundle.ros2.profile import Profile
from trundle.ros2.remote.commands import CommandOutput, Sources
from trundle.ros2.remote.guard import Guard, GuardedMonitor, Reasons
from trundle.ros2.remote.inputs import RobotInputs
from trundle.ros2.remote.localizer import MISFIT, RemoteLocalizer, TfLocalizer
from trundle.ros2.remote.publishing import StartPose, StaticFrames
from trundle.ros2.remote.robot import RemoteRobot
from trundle.ros2.remote.role import NOT_LOCATED, GoalDrive, RemoteRole
from trundle.ros2.remote.setting import TF, RemoteOptions, make_localizer, prepare
from trundle.ros2.role import BridgeContext, Driver, LiveDriver, SimulationClock
from trundle.ros2.runs import MakeObservers, NetworkRuns

if TYPE_CHECKING:
    from trundle.ros2.transport.transport import Transport
    from trundle.ros2.types import Types

FLOODS_S = 1.5
"""A topic is flooded until this long after a message of it was dropped [s of real time]: the rest of a second is."""


class RemoteBridge(NetworkRuns):
    """Drives a robot on the network by trundle's navigator; use it in a `with` block.

    Topics, services and actions are open when it is made; nothing is heard before `run`, and nothing is commanded
    before the robot is located. It stands wherever the guard has a reason.

    Args:
        scenario: Map, robot, navigator and localizer.
        transport: Carries the bytes; `close` closes it.
        types: The messages.
        names: Namespace and remaps.
        options: How the robot is driven.
        profile: Names of topics, frames and sensors: a profile, or the name of one.
        record: Keeps what goes over the wire.
        driver: Drives and steers the runs, as a page does. If None, they are driven as the robot's scans come.
        observers: Makes what else follows each run.
        report: Gets warnings and remarks. If None, the log does.

    Attributes:
        wire: What is published, heard and served.
        context: What the role plugs into.
        guard: Why the robot must stand.
        drive: The drive to the goals; None without goals.

    Raises:
        InputError: If the scenario, the profile or a name cannot be used.
    """

    def __init__(
        self,
        scenario: Scenario,
        transport: Transport,
        types: Types,
        names: Names,
        options: RemoteOptions,
        *,
        profile: Profile | str = "plain",
        record: Record | None = None,
        driver: Driver | None = None,
        observers: MakeObservers | None = None,
        report: Callable[[str], None] | None = None,
    ) -> None:
        profile = Profile.load(profile) if isinstance(profile, str) else profile
        super().__init__(transport, types, names, record=record, observers=observers, report=report)
        wire = self.wire
        self.guard = guard = Guard(wire.warn)
        try:
            setting = prepare(scenario, profile, options)
            sources = Sources(wire)
            self.inputs = inputs = RobotInputs(wire, profile, setting.robot, guard, sources)
            self.localizer = self._localizer(setting, options)
            driver = LiveDriver(speed=float("inf")) if driver is None else driver
            frames = profile.frames
            commands = CommandOutput(
                wire, types, profile.topics.cmd_vel, names.frame(frames.base), lambda: inputs.now, sources
            )
            self.commands = commands
            world = setting.world if scenario.known_map else None
            robot = RemoteRobot(setting.robot, world, inputs, commands, self.localizer)
            self._opened.callback(robot.close)
            mission = setting.with_simulator(robot)
            self.context = BridgeContext(wire, profile, SimulationClock(), mission, driver)
            wire.now = lambda: inputs.now
            monitor = GuardedMonitor(guard, _monitor(setting), system.monotonic)
            locates = options.localizer != TF
            latency = setting.scenario.latency
            self._role = RemoteRole(
                self.context,
                robot,
                inputs,
                self.localizer,
                guard,
                monitor,
                locates=locates,
                delay_s=None if latency is None else latency.command_delay_s,
            )
            self._opened.callback(self._role.close)
            for rule in (
                self._located,
                self._connected,
                self._flooded,
                inputs.silences,
                inputs.outline.rule,
                robot.odometry_rule,
                commands.others,
            ):
                guard.add_rule(rule)
            guard.add_rule(inputs.map_odom.others if locates else inputs.map_odom.silence)
            inputs.open()
            self._role.open()
            StaticFrames(wire, profile, setting.robot, inputs, options.static_frames).open()
            if locates or options.start is not None:
                started = StartPose(self.context, inputs, self.localizer, sources)
                started.open()
                self._role.use_start(started)
            self.drive = GoalDrive(options.goals, self.context, self.localizer, guard) if options.goals else None
            if self.drive is not None:
                self._role.use_drive(self.drive)
            wire.on_lost(self._role.lost)
        except BaseException:
            self.close()
            raise

    def _own_observers(self) -> Sequence[Observer]:
        return () if self.drive is None else (self.drive,)

    def _localizer(self, setting: Setting, options: RemoteOptions) -> RemoteLocalizer | TfLocalizer:
        inputs = self.inputs
        if options.localizer == TF:
            return TfLocalizer(inputs.map_odom, options.start)
        has_scans = bool(inputs.sensors)
        try:
            return make_localizer(setting, options, lambda: inputs.odometry is not None, has_scans=has_scans)
        except UnknownNameError as error:
            raise UnknownNameError(error.kind, error.name, (*error.choices, TF)) from None

    # Rules of the guard ---------------------------------------------------------------------------------------------

    def _located(self, now: float) -> Reasons:
        if self.localizer.is_located:
            return {}
        why = self.localizer.why or NOT_LOCATED
        return {MISFIT if why.startswith(MISFIT) else "not located": why}  # the other kind was reported at the start

    def _connected(self, now: float) -> Reasons:
        lost = self.wire.transport.lost
        return {"connection lost": f"the other side is lost: {lost}"} if lost else {}

    def _flooded(self, now: float) -> Reasons:
        """Return which topics are flooded: what the robot said may be among what was dropped."""
        topics = [one.topic for one in tuple(self.wire.inlets) if now - one.flooded_s < FLOODS_S]
        return (
            {"flood": f"{' and '.join(topics)} flooded: more than {MOST_A_SECOND} messages a second"} if topics else {}
        )


def _monitor(setting: Setting) -> CollisionMonitor | None:
    choice = setting.scenario.collision_monitor
    if choice is False or not setting.robot.lidars:
        return None
    return CollisionMonitor(setting.robot, choice if isinstance(choice, MonitorSettings) else None)
