"""Bags as other robots have them, written with rosbags."""

from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.messages import Codec, MessageMaker

BEGAN = 1_750_000_000.0
"""Stamps of real robots are times of the day."""

LAGS_S = {"/tf": 0.03, "/scan": 0.12}
"""How long after its stamp a message is received."""


def room() -> OccupancyGrid:
    cells = np.zeros((120, 200), dtype=np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    return OccupancyGrid(cells, 0.05, Pose2D(-1.0, -3.0))


def write_bag(
    folder: Path,
    *,
    prefix: str = "/robot1",
    base: str = "base_footprint",
    leave_out: tuple[str, ...] = (),
    localized: bool = True,
    resolution: float = 0.05,
    storage: StoragePlugin = StoragePlugin.MCAP,
) -> Path:
    """A robot that drives 4 m along x in 10 s, with AMCL's correction of 1 m, in topics with a prefix."""
    codec = Codec("humble")
    make = MessageMaker(codec)
    store = get_typestore(Stores.ROS2_HUMBLE)
    with Writer(folder, version=9, storage_plugin=storage) as bag:
        channels: dict[str, Any] = {}

        def write(topic: str, time: float, message: Any) -> None:
            if topic in leave_out:
                return
            name = topic if topic.startswith("/tf") else f"{prefix}{topic}"
            if name not in channels:
                channels[name] = bag.add_connection(name, message.__msgtype__, typestore=store)
            received = time + LAGS_S.get(topic, 0.0)
            bag.write(channels[name], round(received * 1e9), codec.encode(message))

        message = make.grid(BEGAN, room())
        message.info.resolution = resolution
        write("/map", BEGAN, message)
        write("/local_costmap/costmap", BEGAN, make.grid(BEGAN, room(), "odom"))
        mount = make.transform(BEGAN, base, "laser", Pose2D(0.1, 0.0, 0.0), 0.2)
        mount.transform.rotation.x, mount.transform.rotation.w = 1.0, 0.0  # upside down
        write("/tf_static", BEGAN, make.transforms([mount]))
        plan = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [4.0, 0.0, 0.0]])
        for index in range(501):
            time, x = BEGAN + 0.02 * index, 4.0 * index / 500
            odom = Pose2D(x - 1.0, 0.0)
            transforms = [make.transform(time, "odom", base, odom)]
            if localized and index % 10 == 0:
                transforms.append(make.transform(time, "map", "odom", Pose2D(1.0, 0.0)))
            write("/tf", time, make.transforms(transforms))
            write("/odom", time, make.odometry(time, "odom", base, odom, Twist2D(0.4, 0.0)))
            write("/cmd_vel", time, make.command(time, Twist2D(0.4, 0.0)))
            if index in (50, 300):
                write("/plan", time, make.path(time, plan))
            if index % 50 == 0:
                write("/scan", time, _scan(make, time))
    return folder


def _scan(make: MessageMaker, time: float) -> Any:
    from trundle.observation import Scan

    angles = np.linspace(-1.0, 1.0, 21)
    ranges = np.where(angles > 0.0, 2.0, 1.0)
    return make.scan(Scan("laser", time, Pose2D(0.0, 0.0), 0.2, angles, ranges, 0.1, 10.0), "laser")
