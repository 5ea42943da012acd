"""`BagRobot`: what a recording holds, one observation after the other, in the place of a robot."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Self

import numpy as np

from trundle.bags.bag_content import TRUTH, OdometrySamples
from trundle.bags.bag_reader import BagReader
from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D
from trundle.messages.codec import Distro
from trundle.observation import Observation
from trundle.recordings.drive import DriveStep, RecordedDrive
from trundle.recordings.odometry import OdometryTrack
from trundle.recordings.scan_odometry import ScanOdometry
from trundle.robots import Robot, WheelSpeeds
from trundle.ros2.remote.localizer import RemoteLocalizer
from trundle.ros2.remote.robot import RunTime
from trundle.sim import RobotState, Simulator
from trundle.worlds import World

_STILL = WheelSpeeds(0.0, 0.0)


class BagRobot(Simulator):
    """Gives the observations of a recording; commands change nothing. It stands in for a simulator.

    The pose is the true one where the recording has it, and otherwise what the localizer believes. Times are those of
    the run; `offset` is what the recording's are ahead of them.

    Args:
        drive: The recording.
        robot: The robot.
        localizer: Where it is.
        ended: Called once, when nothing is left: with what broke it off, or "".
        truth: True poses, by the recording's clock; None where it has none.
        begins: Where the robot is on its map at first, for a map whose frame is not that of the true poses.
        lidars: What the robot calls the lidars that have another name in the recording.

    Attributes:
        parts: How often nothing ties the odometry to what it was before.
        scans: How many scans were given.
        damage: What broke the recording off; empty where nothing did.
        true_pose: The true pose now, map frame; None where it is not known.
    """

    def __init__(
        self,
        drive: RecordedDrive,
        robot: Robot,
        localizer: RemoteLocalizer,
        ended: Callable[[str], None],
        *,
        truth: OdometryTrack | None = None,
        begins: Pose2D | None = None,
        lidars: Mapping[str, str] | None = None,
    ) -> None:
        self._drive, self._robot, self._localizer, self._ended, self._truth = drive, robot, localizer, ended, truth
        self._time = RunTime()
        self._steps: Iterator[DriveStep] = iter(())
        self._follower: ScanOdometry | None = None
        self._state: RobotState | None = None
        self._has_ended = False
        self._begins = begins
        self._lidars = {} if lidars is None else lidars
        self._T_map_truth = Pose2D(0.0, 0.0)
        self.true_pose: Pose2D | None = None
        self.parts = self.scans = 0
        self.damage = ""

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self._robot

    @property
    def world(self) -> World | None:
        """None: nobody knows the world."""
        return None

    @property
    def offset(self) -> float:
        """What the recording's clock is ahead of the time of the run [s]."""
        return self._time.offset

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Begin at the beginning of the recording."""
        self._time.begin()
        self._steps = self._drive.steps()
        self._follower = ScanOdometry(self._robot) if self._drive.odometry is None else None
        self._has_ended, self.parts, self.scans, self.damage = False, 0, 0, ""
        return self._advance()

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Return what the robot observed next, whatever is commanded."""
        return self._advance()

    def close(self) -> None:
        """Leave the recording."""
        self._steps = iter(())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _advance(self) -> RobotState:
        """Return the next state; at the end the last one again, a moment later."""
        found = self._next()
        last = self._state
        if found is None:
            if not self._has_ended:
                self._has_ended = True
                self._ended(self.damage)
            if last is None:
                raise InputError(f"{self._drive.path}: {self.damage or 'the recording has no scans that can be used'}")
            self._state = replace(last, time=last.time + 1e-3, scans=())
            return self._state
        self._state = self._observe(found)
        return self._state

    def _next(self) -> Observation | None:
        """Return the next observation with its odometry; None at the end."""
        while not self._has_ended:
            try:
                step = next(self._steps, None)
                if step is None:
                    self.damage = self._drive.damage
                    return None
                if step.begins_part:
                    self.parts += 1
                    self._localizer.doubt()
                    if self._localizer.waits_for_pose:
                        self._localizer.reinitialize_global()
                seen = step.observation
                found = seen if self._follower is None else self._follower.follow(seen)
            except InputError as error:
                self.damage = str(error)
                return None
            if found is not None:
                return found
        return None

    def _observe(self, seen: Observation) -> RobotState:
        time = self._time.at(seen.time, (self.parts, 0, False))
        offset = self._time.offset
        names = self._lidars
        scans = tuple(
            replace(scan, lidar=names.get(scan.lidar, scan.lidar), time=min(scan.time - offset, time))
            for scan in seen.scans
        )
        self.scans += len(scans)
        now = replace(seen, time=time, scans=scans)
        truth = self._truth
        self.true_pose = None
        if truth is not None and truth.knows(seen.time, seen.time):
            pose, _ = truth.at(seen.time)
            if self._begins is not None:
                self._T_map_truth, self._begins = self._begins @ pose.inverse(), None
            self.true_pose = self._T_map_truth @ pose
        pose = self._localizer.update(now).pose if self.true_pose is None else self.true_pose
        return RobotState(time, pose, now.twist, _STILL, _STILL, now.odometry, scans=scans, odometry_twist=now.twist)


def read_truth(drive: RecordedDrive, distro: Distro) -> OdometryTrack | None:
    """Return the true poses that trundle's own recordings have, over time; None where there are none.

    Of a bag that is cut off, the poses before count. Another one that is damaged is left to whoever reads the scans.
    """
    found = OdometrySamples()
    try:
        with BagReader(drive.recovered or drive.path, distro=distro) as bag:
            for _, _, message in bag.messages([topic for topic in bag.topics if topic.name == TRUTH]):
                found.add(message)
    except InputError:
        pass
    if len(found.times) < 2:
        return None
    times, first = np.unique(np.array(found.times), return_index=True)
    return OdometryTrack(times, np.array(found.poses)[first])
