"""`ScanInputs`: scans of the robot's lidars, from LaserScan or PointCloud2, with the mistakes that drivers make."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D, Twist2D, integrate_twist, wrap_angle
from trundle.messages import readers
from trundle.messages.qos import SENSOR
from trundle.observation import Scan
from trundle.robots import Lidar, Robot
from trundle.ros2.bad_input import BadInputError, check_pose, check_twist
from trundle.ros2.inlet import Inlet
from trundle.ros2.profile import Sensor
from trundle.ros2.remote.frames import Mount, Mounts
from trundle.ros2.wire import Wire

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
