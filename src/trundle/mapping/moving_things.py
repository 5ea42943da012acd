"""`MovingThings`: which points of a scan are on people and vehicles, and must not be matched."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle.control.sensed_points import SensedPoints
from trundle.geometry import FloatArray
from trundle.mapping.nodes import Surface
from trundle.observation import Observation
from trundle.robots import Robot

_SLOWEST_M_S = 0.2  # what is slower is noise
_CELL_M = 0.15  # points in a cell where something moves, or in one beside it, are of the same thing
_ROW = 1 << 20  # of cells, farther than any lidar sees
_AROUND = np.add.outer((-_ROW, 0, _ROW), (-1, 0, 1)).ravel()
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
        stands = ~np.isin(_cells(surface.points), (_cells(moving)[:, None] + _AROUND).ravel())
        if stands.mean() < _LEAST_SHARE:
            return surface
        return Surface(*(array[stands] for array in (surface.points, surface.normals, surface.sensors)))


def _cells(points: FloatArray) -> npt.NDArray[np.int64]:
    """The number of each point's cell, shape (N,)."""
    col, row = np.floor(points / _CELL_M).astype(np.int64).T
    return row * _ROW + col
