"""`FrameTree`: where frames are now, from /tf and /tf_static; `Mounts`: where lidars are on the robot."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.robots import Robot
from trundle.ros2.profile import Sensor
from trundle.ros2.wire import Wire

MOST_FRAMES = 2000
"""More frames than this are a fault, and are not kept: the largest robots have some hundreds."""

OVERTAKES_S = 0.5
"""A transform whose stamp is older than that of the one before by more than this is of a time that was reset [s]: what
waited while the time was reset may come after that, with stamps of before."""

_HERE = np.eye(4)


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """Where a frame is in another one.

    Attributes:
        matrix: Pose of the frame in the other one, shape (4, 4).
        time: Stamp of the newest of its moving transforms [s]; None where all are static.
    """

    matrix: FloatArray
    time: float | None

    @property
    def pose(self) -> Pose2D:
        """The pose on the floor."""
        m = self.matrix
        return Pose2D(float(m[0, 3]), float(m[1, 3]), float(np.arctan2(m[1, 0], m[0, 0])))


@dataclass(frozen=True, slots=True, eq=False)
class _Edge:
    parent: str
    matrix: FloatArray
    time: float | None


class FrameTree:
    """The newest transform of each frame. Only one thread uses it.

    Attributes:
        moved: Frames whose parent has changed, each with both parents: two publishers have different trees.
    """

    def __init__(self) -> None:
        self._edges: dict[str, _Edge] = {}
        self.moved: dict[str, tuple[str, str]] = {}

    def __contains__(self, frame: str) -> bool:
        return frame in self._edges or any(edge.parent == frame for edge in self._edges.values())

    def __len__(self) -> int:
        return len(self._edges)

    def clear_moving(self) -> None:
        """Forget what is not static: the time went back."""
        self._edges = {child: edge for child, edge in self._edges.items() if edge.time is None}

    def add(self, parent: str, child: str, matrix: FloatArray, time: float | None) -> str:
        """Add the pose of `child` in `parent` at a time [s]; None for a static one.

        Returns:
            Why it is not taken; empty where it is.
        """
        if not parent or not child or parent == child:
            return f"a transform from {parent!r} to {child!r} connects nothing"
        if not np.isfinite(matrix).all():
            return f"the transform of {child!r} has numbers that are not finite"
        if self._is_below(parent, child):
            return f"the transform {parent} → {child} closes a loop"
        known = self._edges.get(child)
        if known is None and len(self._edges) >= MOST_FRAMES:
            return f"there are more than {MOST_FRAMES} frames"
        if known is not None and known.parent != parent:
            self.moved[child] = known.parent, parent
        before = known.time if known is not None and known.parent == parent else None
        if before is not None and time is not None and 0.0 < before - time <= OVERTAKES_S:
            return ""  # messages may overtake each other
        self._edges[child] = _Edge(parent, matrix, time)
        return ""

    def parent(self, frame: str) -> str | None:
        """Return the parent of a frame; None where it has none."""
        edge = self._edges.get(frame)
        return None if edge is None else edge.parent

    def below(self, ancestor: str) -> dict[str, Placed]:
        """Return where all frames below another one are in it."""
        found = {child: self.find(ancestor, child) for child in self._edges if self._is_below(child, ancestor)}
        return {child: placed for child, placed in found.items() if placed is not None}

    def find(self, ancestor: str, frame: str) -> Placed | None:
        """Return where a frame is in another one, which may be above it, below it or beside it; None in two trees."""
        up = self._path(frame)
        for name, matrix, time in up:
            if name == ancestor:
                return Placed(matrix, time)
        down = self._path(ancestor)
        above = {name: number for number, (name, _, _) in enumerate(down)}
        for name, matrix, time in up:
            number = above.get(name)
            if number is not None:
                _, other, other_time = down[number]
                times = [one for one in (time, other_time) if one is not None]
                return Placed(np.linalg.inv(other) @ matrix, max(times) if times else None)
        return None

    def _path(self, frame: str) -> list[tuple[str, FloatArray, float | None]]:
        """Return each frame from this one up, with this one's pose in it and the newest stamp between them."""
        found: list[tuple[str, FloatArray, float | None]] = [(frame, _HERE, None)]
        edge = self._edges.get(frame)
        while edge is not None:
            _, matrix, time = found[-1]
            newest = edge.time if time is None or (edge.time is not None and edge.time > time) else time
            found.append((edge.parent, edge.matrix if matrix is _HERE else edge.matrix @ matrix, newest))
            edge = self._edges.get(edge.parent)
        return found

    def _is_below(self, frame: str, ancestor: str) -> bool:
        seen = 0
        edge = self._edges.get(frame)
        while edge is not None and seen <= MOST_FRAMES:
            if edge.parent == ancestor:
                return True
            edge, seen = self._edges.get(edge.parent), seen + 1
        return seen > MOST_FRAMES


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
