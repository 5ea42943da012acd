"""`LidarOutput`: the scans of a lidar and its points, in one level ring or in several."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D
from trundle.messages.qos import Qos
from trundle.mission import Step
from trundle.observation import Scan
from trundle.robots import Lidar
from trundle.ros2.outputs.output import Stencil, mark_stamp
from trundle.ros2.profile import Sensor
from trundle.ros2.role import BridgeContext
from trundle.sim import RobotState
from trundle.sim.lidar import beam_angles
from trundle.sim.mujoco.ring_beams import RingBeams
from trundle.worlds import World

_SAME_RAD = 1e-6
"""Directions that differ by less are the same."""

_FLOAT32, _UINT16 = 7, 4
_PARTS = (
    ("x", "<f4", 0, _FLOAT32),
    ("y", "<f4", 4, _FLOAT32),
    ("z", "<f4", 8, _FLOAT32),
    ("intensity", "<f4", 12, _FLOAT32),
    ("ring", "<u2", 16, _UINT16),
)
"""Name, numpy's type, offset, and number of the type in sensor_msgs/PointField."""

SCANS = Qos(5)
"""QoS of scans and points: reliable, so that readers who ask for that get them, too; others take them as they come."""

POINT = np.dtype(
    {
        "names": [name for name, _, _, _ in _PARTS],
        "formats": [kind for _, kind, _, _ in _PARTS],
        "offsets": [offset for _, _, offset, _ in _PARTS],
        "itemsize": 20,
    }
)
"""A point of a cloud, as lidar drivers publish it."""


class RingPoints:
    """Measures the points of a lidar whose rings rise and fall, in the simulated world, with its floor.

    Args:
        context: The bridge.
        lidar: Where it is mounted, its beams in each ring, and its range.
        rings: Elevation of each ring [deg].
    """

    def __init__(self, context: BridgeContext, lidar: Lidar, rings: Sequence[float]) -> None:
        self._sim, self._lidar = context.mission.sim, lidar
        rise, turn = np.meshgrid(np.radians(rings), beam_angles(lidar), indexing="ij")
        level = np.cos(rise)
        self._directions = np.stack([level * np.cos(turn), level * np.sin(turn), np.sin(rise)], axis=-1).reshape(-1, 3)
        self._world: World | None = None
        self._beams: RingBeams | None = None

    def measure(self, state: RobotState) -> FloatArray:
        """Measure points [m] in the lidar's frame, ring by ring, shape (rings × beams, 3); NaN without a return."""
        world, lidar = self._sim.world, self._lidar
        if self._beams is None or world is not self._world:
            self._world = world
            self._beams = RingBeams(World("empty", ()) if world is None else world)
        sensor = state.pose @ Pose2D(lidar.x, lidar.y, lidar.yaw)
        cos, sin = np.cos(sensor.yaw), np.sin(sensor.yaw)
        turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
        origin = sensor.x, sensor.y, lidar.z
        ranges = self._beams.cast(origin, self._directions @ turn, lidar.range_max, state.movers)
        ranges[~np.isfinite(ranges) | (ranges < lidar.range_min)] = np.nan
        return self._directions * ranges[:, None]


