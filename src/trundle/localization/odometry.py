"""`OdometryLocalizer`: the robot is where its odometry says, from the start pose on."""

from __future__ import annotations

from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D
from trundle.localization.localizer import Localizer
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate, Observation
from trundle.robots import Robot


class OdometryLocalizer(Localizer):
    """Adds up odometry from a known start. Nothing corrects its drift: `T_map_odom` stays as it was at the start.

    Args:
        grid: The map, which it does not use.
        robot: The robot.
    """

    def __init__(self, grid: OccupancyGrid | None, robot: Robot) -> None:
        self.reset(Pose2D(0.0, 0.0))

    def reset(self, pose: Pose2D | None, *, covariance: FloatArray | None = None, seed: int = 0) -> None:
        """Start over with the robot at `pose`, map frame, of which the covariance is not used.

        Raises:
            InputError: If there is no pose: nothing but the start says where the robot is.
        """
        if pose is None:
            raise InputError("the localizer 'odometry' needs a start: it only adds up how the robot moves")
        self._start = pose
        self._map_odom: Pose2D | None = None
        self._time: float | None = None

    def update(self, observation: Observation) -> Estimate:
        """Return where the robot is; see `Localizer`."""
        if self._time is not None and not observation.time > self._time:
            raise InputError(
                f"times must increase: an observation of {observation.time:g} s came after one of {self._time:g} s"
            )
        self._time = observation.time
        if self._map_odom is None:
            self._map_odom = self._start @ observation.odometry.inverse()
        return Estimate(observation.time, self._map_odom @ observation.odometry, None, self._map_odom)
