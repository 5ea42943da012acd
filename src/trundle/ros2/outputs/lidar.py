"""`LidarOutput`: the scans of a lidar, and its points."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray
from trundle.messages import MessageMaker
from trundle.messages.qos import SENSOR
from trundle.mission import Step
from trundle.observation import Scan
from trundle.robots import Lidar
from trundle.ros2.profile import Sensor
from trundle.ros2.wire import Outlet, Wire

_FLOAT32, _UINT16 = 7, 4
_PARTS = (
    ("x", "<f4", 0, _FLOAT32),
    ("y", "<f4", 4, _FLOAT32),
    ("z", "<f4", 8, _FLOAT32),
    ("intensity", "<f4", 12, _FLOAT32),
    ("ring", "<u2", 16, _UINT16),
)
"""Name, numpy's type, offset, and number of the type in sensor_msgs/PointField."""

POINT = np.dtype(
    {
        "names": [name for name, _, _, _ in _PARTS],
        "formats": [kind for _, kind, _, _ in _PARTS],
        "offsets": [offset for _, _, offset, _ in _PARTS],
        "itemsize": 20,
    }
)
"""A point of a cloud, as lidar drivers publish it."""


class LidarOutput:
    """Publishes the scans of a lidar as LaserScan, and as PointCloud2 in rows of one ring each.

    A beam without a return is infinite in a scan, and NaN in a cloud.

    Args:
        wire: The network.
        name: Of the lidar.
        lidar: The lidar.
        sensor: Its topics and its frame.
    """

    def __init__(self, wire: Wire, name: str, lidar: Lidar, sensor: Sensor) -> None:
        self.name = name
        self._make, self._types = MessageMaker(wire.types.codec), wire.types
        self._frame = wire.names.frame(sensor.frame or name)
        self._scan_time = 1.0 / lidar.rate
        self._scans = self._open(wire, sensor.scan, "sensor_msgs/msg/LaserScan")
        self._points = self._open(wire, sensor.points, "sensor_msgs/msg/PointCloud2")
        field = wire.types.codec.kind("sensor_msgs/msg/PointField")
        self._fields = [field(name=part, offset=offset, datatype=number, count=1) for part, _, offset, number in _PARTS]
        self._cloud = wire.types.codec.kind("sensor_msgs/msg/PointCloud2")
        self._angles: FloatArray | None = None
        self._directions = np.zeros((2, 0))

    @staticmethod
    def _open(wire: Wire, topic: str | None, type_name: str) -> Outlet | None:
        return None if topic is None else wire.outlet(topic, type_name, SENSOR)

    def publish(self, step: Step, time: float) -> None:
        """Publish the scans that arrived in a control period."""
        for scan in step.scans:
            if scan.lidar == self.name:
                self._publish(scan, time - step.state.time + scan.time)

    def _publish(self, scan: Scan, time: float) -> None:
        scans, points = self._scans, self._points
        if scans is not None and scans.is_wanted:
            message = self._make.scan(scan, self._frame)
            message.header.stamp = self._make.stamp(time)
            message.scan_time = self._scan_time
            scans.write(message)
        if points is not None and points.is_wanted:
            points.write(self._make_cloud(scan, time))

    def _make_cloud(self, scan: Scan, time: float) -> object:
        count = len(scan.ranges)
        return self._cloud(
            header=self._make.header(time, self._frame),
            height=1,
            width=count,
            fields=self._fields,
            is_bigendian=False,
            point_step=POINT.itemsize,
            row_step=POINT.itemsize * count,
            data=self._find_points(scan),
            is_dense=False,
        )

    def _find_points(self, scan: Scan) -> npt.NDArray[np.uint8]:
        """The bytes of the points [m], in the frame of the lidar; those without a return are NaN."""
        if scan.angles is not self._angles:
            self._angles = scan.angles
            self._directions = np.stack([np.cos(scan.angles), np.sin(scan.angles)])
        ranges = np.where(np.isfinite(scan.ranges), scan.ranges, np.nan)
        points = np.zeros(len(ranges), POINT)
        points["x"], points["y"] = ranges * self._directions
        points["z"] = np.where(np.isnan(ranges), np.nan, 0.0)
        return points.view(np.uint8)
