"""`BlindDriving`: takes note that a robot drives on without scans, by which its localizer would find it."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np

from trundle.errors import SensorWarning
from trundle.geometry import Pose2D, wrap_angle
from trundle.observation import Estimate, Observation
from trundle.robots import Robot

_SILENT_S = 2.0
_PERIODS = 2.0  # of the robot's slowest lidar, where that is longer
_DRIVEN_M, _DRIVEN_RAD = 0.1, 0.2
"""A robot that has moved less since its last scan stands, give or take the noise of its odometry."""

_LOST = np.diag((1.0, 1.0, 0.5**2))


class BlindDriving:
    """Marks estimates as lost while the robot drives without scans: nothing but its odometry says where it is.

    Args:
        robot: The robot.
        name: Name of the localizer, for the warning.
    """

    def __init__(self, robot: Robot, name: str) -> None:
        self._name = name
        self._most_s = max((_SILENT_S, *(_PERIODS / lidar.rate for lidar in robot.lidars.values())))
        self.reset()

    def reset(self) -> None:
        """Forget what was observed."""
        self._seen: tuple[float, Pose2D] | None = None  # time and odometry at the last scan, or at first
        self._has_driven = False
        self._has_warned = False

    def judge(self, observation: Observation, estimate: Estimate) -> Estimate:
        """Return an estimate, marked as lost where the robot has driven without scans for 2 s.

        Warns:
            SensorWarning: The first time.
        """
        if observation.scans or self._seen is None:
            self._seen, self._has_driven = (observation.time, observation.odometry), False
            return estimate
        time, odometry = self._seen
        moved, turned = odometry.distance_to(observation.odometry), wrap_angle(observation.odometry.yaw - odometry.yaw)
        self._has_driven = self._has_driven or moved > _DRIVEN_M or abs(turned) > _DRIVEN_RAD
        silent_s = observation.time - time
        if not self._has_driven or silent_s <= self._most_s:
            return estimate
        if not self._has_warned:
            self._has_warned = True
            warnings.warn(
                f"the robot drives, and the localizer {self._name!r} has got no scan for {silent_s:.1f} s: it cannot "
                "correct the odometry, and says that it is lost until there is one; give it the scans of the robot's "
                "lidars, or use the localizer 'odometry'",
                SensorWarning,
                stacklevel=3,
            )
        if estimate.state != "localized":
            return estimate
        spread = None if estimate.covariance is None else estimate.covariance + _LOST
        if spread is not None:
            spread.flags.writeable = False
        return replace(estimate, state="lost", covariance=spread)
