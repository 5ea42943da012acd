"""`Motion`: how the odometry says that the robot moved, and how uncertain that is (Nav2's differential model)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.localization.amcl.amcl_settings import AmclSettings

_SMALL_M = 1e-4  # of less, the direction is noise
_LEAST_M, _LEAST_RAD = 0.001, 0.001
"""Noise of an update in which the robot stands: particles stay apart, and a slow drift can be followed."""

_LEAST_TRAVEL_M = 0.01
_SLIPPED_M = 0.1  # a correction by more is no steady error
_GAIN = 0.03
_MOST_SCALE, _MOST_HEADING = 0.15, 0.2  # as far as odometry is used at all


@dataclass(frozen=True, slots=True)
class Motion:
    """A turn, a distance and another turn, with their deviations.

    Attributes:
        delta: Pose of base_link after the motion, seen from before it.
        turn: The first turn [rad].
        distance: [m], negative backwards.
        last_turn: The turn at the end [rad].
    """

    delta: Pose2D
    turn: float
    distance: float
    last_turn: float

    @classmethod
    def between(cls, before: Pose2D, after: Pose2D) -> Motion:
        """Return the motion between two poses of the odometry."""
        delta = before.inverse() @ after
        distance = math.hypot(delta.x, delta.y)
        if distance < _SMALL_M:
            return cls(delta, 0.0, 0.0, delta.yaw)
        turn = math.atan2(delta.y, delta.x)
        if abs(turn) > 0.5 * math.pi:  # a robot that drives backwards does not turn round first
            turn, distance = wrap_angle(turn + math.pi), -distance
        return cls(delta, turn, distance, wrap_angle(delta.yaw - turn))

    @property
    def numbers(self) -> FloatArray:
        """Turn, distance, turn, as the kernels take them."""
        return np.array((self.turn, self.distance, self.last_turn))

    @property
    def travel(self) -> float:
        """How much new a scan shows after it [m]: the distance, and half a metre for each radian."""
        return abs(self.distance) + 0.5 * abs(self.delta.yaw)

    def variances(self, settings: AmclSettings) -> tuple[float, float, float]:
        """Variances of the distance along and across [m²], and of the yaw [rad²]."""
        d2, t1, t2 = self.distance**2, self.turn**2, self.last_turn**2
        along = settings.alpha3 * d2 + settings.alpha4 * (t1 + t2)
        first = settings.alpha1 * t1 + settings.alpha2 * d2
        last = settings.alpha1 * t2 + settings.alpha2 * d2
        return along + _LEAST_M**2, first * d2 + _LEAST_M**2, first + last + _LEAST_RAD**2


class OdometryBias:
    """The steady error of the odometry, as scans show it: a scale, and a turn for each metre.

    Scan matching corrects every motion a little. Where these corrections go one way on average, the odometry has a
    bias, and is corrected beforehand; so the estimate does not lag behind.
    """

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Forget it."""
        self._scale = 0.0
        self._heading = 0.0

    def corrected(self, motion: Motion) -> Motion:
        """Return a motion without the bias."""
        distance = motion.distance
        if distance == 0.0 or self._scale == self._heading == 0.0:
            return motion
        delta, turned = motion.delta, self._heading * distance
        half = Pose2D(0.0, 0.0, 0.5 * turned)
        scale = 1.0 + self._scale
        straight = half @ Pose2D(delta.x * scale, delta.y * scale, delta.yaw) @ half
        return Motion(straight, motion.turn + 0.5 * turned, distance * scale, motion.last_turn + 0.5 * turned)

    def learn(self, motion: Motion, correction: Pose2D) -> None:
        """Take what scan matching changed after a motion, in the frame of the robot."""
        distance = motion.distance
        if abs(distance) < _LEAST_TRAVEL_M or math.hypot(correction.x, correction.y) > _SLIPPED_M:
            return
        self._scale = _clip(self._scale + _GAIN * correction.x / distance, _MOST_SCALE)
        self._heading = _clip(self._heading + _GAIN * correction.yaw / distance, _MOST_HEADING)


def _clip(value: float, most: float) -> float:
    return min(most, max(-most, value))


LEAST = np.array((_LEAST_M, _LEAST_RAD))
