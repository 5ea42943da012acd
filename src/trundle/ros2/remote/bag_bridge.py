"""`BagBridge`: a recording is played into the navigator's localizer, and what comes of it is published."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from trundle.errors import InputError
from trundle.geometry import FloatArray, wrap_angle
from trundle.messages.qos import LATCHED
from trundle.mission import End, Episode, Observer, RunInfo, Scenario, Session, Step
from trundle.mission.setup import SessionOptions
from trundle.observation import Scan
from trundle.recordings.drive import RecordedDrive
from trundle.recordings.odometry import OdometryTrack
from trundle.robots import Lidar, Robot
from trundle.ros2.inlet import Record
from trundle.ros2.names import Names
from trundle.ros2.navigator_role.role import NavigatorOutputs, NavigatorRole
from trundle.ros2.outputs.lidar import SCANS
from trundle.ros2.outputs.motion import MotionOutput
from trundle.ros2.outputs.output import Output
from trundle.ros2.outputs.robot import ClockOutput
from trundle.ros2.profile import Profile
from trundle.ros2.remote.bag_robot import BagRobot
from trundle.ros2.remote.localizer import RemoteLocalizer
from trundle.ros2.remote.setting import RemoteOptions, make_localizer, prepare
from trundle.ros2.role import BridgeContext, Driver, LiveDriver, SimulationClock
from trundle.ros2.runs import MakeObservers, NetworkRuns

if TYPE_CHECKING:
    from trundle.ros2.transport.transport import Transport
    from trundle.ros2.types import Types

NOTHING_DRIVES = "a recording is played: nothing can be driven"
ENDED = "the recording has ended"


class BagBridge(NetworkRuns):
    """Plays a recording, and publishes its clock, odometry and scans with what the navigator makes of them.

    Nothing is heard from the network but poses, and nothing is commanded. The run ends with the recording.

    Args:
        scenario: Map and localizer.
        drive: The recording.
        transport: Carries the bytes; `close` closes it.
        types: The messages.
        names: Namespace and remaps.
        options: Where the robot is at first; without that its localizer searches, or begins its map there.
        profile: Names of topics and frames: a profile, or the name of one.
        truth: True poses over time, where the recording has them.
        record: Keeps what goes over the wire.
        speed: How fast it is played relative to real time, 0.1 to 50, or infinity for as fast as it can.
        driver: Drives and steers the runs, as a page does. If None, it is played at `speed`.
        observers: Makes what else follows each run.
        report: Gets warnings and remarks. If None, the log does.

    Attributes:
        summary: What came of it.

    Raises:
        InputError: If the scenario, the profile or a name cannot be used.
    """

    def __init__(
        self,
        scenario: Scenario,
        drive: RecordedDrive,
        transport: Transport,
        types: Types,
        names: Names,
        options: RemoteOptions,
        *,
        profile: Profile | str = "plain",
        truth: OdometryTrack | None = None,
        record: Record | None = None,
        speed: float = math.inf,
        driver: Driver | None = None,
        observers: MakeObservers | None = None,
        report: Callable[[str], None] | None = None,
    ) -> None:
        profile = Profile.load(profile) if isinstance(profile, str) else profile
        super().__init__(transport, types, names, record=record, observers=observers, report=report)
        try:
            setting = prepare(scenario, profile, options, robot=_with_lidars(drive))
            localizer = make_localizer(setting, options, lambda: True, has_scans=True)
            if localizer.waits_for_pose:
                localizer.reinitialize_global()
            driver = LiveDriver(speed=speed) if driver is None else driver
            begins = None if scenario.known_map else setting.start
            lidars = _name_lidars(drive, profile, setting.robot)
            robot = BagRobot(drive, setting.robot, localizer, self._end, truth=truth, begins=begins, lidars=lidars)
            self._opened.enter_context(robot)
            mission = setting.with_simulator(robot)
            self.context = BridgeContext(self.wire, profile, SimulationClock(), mission, driver)
            self.wire.now = lambda: self.context.clock.now
            self.summary = BagSummary(robot)
            self._role = _BagRole(self.context, localizer)
            self._opened.callback(self._role.close)
            self._role.open()
            self._outputs = _BagOutputs(self.context, robot, tuple(lidars.values()))
        except BaseException:
            self.close()
            raise

    def _own_observers(self) -> Sequence[Observer]:
        return self._outputs, self.summary

    def _end(self, damage: str) -> None:
        why = f"the recording breaks off: {damage}" if damage else ENDED
        self.context.driver.steering.put(End(why), by="--bag")


def _with_lidars(drive: RecordedDrive) -> Robot:
    """Return the robot of a recording; one that nobody knows has at least the lidars that were recorded."""
    robot = drive.robot
    if drive.knows_robot:
        return robot
    return robot.model_copy(update={"lidars": {name: Lidar(x=0.0, y=0.0, z=0.2) for name in drive.lidars}})


def _name_lidars(drive: RecordedDrive, profile: Profile, robot: Robot) -> dict[str, str]:
    """Return what the robot calls each lidar of a recording, which are named by their frames there."""
    sensors = profile.sensors_of(robot)
    if len(sensors) == len(drive.lidars) == 1:
        return {drive.lidars[0]: next(iter(sensors))}
    known = {sensor.frame or name: name for name, sensor in sensors.items()}
    return {name: known.get(name, name) for name in drive.lidars}


class _BagRole(NavigatorRole):
    """The navigator, whose robot is a recording: it is located, and drives nowhere."""

    def __init__(self, context: BridgeContext, localizer: RemoteLocalizer) -> None:
        super().__init__(context)
        self._localizer = localizer
        self._kit.tasks.refuse("recording", NOTHING_DRIVES)

    def use_map(self, path: Path) -> None:
        """Refuse another map: where the robot was on it, nobody knows.

        Raises:
            InputError: Always.
        """
        raise InputError(f"a recording is played on one map: start trundle with {path}")

    def begin(self, observers: Sequence[Observer], seed: int | None) -> Session:
        """Begin to play the recording."""
        self._pose_output.begin()
        self._localizer.begin()
        options: SessionOptions = {"localizer": self._localizer, "latency": None, "monitor": False}
        outputs = NavigatorOutputs(self._kit, self._outputs, self._markers)
        return self._context.begin_session(self._context.mission.navigator, [*observers, outputs], seed, options)


class _BagOutputs:
    """Publishes the clock, the odometry and the scans of a recording; an observer."""

    def __init__(self, context: BridgeContext, robot: BagRobot, lidars: Sequence[str]) -> None:
        self._context, self._robot = context, robot
        topics, frame = context.profile.topics, context.wire.names.frame
        self._outputs: list[Output] = [] if topics.clock is None else [ClockOutput(context, topics.clock)]
        self._outputs.append(MotionOutput(context))
        self._base = frame(context.profile.frames.base)
        self._mounts: dict[str, Scan] = {}
        wire = context.wire
        self._static = None
        if topics.tf_static is not None:
            self._static = wire.outlet(topics.tf_static, "tf2_msgs/msg/TFMessage", LATCHED)
        self._scans = {
            name: wire.outlet(
                "scan" if len(lidars) == 1 else f"{_as_name(name)}/scan", "sensor_msgs/msg/LaserScan", SCANS
            )
            for name in lidars
        }

    def on_start(self, run: RunInfo) -> None:
        """Start the clock."""
        self._context.clock.begin()

    def on_step(self, step: Step) -> None:
        """Publish an observation, at its time in the recording."""
        clock = self._context.clock
        clock.offset = self._robot.offset
        time = clock.set(step.state.time)
        for output in self._outputs:
            output.publish(step, time)
        for scan in step.state.scans:
            self._publish(scan)

    def on_end(self, episode: Episode) -> None:
        """Do nothing."""

    def _publish(self, scan: Scan) -> None:
        name, make = scan.lidar, self._context.maker
        if name not in self._mounts and self._static is not None:
            self._mounts[name] = scan
            self._static.write(
                make.transforms(
                    [make.transform(0.0, self._base, one.lidar, one.mount, one.height) for one in self._mounts.values()]
                )
            )
        outlet = self._scans.get(name)
        if outlet is not None and outlet.is_wanted:
            outlet.write(make.scan(replace(scan, time=scan.time + self._robot.offset), name))


def _as_name(lidar: str) -> str:
    """Return a part of a topic's name for a lidar that is called by its frame."""
    return re.sub(r"[^A-Za-z0-9_]+", "_", lidar).strip("_") or "lidar"


