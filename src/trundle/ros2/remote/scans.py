"""`ScanInputs`: scans of the robot's lidars, from LaserScan or from PointCloud2."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from trundle.messages import readers
from trundle.messages.qos import SENSOR
from trundle.observation import Scan
from trundle.robots import Robot
from trundle.ros2.bad_input import BadInputError
from trundle.ros2.inlet import Inlet
from trundle.ros2.profile import Sensor
from trundle.ros2.remote.clouds import LOWEST_M, Band, read_cloud
from trundle.ros2.remote.mounts import Mounts
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
