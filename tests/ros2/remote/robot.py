"""A robot on a network in memory, which behaves as badly as it is told."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ros2.fake_transport import FakeNetwork
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.messages import Codec, MessageMaker, Qos
from trundle.observation import Scan
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World

PERIOD_S = 0.02
MOST_WAITING, TAKEN_WITHIN_S = 5, 0.2
"""Where more messages of a topic wait for the navigator, the robot's time stands still, for so long [s] at most."""

LATCHED = Qos(10, durability="transient_local")


@dataclass
class Habits:
    """What a robot sends, and how; all may be changed while it runs."""

    clock: bool = True
    clock_every: int = 1
    scans: bool = True
    odometry: bool = True
    tf: bool = True
    static: bool = True
    map_odom: Pose2D | None = None
    stamps: bool = True
    ahead_s: float = 0.0
    speed_share: float = 1.0
    when_commanded: bool = False
    waits_for_pose: bool = False
    odometry_shift: Pose2D = Pose2D(0.0, 0.0)
    tf_shift: Pose2D = Pose2D(0.0, 0.0)
    frame: str = ""
    listens: bool = True
    edit_scan: Callable[[Any], None] | None = None
    as_cloud: bool = False
    edit_cloud: Callable[[Any], None] | None = None
    frames: tuple[str, str] = ("odom", "base_link")
    wheels_m: float | None = None
    by_hand: Twist2D | None = None


def make_cloud(codec: Codec, points: Any, header: Any, kind: str = "<f4") -> Any:
    """A sensor_msgs/PointCloud2 of points in the sensor's frame, shape (N, 3)."""
    width = np.dtype(kind).itemsize
    rows = np.zeros((len(points), 4), dtype=kind)
    rows[:, 1:] = points
    fields = [
        codec.make(
            "sensor_msgs/msg/PointField", name=name, offset=width * (1 + at), datatype=7 if width == 4 else 8, count=1
        )
        for at, name in enumerate("xyz")
    ]
    return codec.make(
        "sensor_msgs/msg/PointCloud2",
        header=header,
        height=1,
        is_dense=False,
        width=len(points),
        fields=fields,
        point_step=4 * width,
        row_step=4 * width * len(points),
        is_bigendian=kind[0] == ">",
        data=np.frombuffer(rows.tobytes(), dtype=np.uint8),
    )


