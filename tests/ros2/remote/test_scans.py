"""Messages of sensors as scans, with the mistakes that drivers make; frames; the robot's time."""

from __future__ import annotations

import math
import threading
import time as clock
from typing import Any

import numpy as np
import pytest

from ros2.fake_transport import FakeNetwork
from ros2.remote.conftest import jazzy
from ros2.remote.robot import make_cloud
from trundle.geometry import Pose2D
from trundle.messages import MessageMaker, Qos
from trundle.observation import Scan
from trundle.robots import Lidar, Robot
from trundle.ros2.bad_input import MOST_KINDS, BadInputError, Warnings
from trundle.ros2.names import Names
from trundle.ros2.profile import Profile
from trundle.ros2.remote.commands import Sources
from trundle.ros2.remote.frames import FrameTree, Mount, Mounts, mount_matrix
from trundle.ros2.remote.guard import Guard
from trundle.ros2.remote.inputs import RobotInputs
from trundle.ros2.remote.robot import RunTime
from trundle.ros2.remote.scans import Band, read_cloud, read_scan
from trundle.ros2.remote.streams import RobotClock, Stream
from trundle.ros2.types import Types
from trundle.ros2.wire import Wire

FORWARD = Mount(mount_matrix(0.2, 0.0, 0.3, 0.0))
LIDAR = Lidar(x=0.2, y=0.0, z=0.3, fov=math.pi, range_max=10.0)


def make_message(ranges: list[float], first: float = -0.1, step: float = 0.1) -> Any:
    angles = first + step * np.arange(len(ranges))
    scan = Scan("front", 1.0, Pose2D(0.0, 0.0), 0.3, angles, np.ones(len(ranges)), 0.1, 10.0)
    message = MessageMaker(jazzy()).scan(scan, "lidar")
    message.ranges = np.array(ranges, dtype=np.float32)
    return message


def test_scans_that_are_heard_at_a_time_are_taken_together() -> None:
    network, robot = FakeNetwork(), Robot.load("nova_carter")
    transport, theirs = network.transport(), network.transport("robot")
    types = Types(jazzy(), transport)
    wire = Wire(transport, types, Names())
    inputs = RobotInputs(wire, Profile.load("plain"), robot, Guard(wire.warn), Sources(wire))
    inputs.open()
    decode, taken = types.decode, list[int]()

    def slow(name: str, data: bytes) -> Any:
        clock.sleep(0.05)  # for the other thread, which takes what there is
        return decode(name, data)

    types.decode = slow  # pyright: ignore[reportAttributeAccessIssue]
    for name in inputs.sensors:
        message = make_message([1.0, 1.0])
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(clock.time_ns(), 1_000_000_000)
        theirs.publisher(f"/{name}/scan", message.__msgtype__, Qos()).write(jazzy().encode(message))
    driver = threading.Thread(target=lambda: inputs.wait_for_scan(10.0) and taken.append(len(inputs.take_scans())))
    driver.start()
    wire.do_round()
    driver.join()
    assert len(inputs.sensors) == 2
    assert taken == [2]


def test_a_frame_of_scans_that_tf_lacks_is_remarked_on_once_tf_has_had_time() -> None:
    transport = FakeNetwork().transport()
    wire = Wire(transport, Types(jazzy(), transport), Names())
    robot = Robot.load("jackal")
    (sensor,) = Profile.load("plain").sensors_of(robot).values()
    mounts = Mounts(wire, FrameTree(), "base_link", robot)
    for now, said in ((0.0, 0), (1.0, 0), (3.0, 1)):
        assert mounts.find("front", sensor, "velodyne", now).pose.x == robot.lidars["front"].x
        assert wire.warnings.counts.get("scans of front: frame", 0) == said


def test_kinds_of_warnings_are_bounded_whatever_names_are_in_them() -> None:
    said: list[str] = []
    warnings = Warnings(said.append)
    for number in range(1000):
        warnings.warn(f"tf: junk{number}", f"junk{number} is dropped")
    assert len(warnings.counts) == len(said) == MOST_KINDS + 1
    assert sum(warnings.counts.values()) == 1000


