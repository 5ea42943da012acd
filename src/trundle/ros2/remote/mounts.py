"""`Mounts`: where lidars are on the robot, by tf or by the robot's file."""

from __future__ import annotations

import math

import numpy as np

from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.robots import Robot
from trundle.ros2.profile import Sensor
from trundle.ros2.remote.frames import FrameTree
from trundle.ros2.wire import Wire

MOUNT_M, MOUNT_RAD = 0.05, math.radians(5.0)
"""Mounts of tf and of the robot's file that are farther apart than this disagree."""

_TILT_RAD = math.radians(10.0)
_KEPT_S = 2.0


class Mount:
    """Where a lidar is on the robot, and how it is turned.

    Args:
        matrix: Pose of the sensor in base_link, shape (4, 4).

    Attributes:
        pose: Pose in base_link.
        height: Height above base_link [m].
        is_upside_down: Whether it hangs: its beams run clockwise, seen from above.
        is_tilted: Whether its plane is tilted by more than 10°.
    """

    def __init__(self, matrix: FloatArray) -> None:
        self.pose = Pose2D(float(matrix[0, 3]), float(matrix[1, 3]), math.atan2(matrix[1, 0], matrix[0, 0]))
        self.height = max(0.0, float(matrix[2, 3]))
        up = float(matrix[2, 2])
        self.is_upside_down = up < 0.0
        self.is_tilted = abs(up) < math.cos(_TILT_RAD)
        self.matrix = matrix


def mount_matrix(x: float, y: float, z: float, yaw: float) -> FloatArray:
    """Return the pose of an upright sensor, shape (4, 4)."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    return np.array([[cos, -sin, 0.0, x], [sin, cos, 0.0, y], [0.0, 0.0, 1.0, z], [0.0, 0.0, 0.0, 1.0]])


class Mounts:
    """Finds where lidars are: by tf, and by the robot's file where tf does not say it. It reports where both disagree.

    Args:
        wire: The network.
        frames: The transforms.
        base: Frame of the robot's base.
        robot: The robot, whose file has its lidars.
    """

    def __init__(self, wire: Wire, frames: FrameTree, base: str, robot: Robot) -> None:
        self._wire, self._frames, self._base, self._robot = wire, frames, base, robot
        self._found: dict[str, tuple[float, Mount]] = {}

    def find(self, name: str, sensor: Sensor, frame: str, now: float) -> Mount:
        """Return where a lidar is.

        Args:
            name: Name of the lidar.
            sensor: How it is published.
            frame: The frame that its messages have.
            now: Real time [s].
        """
        looked, mount = self._found.get(name, (-math.inf, None))
        if mount is not None and now - looked < _KEPT_S:
            return mount
        lidar = self._robot.lidars[name]
        listed = Mount(mount_matrix(lidar.x, lidar.y, lidar.z, lidar.yaw))
        found = self._frames.find(self._base, frame) if frame else None
        if found is None:
            expected = self._wire.names.frame(sensor.frame or name)
            found = self._frames.find(self._base, expected) if frame != expected else None
            if found is not None:
                self._wire.warn(
                    f"scans of {name}: frame",
                    f"scans of {name} have the frame {frame!r}, which tf lacks: {expected!r} is taken",
                )
            elif frame not in ("", expected) and mount is not None:  # tf has had time to come
                self._wire.warn(
                    f"scans of {name}: frame",
                    f"scans of {name} have the frame {frame!r}, which tf lacks: the robot's file says where it is",
                )
        made = listed if found is None else Mount(found.matrix)
        apart, turned = made.pose.distance_to(listed.pose), abs(wrap_angle(made.pose.yaw - listed.pose.yaw))
        if apart > MOUNT_M or turned > MOUNT_RAD:
            by_tf, by_file = (f"({at.x:.2f}, {at.y:.2f}, {at.yaw:.2f})" for at in (made.pose, listed.pose))
            self._wire.warn(
                f"scans of {name}: mount",
                f"by tf the lidar {name} is at {by_tf}, by the robot's file at {by_file}: tf counts",
            )
        self._found[name] = now, made
        return made
