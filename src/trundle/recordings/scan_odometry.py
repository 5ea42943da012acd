"""`ScanOdometry`: odometry from scans alone, for recordings without any.

Each scan is matched with the surfaces that the last key scans saw, within what a robot can drive meanwhile (the
mapper's own correlative search, with a wider window), from where it would be if it went on as before.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D
from trundle.localization.amcl.beams import BeamPicker
from trundle.mapping.nodes import MOST_POINTS, make_surface
from trundle.mapping.window import ScanWindow
from trundle.observation import Observation
from trundle.robots import Robot

_FASTEST_MPS, _FASTEST_RADPS = 1.0, 1.2  # beyond the speed so far: how much it can change, and what was not predicted
_LEAST_M, _LEAST_RAD = 0.15, 0.12  # the search is at least so wide, and at most
_MOST_M, _MOST_RAD = 1.5, 1.0
_KEY_M, _KEY_RAD = 0.3, math.radians(15.0)  # denser than a mapper's: there is no odometry between them
_GOOD_FIT = 0.35
_VAGUE_M = 0.15  # standard deviation: along a corridor a scan fits anywhere
_MOST_POOR_SHARE = 0.1
_HOPELESS_SHARE = 0.3  # nothing is gained by reading on
_LEAST_SCANS = 20


class ScanOdometry:
    """Gives observations of a recording without odometry the motion that their scans show.

    Args:
        robot: The robot, whose outline is left out of the scans.
    """

    def __init__(self, robot: Robot) -> None:
        self._picker = BeamPicker(robot, MOST_POINTS, None)
        self._window = ScanWindow()
        self._pose, self._speed = Pose2D(0.0, 0.0), (0.0, 0.0, 0.0)
        self._key = Pose2D(0.0, 0.0)
        self._time: float | None = None
        self._seen = self._poor = self._vague = 0
        self._first_poor: float | None = None

    def follow(self, observation: Observation) -> Observation | None:
        """Return an observation with odometry from its scans; None where its scans have nothing to go by.

        Raises:
            InputError: If so many scans do not fit that the scans alone cannot suffice.
        """
        standing = replace(observation, odometry=Pose2D(0.0, 0.0))
        self._picker.follow(standing)
        if not observation.scans:
            return None
        beams = self._picker.pick(standing)
        if beams is None or len(beams.points) < 10:
            return None
        surface = make_surface(beams.points, beams.sensors)
        time = observation.time
        if self._time is None:
            self._window.add(surface, self._pose)
            self._time = time
            return replace(observation, odometry=self._pose, twist=Twist2D(0.0, 0.0))
        seconds = max(1e-3, time - self._time)
        ahead = min(seconds, 1.0)
        step = Pose2D(self._speed[0] * ahead, self._speed[1] * ahead, self._speed[2] * ahead)
        metres = min(_MOST_M, _LEAST_M + _FASTEST_MPS * seconds)
        radians = min(_MOST_RAD, _LEAST_RAD + _FASTEST_RADPS * seconds)
        spread = np.diag(((metres / 3.0) ** 2, (metres / 3.0) ** 2, (radians / 3.0) ** 2))
        match = self._window.match(surface, self._pose @ step, spread)
        is_good = self._count(match.fit, float(np.sqrt(np.linalg.eigvalsh(match.covariance[:2, :2])[-1])), time)
        pose = match.pose if is_good else self._pose @ step
        moved = self._pose.inverse() @ pose
        self._speed = moved.x / seconds, moved.y / seconds, moved.yaw / seconds
        self._pose, self._time = pose, time
        since = self._key.inverse() @ pose
        if math.hypot(since.x, since.y) > _KEY_M or abs(since.yaw) > _KEY_RAD:
            self._window.add(surface, pose)
            self._key = pose
        return replace(observation, odometry=self._pose, twist=Twist2D(self._speed[0], self._speed[2]))

    def _count(self, fit: float, vague: float, time: float) -> bool:
        """Count a match; whether it can be believed."""
        self._seen += 1
        if fit >= _GOOD_FIT and vague <= _VAGUE_M:
            return True
        self._poor += fit < _GOOD_FIT
        self._vague += fit >= _GOOD_FIT
        self._first_poor = time if self._first_poor is None else self._first_poor
        if self._seen >= _LEAST_SCANS and self._poor + self._vague > _HOPELESS_SHARE * self._seen:
            self.check()
        return False

    def check(self) -> str:
        """Return how good it was.

        Raises:
            InputError: If the scans alone do not suffice.
        """
        bad = self._poor + self._vague
        if self._seen < _LEAST_SCANS or bad > _MOST_POOR_SHARE * self._seen:
            why = f"only {self._seen} scans can be matched"
            if bad:
                why = (
                    f"of {self._seen} scans {self._poor} do not fit what was seen before, and {self._vague} fit at "
                    f"several places, the first one at {self._first_poor:.1f} s"
                )
            raise InputError(
                f"the recording has no odometry, and its scans alone do not suffice: {why}. Record the odometry "
                "(nav_msgs/Odometry or /tf) too, or scans more often"
            )
        return f"no odometry: the motion is that of the scans ({self._seen - bad} of {self._seen} fit well)"
