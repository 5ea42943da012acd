"""Frames between trundle and its child: in order, whole, bounded, and never waiting long for a slow reader."""

import ast
import socket
import sys
import threading
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import ClassVar

import pytest

from trundle.ros2.transport.rclpy import child


@pytest.fixture
def sockets() -> Iterator[tuple[socket.socket, socket.socket]]:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        yield ours, theirs


def test_the_child_is_one_file_of_python_3_10_that_imports_nothing_of_trundle() -> None:
    tree = ast.parse(Path(child.__file__).read_text(), feature_version=(3, 10))
    imports = [node for node in ast.walk(tree) if isinstance(node, (ast.Import, ast.ImportFrom))]
    names = {node.module or "" for node in imports if isinstance(node, ast.ImportFrom)}
    names |= {alias.name for node in imports if isinstance(node, ast.Import) for alias in node.names}
    packages = {name.partition(".")[0] for name in names}
    assert packages - set(sys.stdlib_module_names) == {"rclpy"}
    at_start = [node for node in tree.body if isinstance(node, (ast.Import, ast.ImportFrom))]
    assert "rclpy" not in {alias.name for node in at_start for alias in node.names}


def test_frames_arrive_in_order_and_whole(sockets: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = sockets
    outbox = child.Outbox(ours)
    sent = [(child.CALL, number, bytes([number]) * size) for number, size in enumerate((0, 1, 100_000, 3_000_000, 7))]
    sender = threading.Thread(target=lambda: [outbox.put(*frame) for frame in sent])
    sender.start()
    assert list(islice(child.read_frames(theirs), len(sent))) == sent
    sender.join()
    outbox.close()


def test_of_a_topic_the_newest_messages_wait_for_a_slow_reader(sockets: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = sockets
    outbox = child.Outbox(ours)
    scans, clock = child.Stream(child.PUBLISH, 1, 2), child.Stream(child.PUBLISH, 2, 1)
    outbox.put(child.NOTE, 0, bytes(8_000_000))
    for number in range(5):
        outbox.put_message(scans, b"scan%d" % number)
        outbox.put_message(clock, b"time%d" % number)
    outbox.put(child.CALL, 9, b"last")
    assert (scans.dropped, clock.dropped) == (3, 4)
    got = list(islice(child.read_frames(theirs), 5))[1:]
    assert got == [(2, 1, b"scan3"), (2, 1, b"scan4"), (2, 2, b"time4"), (1, 9, b"last")]
    outbox.close()


def test_what_is_reliable_waits_once_for_room_and_then_no_more(
    sockets: tuple[socket.socket, socket.socket], monkeypatch: pytest.MonkeyPatch
) -> None:
    ours, _ = sockets
    waits: list[float] = []
    outbox = child.Outbox(ours)
    wait_for = outbox._changed.wait_for

    def count(condition, timeout=None):
        if timeout is not None:
            waits.append(timeout)
            timeout = 0.0
        return wait_for(condition, timeout)

    monkeypatch.setattr(outbox._changed, "wait_for", count)
    odometry = child.Stream(child.PUBLISH, 1, 3, patient=True)
    outbox.put(child.NOTE, 0, bytes(8_000_000))
    for _ in range(100):
        outbox.put_message(odometry, b"odometry")
    assert waits == [child.PATIENCE_S]
    assert (len(odometry.waiting), odometry.dropped) == (3, 97)
    outbox.close()


def test_large_messages_that_wait_are_bounded_by_their_size(
    sockets: tuple[socket.socket, socket.socket], monkeypatch
) -> None:
    monkeypatch.setattr(child, "LIMIT", 10_000_000)
    ours, _ = sockets
    outbox = child.Outbox(ours)
    clouds = child.Stream(child.PUBLISH, 1, 100)
    for _ in range(8):
        outbox.put_message(clouds, bytes(4_000_000))
    assert clouds.size <= 10_000_000
    outbox.put_message(clouds, bytes(10_000_001))
    assert clouds.dropped >= 5
    outbox.close()


def test_a_reader_that_is_gone_costs_nothing(sockets: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = sockets
    outbox = child.Outbox(ours)
    scans = child.Stream(child.PUBLISH, 1, 5)
    outbox.put(child.NOTE, 0, bytes(8_000_000))
    theirs.close()
    for _ in range(100):
        outbox.put_message(scans, b"scan")
        outbox.put(child.CALL, 1, b"call")
    outbox.flush(10.0)
    assert not outbox._frames


def test_a_frame_longer_than_any_is_refused_before_it_is_read(sockets: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = sockets
    ours.sendall(child.HEADER.pack(child.LIMIT + 1, child.NOTE, 0))
    with pytest.raises(child.BrokenStreamError, match=f"a frame of {child.LIMIT + 1} bytes"):
        next(child.read_frames(theirs))


@pytest.mark.parametrize("cut", [0, 3, child.HEADER.size, child.HEADER.size + 4])
def test_a_frame_cut_short_ends_the_stream(sockets: tuple[socket.socket, socket.socket], cut: int) -> None:
    ours, theirs = sockets
    whole = child.HEADER.pack(3, child.NOTE, 1) + b"abc"
    ours.sendall(whole + (child.HEADER.pack(8, child.NOTE, 2) + b"12345678")[:cut])
    ours.close()
    assert list(child.read_frames(theirs)) == [(child.NOTE, 1, b"abc")]


class Pose:
    """Of a message class, what rosidl generates and the child reads."""

    _fields: ClassVar = {
        "header": "std_msgs/Header",
        "on": "boolean",
        "raw": "octet",
        "x": "double",
        "covariance": "double[36]",
        "name": "string<20>",
        "points": "sequence<geometry_msgs/Point, 5>",
        "ranges": "sequence<float>",
        "labels": "string[2]",
    }

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        return cls._fields


def test_the_text_of_a_type_is_made_from_its_class() -> None:
    assert child._text(Pose).splitlines() == [
        "std_msgs/Header header",
        "bool on",
        "byte raw",
        "float64 x",
        "float64[36] covariance",
        "string<=20 name",
        "geometry_msgs/Point[<=5] points",
        "float32[] ranges",
        "string[2] labels",
    ]
    assert list(child._parts(Pose)) == ["std_msgs/msg/Header", "geometry_msgs/msg/Point"]


@pytest.mark.parametrize("name", ["String", "std_msgs/String", "std_msgs/msg/a.b", "std_msgs/idl/String", "a/msg/B/C"])
def test_what_is_not_the_name_of_a_type_is_refused(name: str) -> None:
    with pytest.raises(child.RefusedError, match="is not the name of a type"):
        child.load_kind(name)


def test_a_package_that_is_missing_is_named_with_its_package_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DISTRO", "humble")
    with pytest.raises(child.RefusedError, match=r"this ROS has no nav9_msgs .*: apt install ros-humble-nav9-msgs"):
        child.load_kind("nav9_msgs/msg/Path")


@pytest.mark.parametrize(
    ("where", "distro", "expected"),
    [
        ("localhost", "humble", {"ROS_LOCALHOST_ONLY": "1"}),
        ("subnet", "humble", {"ROS_LOCALHOST_ONLY": "0"}),
        ("localhost", "jazzy", {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}),
        ("subnet", "", {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}),
    ],
)
def test_the_range_is_set_as_the_distribution_reads_it(
    monkeypatch: pytest.MonkeyPatch, where: str, distro: str, expected: dict[str, str]
) -> None:
    names = ("ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE")
    for name in names:
        monkeypatch.setenv(name, "OFF")
    child._set_range(where, distro)
    assert {name: child.os.environ[name] for name in names if name in child.os.environ} == expected


class _Handle:
    """Of a goal, as rclpy has it: it can be canceled only once rclpy has it as being canceled."""

    def __init__(self) -> None:
        self.is_cancel_requested = False
        self.how = ""

    def succeed(self) -> None:
        self.how = "succeeded"

    def abort(self) -> None:
        self.how = "aborted"

    def canceled(self) -> None:
        if not self.is_cancel_requested:
            raise RuntimeError("invalid transition from state EXECUTING with event CANCELED")
        self.how = "canceled"


def test_a_goal_that_trundle_cancels_sooner_than_rclpy_ends_as_canceled() -> None:
    handle = _Handle()
    threading.Timer(0.05, lambda: setattr(handle, "is_cancel_requested", True)).start()
    child.end_goal(handle, child.CANCELED)
    assert handle.how == "canceled"
    child.end_goal(handle, child.SUCCEEDED)
    assert handle.how == "succeeded"
