"""A drive through a room with a box in it, and bags of it as a stranger would write them with the rosbags library."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

WALLS = np.array(
    [
        # the room, 12 x 8 m, with a niche
        ((-6, -4), (6, -4)),
        ((6, -4), (6, 4)),
        ((6, 4), (1, 4)),
        ((1, 4), (1, 5.5)),
        ((1, 5.5), (-1, 5.5)),
        ((-1, 5.5), (-1, 4)),
        ((-1, 4), (-6, 4)),
        ((-6, 4), (-6, -4)),
        # a box, and a wall that stands out
        ((-1.5, -0.7), (1.0, -0.7)),
        ((1.0, -0.7), (1.0, 0.9)),
        ((1.0, 0.9), (-1.5, 0.9)),
        ((-1.5, 0.9), (-1.5, -0.7)),
        ((3.5, -4), (3.5, -3.2)),
    ],
    dtype=float,
)


def cast(x: float, y: float, angles: np.ndarray) -> np.ndarray:
    """Return the distance to the nearest wall along each direction; infinity where there is none."""
    first, step = WALLS[:, 0], WALLS[:, 1] - WALLS[:, 0]
    direction = np.column_stack([np.cos(angles), np.sin(angles)])
    cross = direction[:, None, 0] * step[None, :, 1] - direction[:, None, 1] * step[None, :, 0]
    to = first[None] - (x, y)
    with np.errstate(divide="ignore", invalid="ignore"):
        along = (to[..., 0] * step[None, :, 1] - to[..., 1] * step[None, :, 0]) / cross
        share = (to[..., 0] * direction[:, None, 1] - to[..., 1] * direction[:, None, 0]) / cross
    good = (along > 0.0) & (share >= 0.0) & (share <= 1.0)
    return np.where(good, along, np.inf).min(axis=1)


@dataclass
class Drive:
    """Times, true poses and scans of a drive around the box.

    Attributes:
        seconds: How long it is.
        beams, fov: Of the lidar.
        mount: Of the lidar: (x, y, yaw).
        rate: Scans per second.
        begin: Time of the first sample.
        slip: Odometry turns too little by this share.
    """

    seconds: float = 60.0
    beams: int = 180
    fov: float = math.radians(270.0)
    mount: tuple[float, float, float] = (0.2, 0.0, 0.0)
    rate: float = 5.0
    begin: float = 1000.0
    slip: float = 0.01
    times: np.ndarray = field(init=False)
    poses: np.ndarray = field(init=False)
    odometry: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        self.times = np.arange(0.0, self.seconds, 1.0 / 20.0)
        around = 2.0 * math.pi * self.times / 50.0 - math.pi / 2.0
        x, y = 3.4 * np.cos(around), 2.3 * np.sin(around)
        yaw = np.unwrap(np.arctan2(2.3 * np.cos(around), -3.4 * np.sin(around)))
        self.poses = np.column_stack([x, y, yaw])
        step = np.diff(self.poses, axis=0)
        turn = np.concatenate([[0.0], np.cumsum(step[:, 2] * (1.0 - self.slip))])
        length = np.hypot(step[:, 0], step[:, 1])
        middle = (turn[:-1] + turn[1:]) / 2.0
        self.odometry = np.column_stack(
            [
                np.concatenate([[0.0], np.cumsum(length * np.cos(middle))]),
                np.concatenate([[0.0], np.cumsum(length * np.sin(middle))]),
                turn,
            ]
        )

    @property
    def angles(self) -> np.ndarray:
        """Directions of the beams."""
        return np.linspace(-self.fov / 2.0, self.fov / 2.0, self.beams)

    def scan(self, index: int) -> np.ndarray:
        """Ranges of the lidar at a sample."""
        x, y, yaw = self.poses[index]
        mx, my, turn = self.mount
        sx, sy = x + math.cos(yaw) * mx - math.sin(yaw) * my, y + math.sin(yaw) * mx + math.cos(yaw) * my
        rng = np.random.default_rng(index)
        return cast(sx, sy, self.angles + yaw + turn) + rng.normal(0.0, 0.01, self.beams)


Change = Callable[[str, Any, int], Any]
"""Changes a message: topic, message, number of the sample; None leaves it out."""


def write_bag(
    path: Path,
    drive: Drive,
    *,
    storage: str = "mcap",
    topics: Sequence[str] = ("/scan", "/odom", "/tf_static"),
    change: Change | None = None,
    roll: float = 0.0,
    rename: dict[str, str] | None = None,
    received: Callable[[float], float] = lambda time: time,
) -> Path:
    """Write a bag as another program would: /scan, /odom, /tf (odom to base_link) and /tf_static."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    kinds = {
        "/scan": "sensor_msgs/msg/LaserScan",
        "/odom": "nav_msgs/msg/Odometry",
        "/tf": "tf2_msgs/msg/TFMessage",
        "/tf_static": "tf2_msgs/msg/TFMessage",
    }
    names = {name: (rename or {}).get(name, name) for name in kinds}
    with Writer(path, version=9, storage_plugin=StoragePlugin[storage.upper()]) as writer:
        open_ = {
            name: writer.add_connection(names[name], kinds[name], typestore=store) for name in kinds if name in topics
        }
        every = round(20.0 / drive.rate)
        for index, time in enumerate(drive.times.tolist()):
            stamp = drive.begin + time
            made: dict[str, Any] = {}
            if index == 0:
                mx, my, yaw = drive.mount
                made["/tf_static"] = _transforms(types, stamp, "base_link", "laser", (mx, my, 0.3), yaw, roll)
            made["/odom"] = _odometry(types, stamp, drive.odometry[index])
            x, y, yaw = drive.odometry[index]
            made["/tf"] = _transforms(types, stamp, "odom", "base_link", (x, y, 0.0), yaw)
            if index % every == 0:
                made["/scan"] = _scan(types, stamp, drive, index)
            for name, message in made.items():
                if name not in open_:
                    continue
                kept = message if change is None else change(name, message, index)
                if kept is not None:
                    data = store.serialize_cdr(kept, kinds[name])
                    writer.write(open_[name], round(received(stamp) * 1e9), data)
    return path