class BagSummary:
    """What came of a recording that was played; an observer.

    Args:
        robot: What plays it.
    """

    def __init__(self, robot: BagRobot) -> None:
        self._robot = robot
        self._states: dict[str, float] = {}
        self._errors: list[tuple[float, float]] = []
        self._last_s = 0.0
        self._state = "lost"

    @property
    def is_whole(self) -> bool:
        """Whether it was played to its end, and the robot knew where it was there."""
        return not self._robot.damage and self._state == "localized"

    def on_start(self, run: RunInfo) -> None:
        """Do nothing."""

    def on_step(self, step: Step) -> None:
        """Count how long the robot was where it believed to be, and how far from there."""
        estimate, truth = step.estimate, self._robot.true_pose
        if estimate is None:
            return
        self._state = estimate.state
        self._states[estimate.state] = self._states.get(estimate.state, 0.0) + step.state.time - self._last_s
        self._last_s = step.state.time
        if truth is not None and step.state.scans and estimate.state == "localized":
            pose = estimate.pose
            self._errors.append((pose.distance_to(truth), abs(wrap_angle(pose.yaw - truth.yaw))))

    def on_end(self, episode: Episode) -> None:
        """Do nothing."""

    def as_dict(self) -> dict[str, object]:
        """Return it as plain values; errors are those at scans while the robot was localized [m, rad]."""
        robot = self._robot
        return {
            "scans": robot.scans,
            "parts": robot.parts + 1,
            "states_s": {name: round(seconds, 2) for name, seconds in self._states.items()},
            "error": _describe_errors(np.array(self._errors)) if self._errors else None,
            "damage": robot.damage or None,
        }


def _describe_errors(errors: FloatArray) -> dict[str, float]:
    """Return mean, 95th percentile, largest and last of the errors [m, rad], shape (N, 2)."""
    found: dict[str, float] = {}
    for name, values in (("m", errors[:, 0]), ("rad", errors[:, 1])):
        found |= {
            f"mean_{name}": float(values.mean()),
            f"p95_{name}": float(np.percentile(values, 95.0)),
            f"max_{name}": float(values.max()),
            f"last_{name}": float(values[-1]),
        }
    return {name: round(value, 4) for name, value in found.items()}