def test_a_range_of_0_is_no_measurement_and_one_out_of_range_is_too_close_or_free() -> None:
    scan, remarks = read_scan(make_message([0.0, 0.05, 3.0, 11.0, math.nan, -1.0]), "front", 5.0, FORWARD)
    assert np.isnan(scan.ranges[[0, 4, 5]]).all()
    assert scan.ranges[1] == -math.inf
    assert scan.ranges[2] == pytest.approx(3.0)
    assert scan.ranges[3] == math.inf
    assert scan.time == 5.0
    assert not remarks


def test_the_beams_of_a_turtlebot3_begin_in_front() -> None:
    message = make_message([1.0] * 360, first=0.0, step=2.0 * math.pi / 360.0)
    scan, remarks = read_scan(message, "lidar", 0.0, Mount(mount_matrix(0.0, 0.0, 0.2, 0.0)))
    assert scan.points()[0] == pytest.approx((1.0, 0.0))
    assert scan.points()[90] == pytest.approx((0.0, 1.0), abs=1e-6)
    assert not remarks


def test_the_increment_counts_where_angle_max_does_not_match() -> None:
    message = make_message([1.0, 1.0, 1.0])
    message.angle_max = 3.0
    scan, remarks = read_scan(message, "front", 0.0, FORWARD)
    assert scan.angles == pytest.approx([-0.1, 0.0, 0.1])
    assert [kind for kind, _ in remarks] == ["angle_max"]


def test_reversed_angles_are_refused() -> None:
    message = make_message([1.0, 1.0, 1.0])
    message.angle_increment = -0.1
    with pytest.raises(BadInputError, match="point the other way"):
        read_scan(message, "front", 0.0, FORWARD)


def test_a_lidar_that_hangs_upside_down_turns_the_other_way() -> None:
    matrix = np.diag((1.0, -1.0, -1.0, 1.0))
    scan, _ = read_scan(make_message([1.0, 1.0], first=0.0, step=0.5 * math.pi), "front", 0.0, Mount(matrix))
    assert scan.points()[1] == pytest.approx((0.0, -1.0), abs=1e-6)


def make_message_of_cloud(points: list[tuple[float, float, float]], kind: str = "<f4") -> Any:
    header = MessageMaker(jazzy()).header(1.0, "lidar")
    return make_cloud(jazzy(), np.array(points), header, kind)


@pytest.mark.parametrize("kind", ["<f4", "<f8", ">f4"])
def test_a_cloud_is_a_scan_of_the_points_in_a_band_of_heights(kind: str) -> None:
    message = make_message_of_cloud(
        [(2.0, 0.01, 0.0), (3.0, 0.01, 0.0), (1.0, 1.0, -0.3), (0.0, 2.0, 1.5), (math.nan,) * 3], kind
    )
    scan = read_cloud(message, LIDAR, "front", 1.0, FORWARD, Band(0.1, 1.0))
    assert scan.points() == pytest.approx(np.array([[2.2, 0.01]]), abs=0.02)
    ahead, behind = scan.ranges[np.abs(scan.angles) < 1.5], scan.ranges[np.abs(scan.angles) > 1.7]
    assert np.isnan(ahead).sum() == 8  # beside the point
    assert np.isinf(ahead).sum() == len(ahead) - 9
    assert np.isnan(behind).all()


@pytest.mark.parametrize(
    ("field", "value", "match"),
    [("width", 9, "bytes are not"), ("fields", [], "no field x"), ("width", 2_000_000, "and not at most")],
)
def test_a_cloud_that_is_none_is_refused(field: str, value: object, match: str) -> None:
    message = make_message_of_cloud([(1.0, 0.0, 0.0)])
    setattr(message, field, value)
    message.row_step = 0
    with pytest.raises(BadInputError, match=match):
        read_cloud(message, LIDAR, "front", 1.0, FORWARD, Band(0.1, 1.0))


# Frames -------------------------------------------------------------------------------------------------------------


