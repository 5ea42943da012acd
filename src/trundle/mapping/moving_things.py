"""`MovingThings`: which points of a scan are on people and vehicles, and must not be matched."""

from __future__ import annotations

import numpy as np

from trundle.control.sensed_points import SensedPoints
from trundle.mapping.nodes import Surface
from trundle.observation import Observation
from trundle.robots import Robot

_SLOWEST_M_S = 0.2  # what is slower is noise
_NEAR_M = 0.25  # of a hit that moves: of the same thing
_LEAST_SHARE = 0.5  # where less than that stands, the wheels slip, and it is the robot that does not move
_OLDEST_S = 0.5
_FARTHEST_M = 20.0


class MovingThings:
    """Compares the scans of each lidar with those a quarter of a second before.

    A scan that shows people who walk along with the robot fits best where they stand still: in a corridor, where
    nothing else tells how far along it the robot is, the match would follow them.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: Robot) -> None:
        self._sensed = SensedPoints(robot.planar)

    def leave_out(self, surface: Surface, observation: Observation) -> Surface:
        """Take an observation and what it saw, and return the points that stand, [m] in base_link.

        Where the robot was is taken from the odometry alone: by matches that have begun to go with people, these stand.
        """
        time, pose = observation.time, observation.odometry
        self._sensed.add(observation.scans, time, pose)
        seen = self._sensed.around(time, pose, _FARTHEST_M, 0.0, time - _OLDEST_S)
        if not seen.moves:
            return surface
        moving = seen.places[np.hypot(*seen.velocities.T) >= _SLOWEST_M_S]
        if not len(moving):
            return surface
        low, high = moving.min(axis=0) - _NEAR_M, moving.max(axis=0) + _NEAR_M
        points = surface.points
        close = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
        apart = points[close, None, :] - moving[None, :, :]
        close = close[((apart**2).sum(axis=2) <= _NEAR_M**2).any(axis=1)]
        if len(points) - len(close) < _LEAST_SHARE * len(points):
            return surface
        stands = np.ones(len(points), dtype=bool)
        stands[close] = False
        return Surface(*(array[stands] for array in (points, surface.normals, surface.sensors)))
