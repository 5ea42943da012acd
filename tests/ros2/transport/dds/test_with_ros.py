"""Cyclone DDS here and a real rclpy, over Fast DDS, on the other side."""

from __future__ import annotations

import json
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from ros2.conftest import Ros
from ros2.random_messages import random_message
from ros2.transport.dds.conftest import PATIENCE_S, received, until
from trundle.messages import Codec, Qos
from trundle.messages.qos import LATCHED, SENSOR
from trundle.ros2.transport.dds.node import DdsTransport
from trundle.ros2.transport.domain import Settings

PEER = Path(__file__).parent / "peers" / "echo.py"

TYPES = (
    "rosgraph_msgs/msg/Clock",
    "tf2_msgs/msg/TFMessage",
    "nav_msgs/msg/Odometry",
    "nav_msgs/msg/Path",
    "nav_msgs/msg/OccupancyGrid",
    "map_msgs/msg/OccupancyGridUpdate",
    "sensor_msgs/msg/LaserScan",
    "sensor_msgs/msg/PointCloud2",
    "sensor_msgs/msg/JointState",
    "std_msgs/msg/String",
    "geometry_msgs/msg/Twist",
    "geometry_msgs/msg/TwistStamped",
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "visualization_msgs/msg/MarkerArray",
)
"""All that the bridge sends and takes."""


@pytest.fixture
def node(ros: Ros) -> Iterator[DdsTransport]:
    """Our node, on the domain of the real ROS."""
    settings = Settings(domain=ros.domain, distro=ros.distro)  # pyright: ignore[reportArgumentType]
    made = DdsTransport(settings)
    yield made
    made.close()


def start(ros: Ros, *topics: str) -> subprocess.Popen[str]:
    peer = ros.script(PEER, *topics)
    assert peer.stdout is not None
    line = peer.stdout.readline()
    assert line == "ready\n", peer.communicate()
    return peer


def graph_of(peer: subprocess.Popen[str], node: str, seen: Callable[[dict], bool]) -> dict:
    """What the other side sees, once it sees enough."""
    assert peer.stdin is not None
    assert peer.stdout is not None
    end = time.monotonic() + PATIENCE_S
    while True:
        peer.stdin.write(f"{node}\n")
        peer.stdin.flush()
        found = json.loads(peer.stdout.readline())
        if "error" not in found and seen(found):
            return found
        assert time.monotonic() < end, found
        time.sleep(0.1)


def test_messages_come_back_to_the_bit(ros: Ros, node: DdsTransport) -> None:
    codec, rng = Codec(node.distro), np.random.default_rng(3)
    ways = [
        (node.publisher(f"/t{number}/there", name, Qos()), node.subscription(f"/t{number}/back", name, Qos()))
        for number, name in enumerate(TYPES)
    ]
    start(ros, *(f"/t{number}={name}" for number, name in enumerate(TYPES)))
    until(lambda: all(there.matched and back.matched for there, back in ways), "the other side")
    for (there, back), name in zip(ways, TYPES, strict=True):
        data = codec.encode(random_message(codec, name, rng))
        there.write(data)
        (sample,) = received(node, back, 1)
        assert sample.data.rstrip(b"\0") == data.rstrip(b"\0"), name  # Fast DDS fills up to four bytes
        assert codec.encode(codec.decode(name, sample.data)) == data, name
        assert sample.source, name


def test_quality_of_service_is_accepted_and_a_late_joiner_gets_what_is_latched(ros: Ros, node: DdsTransport) -> None:
    codec, rng = Codec(node.distro), np.random.default_rng(4)
    text, scan = "std_msgs/msg/String", "sensor_msgs/msg/LaserScan"
    latched = node.publisher("/map/there", text, LATCHED)
    latched.write(codec.encode(codec.make(text, data="old")))
    latched.write(codec.encode(codec.make(text, data="new")))
    back = node.subscription("/map/back", text, LATCHED)
    scans, scans_back = node.publisher("/scan/there", scan, SENSOR), node.subscription("/scan/back", scan, SENSOR)
    start(ros, f"/map={text}:latched", f"/scan={scan}:sensor")
    assert [codec.decode(text, one.data).data for one in received(node, back, 1)] == ["new"]
    late = node.subscription("/map/back", text, LATCHED)
    assert [codec.decode(text, one.data).data for one in received(node, late, 1)] == ["new"]
    until(lambda: scans.matched == 1 and scans_back.matched == 1, "the sensor's profile")
    data = codec.encode(random_message(codec, scan, rng))
    scans.write(data)
    assert received(node, scans_back, 1)[0].data.rstrip(b"\0") == data.rstrip(b"\0")


def test_each_side_lists_the_other_with_types_hashes_and_quality_of_service(ros: Ros, node: DdsTransport) -> None:
    codec = Codec(node.distro)
    text, twist = "std_msgs/msg/String", "geometry_msgs/msg/Twist"
    node.publisher("/map/there", text, LATCHED)
    node.subscription("/cmd_vel", twist, SENSOR)
    peer = start(ros, f"/map={text}:latched")

    seen = graph_of(peer, "/trundle", lambda it: "/cmd_vel" in it["subscribers"] and "/map/there" in it["publishers"])
    assert {"/trundle", "/real/echo"} <= set(seen["nodes"])
    assert seen["publishers"] == {"/map/there": [text]}
    assert seen["subscribers"] == {"/cmd_vel": [twist]}
    (command,) = seen["endpoints"]["/cmd_vel"]
    assert (command["kind"], command["type"], command["hash"]) == ("SUBSCRIPTION", twist, codec.type_hash(twist))
    assert (command["reliability"], command["durability"]) == ("BEST_EFFORT", "VOLATILE")
    (ours,) = (one for one in seen["endpoints"]["/map/there"] if one["kind"] == "PUBLISHER")
    assert (ours["hash"], ours["reliability"], ours["durability"]) == (
        codec.type_hash(text),
        "RELIABLE",
        "TRANSIENT_LOCAL",
    )

    until(lambda: "/real/echo" in node.graph().nodes, "their node")
    (theirs,) = node.graph().subscriptions("/map/there")
    assert (theirs.node, theirs.type_name, theirs.ours) == ("/real/echo", text, False)
    assert theirs.type_hash == codec.type_hash(text)
    assert (theirs.qos.reliability, theirs.qos.durability) == ("reliable", "transient_local")
    assert {offer.kind for offer in node.graph().offers if offer.node == "/real/echo"} == {"service server"}


@pytest.mark.parametrize(
    ("distro", "signal"),
    [
        ("jazzy", "terminate"),
        ("kilted", "kill"),
        pytest.param("jazzy", "kill", marks=pytest.mark.ros2),
        pytest.param("kilted", "terminate", marks=pytest.mark.ros2),
    ],
)
def test_a_node_that_is_ended_leaves_and_comes_back(ros: Ros, node: DdsTransport, signal: str) -> None:
    text = "std_msgs/msg/String"
    there, back = node.publisher("/t/there", text, Qos()), node.subscription("/t/back", text, Qos())
    data = Codec(node.distro).encode(Codec(node.distro).make(text, data="x"))
    first = start(ros, f"/t={text}")
    until(lambda: there.matched == 1 and back.matched == 1, "the first")
    getattr(first, signal)()
    first.wait(PATIENCE_S)
    start(ros, f"/t={text}")
    before = len(back.take())
    until(lambda: back.matched >= 1 and there.matched >= 1, "the second")
    end = time.monotonic() + PATIENCE_S
    while len(back.take()) == before and time.monotonic() < end:
        there.write(data)
        node.wait(0.1)
    assert time.monotonic() < end
    assert there.dropped == 0
