"""Bad input of a robot that is somewhere else: one warning each, nothing crashes, and the robot stands."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest

from ros2.fake_transport import FakeNetwork
from ros2.navigator_role.conftest import wait_for
from ros2.remote.conftest import STAND, START, Remote, jazzy
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.messages import MessageMaker, Qos
from trundle.robots import Robot
from trundle.ros2.remote.frames import FrameTree, mount_matrix
from trundle.ros2.remote.guard import OutlineCheck

Navigate = Callable[..., Remote]
FAR = (8.0, 5.0)
pytestmark = pytest.mark.filterwarnings("ignore::trundle.errors.SensorWarning")


@contextmanager
def sending(network: FakeNetwork, topic: str, message: Callable[[], Any], period_s: float = 0.02) -> Iterator[None]:
    """Let a stranger send messages in the block."""
    codec, ends = jazzy(), threading.Event()
    first = message()
    writer = network.transport("stranger").publisher(topic, first.__msgtype__, Qos())

    def send() -> None:
        while not ends.wait(period_s):
            writer.write(codec.encode(message()))

    thread = threading.Thread(target=send, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ends.set()
        thread.join(5.0)


def transform(remote: Remote, parent: str, child: str) -> Callable[[], Any]:
    make = remote.robot.make
    return lambda: make.transforms([make.transform(remote.robot.time, parent, child, Pose2D(0.1, 0.0))])


def said_once(remote: Remote, text: str) -> None:
    assert len([line for line in remote.said if text in line]) == 1, remote.said


def test_foreign_frames_are_taken_with_one_remark_each(navigate: Navigate) -> None:
    remote = navigate(goal=FAR, habits={"frame": "velodyne", "frames": ("wheel_odom", "chassis")})
    remote.wait_until_moving()
    said_once(remote, "the odometry has frames 'wheel_odom' and 'chassis'")
    said_once(remote, "have the frame 'velodyne', which tf lacks")


def test_two_trees_let_the_robot_stand_until_there_is_one(navigate: Navigate, network: FakeNetwork) -> None:
    remote = navigate(goal=FAR)
    remote.wait_until_moving()
    with sending(network, "/tf", transform(remote, "other_odom", "base_link")):
        assert remote.wait_until_standing() < 0.6
        wait_for(lambda: "tf contradicts" in remote.reasons)
        time.sleep(0.3)
        assert remote.robot.commands[-1][1] == STAND
    said_once(remote, "tf has two parents of base_link: odom and other_odom; the newest counts")
    remote.wait_until_moving()


def test_a_loop_of_transforms_lets_the_robot_stand(navigate: Navigate, network: FakeNetwork) -> None:
    remote = navigate(goal=FAR)
    remote.wait_until_moving()
    with sending(network, "/tf", transform(remote, "base_link", "odom")):
        assert remote.wait_until_standing() < 0.6
        wait_for(lambda: "tf contradicts" in remote.reasons)
    said_once(remote, "the transform base_link → odom closes a loop")
    remote.wait_until_moving()


def test_a_robot_whose_wheels_are_outside_of_its_files_outline_stands(navigate: Navigate) -> None:
    remote = navigate(goal=FAR, habits={"wheels_m": 0.29})
    wait_for(lambda: "outline" in remote.reasons)
    time.sleep(0.5)
    assert not [command for _, command in remote.robot.commands if command != STAND]
    said_once(remote, "wheel_left_link is at (0.00, 0.29), outside of the outline of turtlebot3_waffle")


@pytest.mark.parametrize(("y", "is_right"), [(0.144, True), (0.19, True), (0.22, False)])
def test_wheels_say_how_wide_a_robot_is(y: float, is_right: bool) -> None:
    tree = FrameTree()
    check = OutlineCheck(tree, "base_link", Robot.load("turtlebot3_waffle"))
    assert not tree.add("base_link", "camera", mount_matrix(3.0, 0.0, 1.0, 0.0), None)
    assert not tree.add("base_link", "Left_Wheel", mount_matrix(0.0, y, 0.03, 0.0), 1.0)
    check.look()
    assert bool(check.rule(0.0)) is not is_right


def mirror(scan: Any) -> None:
    scan.ranges = np.ascontiguousarray(np.asarray(scan.ranges)[::-1])


def other_site() -> OccupancyGrid:
    """A hall of columns in no order, which has nothing of the room of the map."""
    data = np.zeros((260, 300), dtype=np.int8)
    for row, col in np.random.default_rng(3).integers((0, 0), (250, 290), (150, 2)):
        if abs(row - 90) > 14 or abs(col - 90) > 14:
            data[row : row + 6, col : col + 6] = 100
    return OccupancyGrid(data, 0.05, Pose2D(-2.5, -2.5))


@pytest.mark.parametrize(
    "more", [{"habits": {"edit_scan": mirror}}, {"room": other_site()}], ids=["mirrored scans", "map of another site"]
)
def test_a_robot_that_cannot_be_located_stands(navigate: Navigate, more: dict[str, Any]) -> None:
    remote = navigate(goal=(5.0, 2.0), localizer="amcl", **more)
    drive = remote.bridge.drive
    assert drive is not None
    why = "the scans do not fit the map where the robot was told to be"
    wait_for(lambda: why in " ".join(remote.bridge.guard.reasons.values()), "for the reason")
    drive.waits_s = 1.5
    remote.wait_for_end()
    assert why in drive.message
    said_once(remote, why)
    assert not [command for _, command in remote.robot.commands if command != STAND]


def test_a_goal_in_a_frame_of_the_robot_is_transformed_and_another_one_refused(
    navigate: Navigate, network: FakeNetwork
) -> None:
    remote = navigate(goal=None)
    wait_for(lambda: not remote.reasons and remote.bridge.localizer.is_located)
    make = remote.robot.make
    for _ in range(3):
        remote.robot.send("/goal_pose", make.goal(0.0, Pose2D(1.0, 0.0), "mars"))
    wait_for(lambda: remote.bridge.wire.warnings.counts.get("goal_pose: wrong frame") == 3)
    said_once(remote, "its frame is 'mars', which is none of map, odom, base_link")
    frame = next(one.child_frame_id for one in remote.robot._mounts())
    remote.robot.send("/goal_pose", make.goal(0.0, Pose2D(0.8, 0.0), frame))
    lidar = next(iter(remote.robot.robot.lidars.values()))
    target = START @ Pose2D(lidar.x, lidar.y, lidar.yaw) @ Pose2D(0.8, 0.0)
    wait_for(lambda: remote.robot.pose.distance_to(target) < 0.3)


@pytest.mark.parametrize(
    ("topic", "make"),
    [
        ("/tf", lambda make, time: make.transforms([make.transform(time, "odom", "cup", Pose2D(1.0, 0.0))])),
        ("/goal_pose", lambda make, time: make.goal(time, Pose2D(1.0, 0.0), "mars")),
        (
            "/scan",
            lambda make, time: make.codec.make(SCAN, **EMPTY, header=make.header(time, "")),
        ),
    ],
    ids=["tf", "goals", "scans"],
)
def test_floods_are_cut_with_one_warning(
    navigate: Navigate, network: FakeNetwork, topic: str, make: Callable[[MessageMaker, float], Any]
) -> None:
    remote = navigate(goal=None)
    wait_for(lambda: not remote.reasons)
    with sending(network, topic, lambda: make(remote.robot.make, remote.robot.time), 0.0003):
        wait_for(lambda: f"{topic}: flood" in remote.kinds and "flood" in remote.reasons, "for the flood")
    assert len([line for line in remote.said if f"floods {topic} with more than" in line]) == 1
    assert remote.bridge.guard.counts["flood"] == 1
    assert not [command for _, command in remote.robot.commands if command != STAND]
    wait_for(lambda: not remote.reasons, f"for the robot to be free: {remote.reasons}")


SCAN = "sensor_msgs/msg/LaserScan"
EMPTY: dict[str, Any] = {
    "angle_min": 0.0,
    "angle_max": 1.0,
    "angle_increment": 0.1,
    "time_increment": 0.0,
    "scan_time": 0.0,
    "range_min": 0.1,
    "range_max": 3.0,
    "ranges": np.zeros(0, np.float32),
    "intensities": np.zeros(0, np.float32),
}


@pytest.mark.parametrize("shift_s", [-1000.0, 30.0])
def test_two_clocks_without_a_clock_topic_are_the_reason_to_stand(navigate: Navigate, shift_s: float) -> None:
    def late(scan: Any) -> None:
        scan.header.stamp.sec += int(shift_s)

    remote = navigate(goal=FAR, habits={"clock": False, "edit_scan": late, "ahead_s": 5000.0})
    wait_for(lambda: "clocks differ" in remote.reasons)
    time.sleep(0.5)
    first = next(iter(remote.bridge.guard.reasons.values()))
    assert first.startswith("stamps of ")
    assert "scans of" in first
    assert " s apart: set their clocks" in first
    said_once(remote, "s apart: set their clocks")
    assert not [command for _, command in remote.robot.commands if command != STAND]
