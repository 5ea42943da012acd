"""`ScanInputs`: scans of the robot's lidars, from LaserScan or from PointCloud2."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from trundle.geometry import FloatArray, Pose2D
from trundle.messages import readers
from trundle.messages.qos import SENSOR
from trundle.observation import Scan
from trundle.robots import Lidar, Robot
from trundle.ros2.bad_input import BadInputError
from trundle.ros2.inlet import Inlet
from trundle.ros2.profile import Sensor
from trundle.ros2.remote.mounts import Mount, Mounts
from trundle.ros2.remote.readings import read_scan
from trundle.ros2.wire import Wire

_SCAN, _CLOUD = "sensor_msgs/msg/LaserScan", "sensor_msgs/msg/PointCloud2"

CLOUDS_AFTER_S = 3.0
"""A lidar whose scans nobody publishes by then [s] is read from its cloud."""


@dataclass(slots=True, eq=False)
class _Waiting:
    """A lidar that may be read from its cloud instead of its scans."""

    sensor: Sensor
    scans: Inlet
    since: float


class ScanInputs:
    """Reads each lidar from its scans, or from its cloud where nobody publishes scans of it.

    Args:
        wire: The network.
        robot: The robot, with its lidars.
        mounts: Where they are.
        time_of: Gives the time of a stamp [s], and None where the message is to be dropped.
        take: Gets each scan.
        real: Real time [s].
    """

    def __init__(
        self,
        wire: Wire,
        robot: Robot,
        mounts: Mounts,
        time_of: Callable[[float, str], float | None],
        take: Callable[[Scan], None],
        real: Callable[[], float],
    ) -> None:
        self._wire, self._robot, self._mounts = wire, robot, mounts
        self._time_of, self._take, self._real = time_of, take, real
        self._band = Band(LOWEST_M, max(robot.z_range[1], 2.0 * LOWEST_M))
        self._last: dict[str, float] = {}
        self._waiting: dict[str, _Waiting] = {}

    def clear(self) -> None:
        """Forget the times of scans: the clock has jumped."""
        self._last.clear()

    def listen(self, name: str, sensor: Sensor) -> None:
        """Listen to a lidar."""
        if sensor.scan is None:
            self._listen_to_cloud(name, sensor)
            return
        inlet = self._wire.listen(
            sensor.scan, _SCAN, SENSOR, lambda message, source: self._read(name, sensor, message, source)
        )
        if sensor.points is not None:
            self._waiting[name] = _Waiting(sensor, inlet, self._real())

    def look(self) -> None:
        """Read a cloud where nobody publishes scans; in the listening thread."""
        now = self._real()
        for name, waiting in tuple(self._waiting.items()):
            if waiting.scans.received:
                del self._waiting[name]
            elif now - waiting.since > CLOUDS_AFTER_S and not waiting.scans.writers:
                del self._waiting[name]
                self._listen_to_cloud(name, waiting.sensor)

    def _listen_to_cloud(self, name: str, sensor: Sensor) -> None:
        if sensor.points is not None:
            self._wire.listen(
                sensor.points, _CLOUD, SENSOR, lambda message, source: self._read(name, sensor, message, source)
            )

    def _read(self, name: str, sensor: Sensor, message: Any, source: str) -> None:
        what = f"scans of {name}"
        time = self._time_of(readers.read_stamp(message.header.stamp), what)
        if time is None:
            return
        if time <= self._last.get(name, -math.inf):
            self._wire.warn(
                f"{what}: repeated stamp", f"a scan of {name} is not newer than the one before: it is dropped"
            )
            return
        mount = self._mounts.find(name, sensor, readers.read_frame(message.header.frame_id), self._real())
        try:
            if message.__msgtype__ == _CLOUD:
                scan = read_cloud(message, self._robot.lidars[name], name, time, mount, self._band)
            else:
                scan, remarks = read_scan(message, name, time, mount)
                for kind, text in remarks:
                    self._wire.warn(f"{what}: {kind}", f"{what}: {text}")
        except BadInputError as error:
            kind, text = error.kind, str(error)
            self._wire.warn(
                f"{what}: {kind}",
                lambda: f"{what}: a message of {self._wire.describe_source(source)} is dropped: {text}",
            )
            return
        self._last[name] = time
        self._take(scan)


MOST_POINTS = 1_000_000
LOWEST_M = 0.1
"""Points below this height [m] are the floor: a cloud of a tilted sensor is off by some centimetres."""

_FORMATS = {7: "f4", 8: "f8"}
_BEAM_RAD = math.radians(0.5)
_BESIDE = 4
"""Directions without a point that are this near one [beams] were not measured: beams are up to two degrees apart."""


@dataclass(frozen=True, slots=True)
class Band:
    """Heights above base_link whose points count.

    Attributes:
        low, high: The lowest and the highest one [m].
    """

    low: float
    high: float


def read_cloud(message: Any, lidar: Lidar, name: str, time: float, mount: Mount, band: Band) -> Scan:
    """Read a sensor_msgs/PointCloud2 as a scan of beams of half a degree: the nearest point of each direction.

    A direction without a point is free as far as the lidar measures. It was not measured beside one with a point, where
    the lidar's own beams may be wider apart, and outside of its field of view.

    Args:
        message: The message.
        lidar: Field of view and range.
        name: Name of the lidar.
        time: Time of the cloud [s].
        mount: Where the lidar is.
        band: Heights that count.

    Raises:
        BadInputError: If it is no cloud with x, y and z.
    """
    points = _points(message)
    points = points[np.isfinite(points).all(axis=1)]
    at = points @ mount.matrix[:3, :3].T + mount.matrix[:3, 3]
    at = at[(at[:, 2] >= band.low) & (at[:, 2] <= band.high)]
    dx, dy = at[:, 0] - mount.pose.x, at[:, 1] - mount.pose.y
    ranges = np.hypot(dx, dy)
    kept = (ranges >= lidar.range_min) & (ranges <= lidar.range_max)
    count = round(2.0 * math.pi / _BEAM_RAD)
    beams = np.floor((np.arctan2(dy[kept], dx[kept]) + math.pi) / _BEAM_RAD).astype(np.intp) % count
    nearest = np.full(count, math.inf)
    np.minimum.at(nearest, beams, ranges[kept])
    angles: FloatArray = -math.pi + _BEAM_RAD * (np.arange(count, dtype=np.float64) + 0.5)
    off = np.abs((angles - mount.pose.yaw + math.pi) % (2.0 * math.pi) - math.pi)
    is_hit = np.isfinite(nearest)
    beside = np.zeros(count, dtype=bool)
    for shift in range(-_BESIDE, _BESIDE + 1):
        beside |= np.roll(is_hit, shift)
    nearest[~is_hit & (beside | (off > 0.5 * lidar.fov))] = np.nan
    place = Pose2D(mount.pose.x, mount.pose.y)
    return Scan(name, time, place, mount.height, angles, nearest, lidar.range_min, lidar.range_max)


def _points(message: Any) -> FloatArray:
    """Return the points in the sensor's frame [m], shape (N, 3)."""
    width, height = int(message.width), int(message.height)
    step, row = int(message.point_step), int(message.row_step)
    fields = {one.name: one for one in message.fields}
    data = np.asarray(message.data, dtype=np.uint8)
    if not 0 <= width * height <= MOST_POINTS:
        raise BadInputError("too many points", f"it has {width * height} points, and not at most {MOST_POINTS}")
    row = row if row >= width * step else width * step
    if step < 1 or len(data) < height * row:
        raise BadInputError("too short", f"its {len(data)} bytes are not {height} rows of {row}")
    formats: list[str] = []
    for name in ("x", "y", "z"):
        field = fields.get(name)
        kind = None if field is None else _FORMATS.get(int(field.datatype))
        if field is None or kind is None or int(field.offset) + int(kind[1]) > step:
            raise BadInputError("no x, y, z", f"it has no field {name} of type float32 or float64")
        formats.append((">" if message.is_bigendian else "<") + kind)
    offsets = [int(fields[name].offset) for name in ("x", "y", "z")]
    kind = np.dtype({"names": ["x", "y", "z"], "formats": formats, "offsets": offsets, "itemsize": step})
    packed = np.ascontiguousarray(data[: height * row].reshape(height, row)[:, : width * step]) if height else data[:0]
    cloud = packed.view(kind).ravel() if packed.size else np.zeros(0, kind)
    return np.column_stack([cloud["x"], cloud["y"], cloud["z"]]).astype(np.float64)
