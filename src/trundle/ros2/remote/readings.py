"""Messages of sensors as trundle's values: scans, with the mistakes that drivers make; odometry."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D, integrate_twist, wrap_angle
from trundle.messages import readers
from trundle.observation import Scan
from trundle.ros2.bad_input import BadInputError, check_pose, check_twist
from trundle.ros2.remote.mounts import Mount

MOST_BEAMS = 100_000
_STEP_SHARE = 0.02
"""Angles of the last beam that differ by more than this share of the field of view do not match."""

_LONGEST_EXTRAPOLATION_S = 0.3

Remark = tuple[str, str]
"""What is wrong and taken all the same: its kind, and the text."""


@dataclass(frozen=True, slots=True)
class Odometry:
    """Odometry that has arrived.

    Attributes:
        time: Its stamp [s], on the robot's clock.
        pose: Pose of the base in the odom frame.
        twist: Its twist.
    """

    time: float
    pose: Pose2D
    twist: Twist2D

    def at(self, time: float) -> Pose2D:
        """Return where the robot is at a later time [s], if it goes on like this."""
        ahead = min(max(0.0, time - self.time), _LONGEST_EXTRAPOLATION_S)
        x, y, yaw = integrate_twist(*self.pose.as_tuple(), self.twist.v, self.twist.w, ahead)
        return Pose2D(x, y, wrap_angle(yaw))


def read_scan(message: Any, lidar: str, time: float, mount: Mount) -> tuple[Scan, list[Remark]]:
    """Read a sensor_msgs/LaserScan.

    Ranges of 0 or below, which many drivers send for "no return", are no measurements. A range below `range_min` is
    too close, one above `range_max` is none.

    Args:
        message: The message.
        lidar: Name of the lidar.
        time: Time of its first beam [s].
        mount: Where the lidar is.

    Returns:
        The scan, and what is wrong with the message.

    Raises:
        BadInputError: If it is no scan.
    """
    ranges = np.array(message.ranges, dtype=np.float64)
    count = len(ranges)
    first, last, step = float(message.angle_min), float(message.angle_max), float(message.angle_increment)
    least, most = float(message.range_min), float(message.range_max)
    if not 0 < count <= MOST_BEAMS:
        raise BadInputError("no beams", f"it has {count} beams, and not 1 to {MOST_BEAMS}")
    if not all(math.isfinite(number) for number in (first, last, step, least)) or math.isnan(most):
        raise BadInputError("not finite", "an angle or a range limit is not finite")
    remarks: list[Remark] = []
    if step == 0.0 and count > 1:
        step = (last - first) / (count - 1)
        remarks.append(("no angle_increment", "angle_increment is 0: the beams are spread from angle_min to angle_max"))
    if count > 1 and abs(last - first) > abs(step) and (last - first) * step < 0.0:
        raise BadInputError(
            "reversed angles",
            f"its angles run from {first:g} to {last:g} rad by steps of {step:g} rad, which point the other way",
        )
    end = first + (count - 1) * step
    if abs(end - last) > max(1.5 * abs(step), _STEP_SHARE * abs(end - first)):
        text = f"{count} beams of {step:g} rad end at {end:g} rad, and angle_max is {last:g} rad: angle_max is ignored"
        remarks.append(("angle_max", text))
    if abs(end - first) > 2.5 * 2.0 * math.pi:
        raise BadInputError("angles", f"its beams cover {abs(end - first):g} rad, which is more than two turns")
    most = most if 0.0 < most < 1e6 else 1e6
    least = min(max(0.0, least), most - 1e-3)
    ranges[~(ranges > 0.0) & ~np.isneginf(ranges)] = np.nan
    ranges[(ranges < least) & np.isfinite(ranges)] = -math.inf
    ranges[ranges > most] = math.inf
    angles = first + step * np.arange(count, dtype=np.float64)
    between = float(message.time_increment)
    between = between if math.isfinite(between) and 0.0 <= between * count <= 2.0 else 0.0
    if mount.is_upside_down:
        angles = -angles
    if mount.is_tilted:
        remarks.append(("tilted", "its lidar is tilted by more than 10° on the robot: it is taken as level"))
    try:
        return Scan(lidar, time, mount.pose, mount.height, angles, ranges, least, most, between), remarks
    except InputError as error:
        raise BadInputError("no scan", str(error)) from error


def read_odometry(message: Any) -> tuple[float, Pose2D, Twist2D]:
    """Read a nav_msgs/Odometry: its stamp [s], the pose, and the twist.

    Raises:
        BadInputError: If a number is not finite, or the quaternion is no rotation.
    """
    pose, twist = check_pose(message.pose.pose), check_twist(message.twist.twist)
    return readers.read_stamp(message.header.stamp), pose, twist