def _stamp(types: Any, time: float) -> Any:
    seconds = math.floor(time)
    return types["builtin_interfaces/msg/Time"](sec=seconds, nanosec=round((time - seconds) * 1e9) % 1_000_000_000)


def _header(types: Any, time: float, frame: str) -> Any:
    return types["std_msgs/msg/Header"](stamp=_stamp(types, time), frame_id=frame)


def _turn(types: Any, yaw: float, roll: float = 0.0) -> Any:
    cy, sy, cr, sr = math.cos(yaw / 2), math.sin(yaw / 2), math.cos(roll / 2), math.sin(roll / 2)
    return types["geometry_msgs/msg/Quaternion"](x=cy * sr, y=sy * sr, z=sy * cr, w=cy * cr)


def _transforms(
    types: Any,
    time: float,
    parent: str,
    child: str,
    place: tuple[float, float, float],
    yaw: float,
    roll: float = 0.0,
) -> Any:
    one = types["geometry_msgs/msg/TransformStamped"](
        header=_header(types, time, parent),
        child_frame_id=child,
        transform=types["geometry_msgs/msg/Transform"](
            translation=types["geometry_msgs/msg/Vector3"](*map(float, place)), rotation=_turn(types, yaw, roll)
        ),
    )
    return types["tf2_msgs/msg/TFMessage"](transforms=[one])


def _odometry(types: Any, time: float, pose: np.ndarray) -> Any:
    zero = types["geometry_msgs/msg/Vector3"](0.0, 0.0, 0.0)
    return types["nav_msgs/msg/Odometry"](
        header=_header(types, time, "odom"),
        child_frame_id="base_link",
        pose=types["geometry_msgs/msg/PoseWithCovariance"](
            pose=types["geometry_msgs/msg/Pose"](
                position=types["geometry_msgs/msg/Point"](float(pose[0]), float(pose[1]), 0.0),
                orientation=_turn(types, float(pose[2])),
            ),
            covariance=np.zeros(36),
        ),
        twist=types["geometry_msgs/msg/TwistWithCovariance"](
            twist=types["geometry_msgs/msg/Twist"](linear=zero, angular=zero), covariance=np.zeros(36)
        ),
    )


def _scan(types: Any, time: float, drive: Drive, index: int) -> Any:
    angles = drive.angles
    return types["sensor_msgs/msg/LaserScan"](
        header=_header(types, time, "laser"),
        angle_min=float(angles[0]),
        angle_max=float(angles[-1]),
        angle_increment=float(angles[1] - angles[0]),
        time_increment=0.0,
        scan_time=1.0 / drive.rate,
        range_min=0.1,
        range_max=20.0,
        ranges=drive.scan(index).astype(np.float32),
        intensities=np.zeros(0, dtype=np.float32),
    )


def write_carmen(path: Path, drive: Drive, *, times: Callable[[int, float], float] | None = None) -> Path:
    """Write a CARMEN log: FLASER lines with the odometry, ODOM lines, PARAM lines."""
    lines = [
        "# CARMEN Logfile",
        "PARAM robot_frontlaser_offset 0.2 nohost 0",
        "PARAM robot_front_laser_max 50.0 nohost 0",
    ]
    every = round(20.0 / drive.rate)
    for index, time in enumerate(drive.times.tolist()):
        pose = " ".join(f"{value:.6f}" for value in drive.odometry[index])
        stamp = time if times is None else times(index, time)
        lines.append(f"ODOM {pose} 0 0 0 {stamp:.6f} nohost {stamp:.6f}")
        if index % every == 0:
            ranges = " ".join(f"{value:.3f}" for value in drive.scan(index))
            lines.append(f"FLASER {drive.beams} {ranges} {pose} {pose} {stamp:.6f} nohost {stamp:.6f}")
    path.write_text("\n".join(lines) + "\n")
    return path