class FakeRobot:
    """Simulates a robot in real time, and publishes what a robot does.

    On a busy machine its time passes more slowly: it neither hurries to catch up, nor sends more than is taken.

    Attributes:
        habits: How it behaves.
        pose: Where it truly is.
        commands: (real time, command) of all that were heard.
        contacts: What it has touched.
    """

    def __init__(self, network: FakeNetwork, codec: Codec, grid: OccupancyGrid, robot: Robot, start: Pose2D) -> None:
        self.habits = Habits()
        self.robot, self._start = robot, start
        self._world = World.from_map(grid)
        self._sim = simulate(self._world, robot, backend="kinematic", lidar=True)
        self.network, self.codec, self.make = network, codec, MessageMaker(codec)
        self.transport = network.transport("robot")
        self._writers: dict[str, Any] = {}
        self._inputs = [
            (self.transport.subscription("/cmd_vel", kind, Qos()), kind) for kind in ("geometry_msgs/msg/Twist",)
        ]
        self._poses: Any = None
        self.pose, self.time, self.commands, self.contacts = start, 100.0, [], []
        self.twist = Twist2D()
        self.told: list[Any] = []
        self._carried: Pose2D | None = None
        self._passed = 0.0
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def start(self) -> None:
        if self.habits.waits_for_pose:
            kind = "geometry_msgs/msg/PoseWithCovarianceStamped"
            self._poses = self.transport.subscription("/initialpose", kind, Qos()), kind
        self._thread.start()

    def close(self) -> None:
        self._ends.set()
        if self._thread.is_alive():
            self._thread.join(5.0)
        self._sim.close()

    def carry(self, pose: Pose2D) -> None:
        """Lift the robot, and put it down there: its odometry jumps."""
        self._carried = pose

    def send(self, topic: str, message: Any, qos: Qos | None = None) -> None:
        key = topic + message.__msgtype__
        if key not in self._writers:
            self._writers[key] = self.transport.publisher(topic, message.__msgtype__, qos or Qos())
        self._writers[key].write(self.codec.encode(message))

    def _run(self) -> None:
        state = self._sim.reset(self._start)
        command, heard, ticks = Twist2D(), -10.0, 0
        due = time.monotonic()
        if self.habits.static:
            self.send("/tf_static", self.make.transforms(self._mounts()), LATCHED)
        if self.habits.wheels_m is not None:
            sides = (("wheel_left_link", 1.0), ("wheel_right_link", -1.0))
            places = [(name, Pose2D(0.0, side * self.habits.wheels_m)) for name, side in sides]
            wheels = [self.make.transform(0.0, "base_link", name, pose) for name, pose in places]
            self.send("/tf_static", self.make.transforms([*self._mounts(), *wheels]), LATCHED)
        while not self._ends.is_set():
            due = max(due + PERIOD_S, time.monotonic())
            time.sleep(max(0.0, due - time.monotonic()))
            self._wait_until_taken()
            habits = self.habits
            for reader, kind in self._inputs:
                for sample in reader.take():
                    message = self.codec.decode(kind, sample.data)
                    command = Twist2D(message.linear.x, message.angular.z)
                    heard = self._passed
                    self.commands.append((time.monotonic(), command))
            if self._poses is not None:
                self.told += [self.codec.decode(self._poses[1], one.data) for one in self._poses[0].take()]
            if self._passed - heard > 0.5:
                command = Twist2D()
            if self._carried is not None:
                self._sim.reset(self._carried)
                self._carried = None
            if habits.by_hand is not None:
                command, heard = habits.by_hand, self._passed
            share = habits.speed_share if habits.listens and not (habits.waits_for_pose and not self.told) else 0.0
            state = self._sim.step(Twist2D(share * command.v, share * command.w), PERIOD_S)
            self.pose, self.twist, self.contacts = state.pose, state.twist, self.contacts + list(state.contacts)
            self.time += PERIOD_S
            self._passed += PERIOD_S
            ticks += 1
            if habits.waits_for_pose and not self.told:
                continue
            self._publish(state, ticks, was_commanded=self._passed - heard < 0.3)

    def _wait_until_taken(self) -> None:
        """Wait for the navigator to take what was sent, unless it does not listen now."""
        until = time.monotonic() + TAKEN_WITHIN_S
        while self.network.most_waiting(self.transport, "/trundle") > MOST_WAITING:
            if time.monotonic() > until or self._ends.is_set():
                return
            time.sleep(0.001)

    def _publish(self, state: Any, ticks: int, *, was_commanded: bool) -> None:
        habits, make = self.habits, self.make
        stamp = self.time + habits.ahead_s if habits.stamps else 0.0
        if habits.clock and ticks % habits.clock_every == 0:
            self.send("/clock", make.clock(self.time))
        odometry = habits.odometry_shift @ (self._start.inverse() @ state.odometry)
        if habits.tf:
            transforms = [make.transform(stamp, "odom", "base_link", habits.tf_shift @ odometry)]
            if habits.map_odom is not None:
                transforms.append(make.transform(stamp, "map", "odom", habits.map_odom))
            self.send("/tf", make.transforms(transforms))
        if habits.odometry and (was_commanded or not habits.when_commanded):
            self.send("/odom", make.odometry(stamp, *habits.frames, odometry, state.twist))
        for scan in state.scans:
            if habits.scans:
                self._send_scan(scan, stamp)

    def _send_scan(self, scan: Scan, stamp: float) -> None:
        topic = "scan" if len(self.robot.lidars) == 1 else f"{scan.lidar}/scan"
        frame = self.habits.frame or (scan.lidar if "lidar" in scan.lidar else f"lidar_{scan.lidar}")
        message = self.make.scan(replace(scan, time=stamp), frame)
        if self.habits.edit_scan is not None:
            self.habits.edit_scan(message)
        if self.habits.as_cloud:
            points = scan.mount.inverse().transform_points(scan.points())
            level = np.column_stack([points, np.zeros(len(points))])
            cloud = make_cloud(self.codec, level, message.header)
            if self.habits.edit_cloud is not None:
                self.habits.edit_cloud(cloud)
            self.send(f"/{topic.removesuffix('scan')}lidar_points", cloud)
            return
        self.send(f"/{topic}", message)

    def _mounts(self) -> list[Any]:
        return [
            self.make.transform(
                0.0,
                "base_link",
                name if "lidar" in name else f"lidar_{name}",
                Pose2D(lidar.x, lidar.y, lidar.yaw),
                lidar.z,
            )
            for name, lidar in self.robot.lidars.items()
        ]
