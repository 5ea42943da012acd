"""`MovingThings` and `CarriedAway`: what of a scan, and which scans, must not be matched and mapped."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import numpy.typing as npt

from trundle.control.sensed_points import SensedPoints
from trundle.geometry import FloatArray, Pose2D
from trundle.localization.amcl.scene import Scene
from trundle.mapping.nodes import Surface
from trundle.observation import Observation
from trundle.robots import Robot

_SLOWEST_M_S = 0.2  # what is slower is noise
_CELL_M = 0.15  # points in a cell where something moves, or in one beside it, are of the same thing
_ROW = 1 << 20  # of cells, farther than any lidar sees
_AROUND = np.add.outer((-_ROW, 0, _ROW), (-1, 0, 1)).ravel()
_LEAST_SHARE = 0.5  # where less than that stands, the wheels slip, and it is the robot that does not move
_OLDEST_S = 0.5  # older scans are not compared with
_FARTHEST_M = 20.0  # beyond, beams of half a degree are more than a cell apart


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
        """Return the points of an observation that do not move, base_link [m].

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
    """Return the number of each point's cell, shape (N,)."""
    col, row = np.floor(points / _CELL_M).astype(np.int64).T
    return row * _ROW + col


_NEAR_M, _NEAR_RAD = 2.0, 1.0  # after longer steps a scan may well show another place
_FEWEST_POINTS = 50  # the fit of fewer says little
# Nothing of what is seen is known, in so many scans. On five public logs, with odometry that turns by 2° a metre, the
# worst scan of 8,400 fits by 0.27.
_STRANGE_FIT, _STRANGE_SCANS = 0.1, 3
# Or scans fit worse than this, and contradict the one before: on these logs single ones do, never two in a row. Scans
# a metre apart contradict each other by themselves; to leave such single ones out took ACES from 0.100 to 0.125 m.
_SURPRISING_FIT, _STEP_M, _STEP_RAD = 0.6, 0.5, 0.5


class CarriedAway:
    """Judges scan by scan.

    Args:
        longest: The longest beams that are used [m].
    """

    def __init__(self, longest: float) -> None:
        # A scan is compared with the last one that was matched, however long the robot stood in between.
        self._scene = Scene(longest, oldest_s=math.inf)
        self._strange = 0
        self._unknown = np.zeros(2)  # how far it drove and turned since a scan showed what was known [m, rad]

    def judge(
        self, observation: Observation, moved: Pose2D, fit: float, points: int
    ) -> Literal["here", "in doubt", "carried away"]:
        """Return whether scans show the place where the robot should be; what is in doubt should not be mapped.

        Args:
            observation: The scans.
            moved: Motion by the odometry since the last scans that showed the place where the robot should be.
            fit: How well they fit to what was seen before, 0 to 1.
            points: How many of their points were matched.
        """
        far, turn = math.hypot(moved.x, moved.y), abs(moved.yaw)
        surprising = far < _STEP_M and turn < _STEP_RAD and fit < _SURPRISING_FIT and points >= _FEWEST_POINTS
        if self._scene.is_another(observation.scans, observation.odometry, surprising=surprising):
            return "carried away"
        # After a way on which it saw nearly nothing, a wall that it comes to may well be one that it has not seen.
        way = self._unknown + np.array((far, turn))
        strange = bool((way < (_NEAR_M, _NEAR_RAD)).all()) and fit < _STRANGE_FIT and points >= _FEWEST_POINTS
        self._strange = self._strange + 1 if strange else 0
        if self._strange >= _STRANGE_SCANS:
            return "carried away"
        if self._strange or self._scene.is_doubtful:
            return "in doubt"
        self._unknown = np.zeros(2) if fit >= _STRANGE_FIT and points >= _FEWEST_POINTS else way
        return "here"