def test_frames_are_found_above_below_and_beside() -> None:
    tree = FrameTree()
    assert not tree.add("odom", "base", mount_matrix(1.0, 2.0, 0.0, math.pi / 2), 5.0)
    assert not tree.add("base", "lidar", mount_matrix(0.5, 0.0, 0.3, 0.0), None)
    assert not tree.add("base", "camera", mount_matrix(0.0, 0.5, 0.3, 0.0), None)
    found = tree.find("odom", "lidar")
    assert found is not None
    assert (found.pose.x, found.pose.y, found.time) == pytest.approx((1.0, 2.5, 5.0))
    beside = tree.find("camera", "lidar")
    assert beside is not None
    assert (beside.pose.x, beside.pose.y) == pytest.approx((0.5, -0.5))
    assert tree.find("map", "lidar") is None


def test_loops_and_transforms_that_are_none_are_refused() -> None:
    tree = FrameTree()
    one = mount_matrix(1.0, 0.0, 0.0, 0.0)
    assert not tree.add("a", "b", one, 1.0)
    assert not tree.add("b", "c", one, 1.0)
    assert "closes a loop" in tree.add("c", "a", one, 1.0)
    assert "connects nothing" in tree.add("a", "a", one, 1.0)
    assert "not finite" in tree.add("a", "d", np.full((4, 4), np.nan), 1.0)
    assert not tree.add("x", "b", one, 2.0)
    assert tree.moved == {"b": ("a", "x")}


# Time ---------------------------------------------------------------------------------------------------------------


def test_a_transform_that_was_overtaken_is_left_out_and_one_of_a_time_that_was_reset_counts() -> None:
    tree = FrameTree()
    for x, time in ((1.0, 102.0), (2.0, 101.9), (3.0, 5.0)):
        assert not tree.add("map", "odom", mount_matrix(x, 0.0, 0.0, 0.0), time)
        found = tree.find("map", "odom")
        assert found is not None
        assert found.pose.x == (3.0 if x == 3.0 else 1.0)


@pytest.mark.parametrize(("rate", "allowed"), [(50.0, 0.25), (10.0, 0.3), (5.0, 0.44), (2.0, 1.1)])
def test_each_stream_is_silent_by_its_own_rate(rate: float, allowed: float) -> None:
    stream = Stream("scans")
    for number in range(50):
        stream.mark(number / rate)
    assert stream.allowed_s == pytest.approx(allowed, abs=0.01)
    assert not stream.silent_s(stream.last + 0.9 * allowed)
    assert stream.silent_s(stream.last + 1.1 * allowed)


def test_a_silence_does_not_change_the_rate() -> None:
    stream = Stream("scans")
    for number in range(50):
        stream.mark(number / 10.0)
    stream.mark(30.0)
    assert stream.period == pytest.approx(0.1)


def test_stamps_ahead_of_a_slow_clock_tell_the_time() -> None:
    clock = RobotClock()
    clock.set(100.0, 0.0)
    clock.see(100.15, 5.0)
    assert clock.now(5.0) == pytest.approx(100.15)
    clock.see(107.0, 5.0)
    assert clock.now(5.0) == pytest.approx(100.15)
    assert not clock.set(100.1, 0.1)
    assert clock.set(3.0, 0.2)
    assert clock.now(5.0) == pytest.approx(3.0)


def test_a_robot_whose_clock_is_set_differently_has_its_own_time() -> None:
    clock = RobotClock()
    clock.see(5000.0, 9000.05)
    clock.see(5000.1, 9000.1)
    assert clock.now(9000.1) == pytest.approx(5000.1)
    assert clock.now(9000.2) == pytest.approx(5000.2)


@pytest.mark.parametrize("stamp", [50.0, 3e9])
def test_a_run_that_began_before_the_robots_clock_is_known_goes_on_in_its_time(stamp: float) -> None:
    clock, time, wall = RobotClock(), RunTime(), 1.7e9
    now = time.at(clock.now(wall), clock.epoch)
    assert now == 0.0
    for step in range(1, 21):  # a clock that is set differently, and no /clock
        clock.see(stamp + 0.05 * step, wall + 0.05 * step)
        now = time.at(clock.now(wall + 0.05 * step), clock.epoch)
    assert now == pytest.approx(0.95, abs=0.01)
    assert stamp + 1.0 - time.offset == pytest.approx(now)