class LidarOutput:
    """Publishes the scans of a lidar as LaserScan, and as PointCloud2 in rows of one ring each.

    Where the sensor has rings, the points are measured along them instead. A beam without a return is infinite in a
    scan, and NaN in a cloud. The beams of a scan begin where the sensor says.

    Args:
        context: The bridge.
        name: Name of the lidar.
        lidar: The lidar.
        sensor: Its topics and its frame.
    """

    def __init__(self, context: BridgeContext, name: str, lidar: Lidar, sensor: Sensor) -> None:
        self.name, wire = name, context.wire
        self._rings = RingPoints(context, lidar, sensor.rings) if sensor.rings else None
        self._rows = len(sensor.rings) or 1
        self._make, self._types = context.maker, wire.types
        self._frame = wire.names.frame(sensor.frame or name)
        self._scan_time = 1.0 / lidar.rate
        if sensor.first_beam is not None and lidar.fov < 2.0 * math.pi - 1e-6:
            raise InputError(
                f"the profile's first_beam of the lidar {name!r} is for one that sees all around, and this one sees "
                f"{math.degrees(lidar.fov):.0f}°: leave it out"
            )
        self._first_beam = sensor.first_beam
        self._shift = 0
        scan, points = sensor.scan, sensor.points
        self._scans = None if scan is None else wire.outlet(scan, "sensor_msgs/msg/LaserScan", SCANS)
        self._points = None if points is None else wire.outlet(points, "sensor_msgs/msg/PointCloud2", SCANS)
        field = wire.types.codec.kind("sensor_msgs/msg/PointField")
        self._fields = [field(name=part, offset=offset, datatype=number, count=1) for part, _, offset, number in _PARTS]
        self._angles: FloatArray = np.zeros(0)
        self._directions = np.zeros((2, 0))
        self._scan_bytes: _Filled | None = None
        self._cloud_bytes: _Filled | None = None

    def publish(self, step: Step, time: float) -> None:
        """Publish the scans that arrived in a control period."""
        for scan in step.scans:
            if scan.lidar == self.name:
                self._publish(scan, time - step.state.time + scan.time, step.state, time)

    def _publish(self, scan: Scan, time: float, state: RobotState, now: float) -> None:
        scans, points = self._scans, self._points
        if scan.angles is not self._angles and not np.array_equal(scan.angles, self._angles):
            self._angles = scan.angles
            self._directions = np.stack([np.cos(scan.angles), np.sin(scan.angles)])
            self._scan_bytes = self._cloud_bytes = None
        if scans is not None and scans.is_wanted:
            filled = self._scan_bytes = self._scan_bytes or self._prepare_scan(scan)
            shift = self._shift
            filled.array[: len(scan.ranges) - shift] = scan.ranges[shift:]
            filled.array[len(scan.ranges) - shift :] = scan.ranges[:shift]
            scans.write_bytes(filled.stencil.fill(time))
        if points is not None and points.is_wanted:
            filled = self._cloud_bytes = self._cloud_bytes or self._prepare_cloud(scan)
            if self._rings is None:
                missed, cloud = ~np.isfinite(scan.ranges), filled.array
                cloud["x"], cloud["y"] = np.where(missed, np.nan, scan.ranges) * self._directions
                cloud["z"] = np.where(missed, np.nan, 0.0)
                points.write_bytes(filled.stencil.fill(time))
            else:
                found = self._rings.measure(state)
                filled.array["x"], filled.array["y"], filled.array["z"] = found.T
                points.write_bytes(filled.stencil.fill(now))

    def _prepare_scan(self, scan: Scan) -> _Filled:
        if self._first_beam is not None:
            ahead = np.mod(scan.angles - self._first_beam + _SAME_RAD, 2.0 * math.pi)
            self._shift = int(np.argmin(ahead))
            angles = self._first_beam - _SAME_RAD + np.roll(ahead, -self._shift)
            scan = replace(scan, angles=angles)
        message = self._make.scan(scan, self._frame)
        mark_stamp(message.header.stamp)
        message.scan_time = self._scan_time
        message.ranges = _marks(len(scan.ranges), np.float32)
        return _Filled.of(self._types.encode(message), message.ranges, "<f4", len(scan.ranges))

    def _prepare_cloud(self, scan: Scan) -> _Filled:
        width = len(scan.ranges)
        count = self._rows * width
        data = _marks(POINT.itemsize * count, np.uint8)
        message = self._types.make(
            "sensor_msgs/msg/PointCloud2",
            header=self._make.header(0.0, self._frame),
            height=self._rows,
            width=width,
            fields=self._fields,
            point_step=POINT.itemsize,
            row_step=POINT.itemsize * width,
            data=data,
        )
        mark_stamp(message.header.stamp)
        filled = _Filled.of(self._types.encode(message), data, POINT, count)
        filled.array[:] = np.zeros(count, POINT)
        filled.array["ring"] = np.repeat(np.arange(self._rows), width)
        return filled


@dataclass(frozen=True, slots=True, eq=False)
class _Filled:
    """A stencil, and the array in it."""

    stencil: Stencil
    array: npt.NDArray[Any]

    @classmethod
    def of(cls, data: bytes, marks: npt.NDArray[Any], kind: npt.DTypeLike, count: int) -> _Filled:
        stencil = Stencil(data)
        return cls(stencil, stencil.array(marks.tobytes(), kind, count))


def _marks(count: int, kind: npt.DTypeLike) -> npt.NDArray[Any]:
    """Make elements that nothing else in a message has."""
    numbers = np.arange(count)
    return (numbers * 37 % 251 + 1 if kind == np.uint8 else -9.7531e7 * (1.0 + numbers / 1024.0)).astype(kind)
