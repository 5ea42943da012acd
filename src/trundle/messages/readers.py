"""Trundle's values from ROS messages, of any distribution."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.maps.cells import OCCUPIED, UNKNOWN
from trundle.observation import LOCALIZATION_STATES, Hypothesis, LocalizationState

_STATES: dict[str, LocalizationState] = {state: state for state in LOCALIZATION_STATES}

DIAGNOSIS = "trundle: localization"
"""Name of the diagnostic_msgs/DiagnosticStatus that says what a localizer believes."""


def read_stamp(stamp: Any) -> float:
    """Read a builtin_interfaces/Time in seconds."""
    return stamp.sec + stamp.nanosec * 1e-9


def read_frame(frame_id: str) -> str:
    """Read the name of a frame, without the leading slash that ROS 1 had."""
    return frame_id.lstrip("/")


def read_yaw(quaternion: Any) -> float:
    """Read the yaw [rad] of a geometry_msgs/Quaternion."""
    x, y, z, w = quaternion.x, quaternion.y, quaternion.z, quaternion.w
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def read_pose(pose: Any) -> Pose2D:
    """Read the pose on the floor of a geometry_msgs/Pose."""
    return Pose2D(pose.position.x, pose.position.y, read_yaw(pose.orientation))


def read_twist(twist: Any) -> Twist2D:
    """Read forward speed and rotation of a geometry_msgs/Twist."""
    return Twist2D(twist.linear.x, twist.angular.z)


def read_covariance(message: Any) -> FloatArray | None:
    """Read the covariance of (x, y, yaw) of a geometry_msgs/PoseWithCovariance, shape (3, 3).

    Zeros mean that it is not known, or that the pose is exact: they are None.
    """
    whole = np.asarray(message.covariance, dtype=np.float64).reshape(6, 6)
    return whole[np.ix_((0, 1, 5), (0, 1, 5))] if whole.any() else None


def read_particles(message: Any) -> FloatArray:
    """Read the particles (x, y, yaw, weight) of a nav2_msgs/ParticleCloud, shape (N, 4)."""
    rows = [(*read_pose(one.pose).as_tuple(), one.weight) for one in message.particles]
    return np.array(rows, dtype=np.float64).reshape(-1, 4)


def read_diagnosis(message: Any) -> tuple[LocalizationState, tuple[Hypothesis, ...]] | None:
    """Read what `MessageMaker.diagnosis` made of an estimate, its state and its hypotheses; None of other messages."""
    for status in message.status:
        if status.name != DIAGNOSIS:
            continue
        values = {value.key: value.value for value in status.values}
        said = values.pop("state", "")
        state = _STATES.get(said)
        if state is None:
            return None
        try:
            places = [[float(number) for number in text.split()] for text in values.values()]
            return state, tuple(Hypothesis(Pose2D(x, y, yaw), weight) for x, y, yaw, weight in places)
        except (ValueError, TypeError):
            return None
    return None


def read_matrix(transform: Any) -> FloatArray:
    """Read a geometry_msgs/Transform as a matrix, shape (4, 4)."""
    turn = transform.rotation
    x, y, z, w = turn.x, turn.y, turn.z, turn.w
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    if not (math.isfinite(norm) and norm > 0.0):
        raise InputError("a transform whose rotation is no quaternion")
    x, y, z, w = x / norm, y / norm, z / norm, w / norm
    shift = transform.translation
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), shift.x],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), shift.y],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), shift.z],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )


def read_grid(message: Any) -> OccupancyGrid:
    """Read the map of a nav_msgs/OccupancyGrid.

    Raises:
        MapError: If it is not a map.
        InputError: If it does not have as many cells as its size says.
    """
    info = message.info
    cells = np.asarray(message.data, dtype=np.int8)
    if cells.size != info.width * info.height:
        raise InputError(f"a map of {info.width} x {info.height} cells that has {cells.size}")
    cells = np.clip(cells.reshape(info.height, info.width), UNKNOWN, OCCUPIED)
    return OccupancyGrid(cells, float(info.resolution), read_pose(info.origin))


def read_path(message: Any) -> FloatArray:
    """Read the poses (x, y, yaw) of a nav_msgs/Path, shape (N, 3)."""
    poses = [read_pose(stamped.pose).as_tuple() for stamped in message.poses]
    return np.array(poses, dtype=np.float64).reshape(-1, 3)
