"""`Senses`: what a robot observes and where it believes to be, of what a simulator says."""

from __future__ import annotations

from dataclasses import replace

from trundle.control.latency import Latency
from trundle.errors import InputError
from trundle.fault import check_result
from trundle.geometry import Pose2D
from trundle.localization import create_localizer
from trundle.localization.localizer import LocalizerLike
from trundle.maps import OccupancyGrid
from trundle.mission.running.scan_mail import ScanMail
from trundle.observation import Estimate, Observation
from trundle.robots import Robot
from trundle.sim import RobotState

_AT_ODOM_ORIGIN = Pose2D(0.0, 0.0)


class Senses:
    """Delays scans, and estimates the pose.

    Args:
        localizer: Estimates the pose; see `LocalizerLike`. None means the true pose.
        grid: The map that a class of localizers gets, or None.
        robot: The robot.
        latency: How late scans arrive.
    """

    def __init__(
        self, localizer: LocalizerLike | None, grid: OccupancyGrid | None, robot: Robot, latency: Latency
    ) -> None:
        self._localizer = None if localizer is None else create_localizer(localizer, grid, robot)
        self._mail = ScanMail(latency.scan_age_s) if latency.scan_age_s > 0.0 else None

    def reset(self, start: Pose2D, *, seed: int) -> None:
        """Begin a run."""
        if self._localizer is not None:
            self._localizer.reset(start, seed=seed)

    def relocate(self, pose: Pose2D, observation: Observation, *, seed: int) -> Estimate:
        """Tell the localizer where the robot is; what it believes then, by what was observed last.

        Raises:
            InputError: If there is no localizer.
        """
        if self._localizer is None:
            raise InputError("the robot knows its true pose: there is no localizer whose pose could be set")
        self._localizer.reset(pose, seed=seed)
        return check_result(self._localizer.update(observation), Estimate, self._localizer, "update")

    def place(self, state: RobotState, observation: Observation, estimate: Estimate) -> tuple[Observation, Estimate]:
        """What the robot observes and believes where it was put, at rest: a localizer does not notice."""
        observation = replace(observation, twist=state.twist, scans=())
        if self._localizer is None:
            estimate = Estimate(state.time, state.pose, None, _AT_ODOM_ORIGIN)
        return observation, estimate

    def observe(self, state: RobotState) -> tuple[Observation, Estimate]:
        """Take what the robot observes now, and estimate where it is."""
        observation = state.observation
        if self._mail is not None:
            observation = replace(observation, scans=self._mail.deliver(state.time, observation.scans))
        if self._localizer is None:
            return observation, Estimate(state.time, state.pose, None, _AT_ODOM_ORIGIN)
        return observation, check_result(self._localizer.update(observation), Estimate, self._localizer, "update")

    def believed(self, estimate: Estimate) -> Pose2D | None:
        """Where the localizer believes the robot to be; none without one."""
        return None if self._localizer is None else estimate.pose
