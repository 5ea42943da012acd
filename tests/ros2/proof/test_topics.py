"""Every topic, both ways, to the bit; what is recorded is what was received; and how others see the node."""

from __future__ import annotations

import base64
import dataclasses
import json
import time
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader

from ros2.conftest import hashes
from ros2.lines import QUICK_S, Lines
from ros2.proof.conftest import PAIRS, Bench, asked, bench_of
from trundle.messages import Codec

COMMANDS = [
    ["/cmd_vel", "geometry_msgs/msg/Twist", {"linear": {"x": 0.1 + 0.2, "y": 5e-324}, "angular": {"z": -1e-17}}],
    [
        "/cmd_vel",
        "geometry_msgs/msg/TwistStamped",
        {"header": {"frame_id": "base_link"}, "twist": {"linear": {"x": 1 / 3}}},
    ],
]


GOALS = [
    [
        "/goal_pose",
        "geometry_msgs/msg/PoseStamped",
        {"header": {"frame_id": "odom"}, "pose": {"position": {"x": 1.0 + 1 / 3}, "orientation": {"w": 1.0}}},
    ],
    [
        "/initialpose",
        "geometry_msgs/msg/PoseWithCovarianceStamped",
        {"header": {"frame_id": "map"}, "pose": {"pose": {"position": {"x": 1 / 3}, "orientation": {"w": 1.0}}}},
    ],
]

SENT = {"simulator": COMMANDS, "navigator": GOALS}
"""What each role reads."""

TALKS = [pytest.param((*case.values, "simulator"), id=f"{case.id}-simulator", marks=case.marks) for case in PAIRS] + [
    pytest.param(
        (*case.values, "navigator"),
        id=f"{case.id}-navigator",
        marks=case.marks if case is PAIRS[0] else pytest.mark.ros2,
    )
    for case in PAIRS
]
"""Each pair in each role."""

RARE = {
    *("/contacts", "/plan", "/rosout", "/trajectories", "/waypoints"),
    *("/global_costmap/costmap_updates", "/local_costmap/costmap_updates"),
}
"""Topics on which nothing may be said."""


def recorded(path: Path) -> dict[tuple[str, str], list[bytes]]:
    """The messages of a recording, by topic and type."""
    found: dict[tuple[str, str], list[bytes]] = defaultdict(list)
    with path.open("rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages():
            assert schema is not None
            found[channel.topic, schema.name].append(message.data)
    return found


def plain(value: Any) -> Any:
    """A message of the codec as lists, numbers and texts."""
    if dataclasses.is_dataclass(value):
        # Constants are fields of rosbags' classes, too.
        names = [field.name for field in dataclasses.fields(value)]
        return {name: plain(getattr(value, name)) for name in names if name == name.lower() != "__msgtype__"}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return [plain(one) for one in value] if isinstance(value, list) else value


def collect(lines: Lines, topics: set[str], count: int) -> dict[str, list[dict[str, Any]]]:
    """Messages until there are so many of each topic, one of those that come once."""
    heard: dict[str, list[dict[str, Any]]] = defaultdict(list)
    until = time.monotonic() + QUICK_S
    while missing := {topic for topic in topics if len(heard[topic]) < count}:
        assert time.monotonic() < until, f"not received: {missing}"
        line = lines.next()
        assert "incompatible" not in line, line
        if "topic" in line:
            heard[line["topic"]].append(line)
    return heard


def places(received: list[bytes], written: list[bytes]) -> list[int]:
    """Where messages stand among those that were written. Cyclone DDS sends up to three bytes more."""
    found, start = [], 0
    for data in received:
        start = next(
            at
            for at in range(start, len(written))
            if data[: len(written[at])] == written[at] and len(data) - len(written[at]) < 4
        )
        found.append(start)
        start += 1
    return found


@dataclasses.dataclass
class Talk:
    """What both sides said, while `trundle ros2 serve` ran."""

    distro: str
    role: str
    offered: list[dict[str, Any]]
    heard: dict[str, list[dict[str, Any]]]
    late: dict[str, list[dict[str, Any]]]
    sent: dict[tuple[str, str], bytes]
    graph: dict[str, Any]
    kept: dict[tuple[str, str], list[bytes]]
    ended: dict[str, Any]
    hashes: dict[str, str]

    @property
    def once(self) -> set[str]:
        """Topics that keep what was said last for late joiners."""
        return {one["topic"] for one in self.offered if one["durability"] == "transient_local"}


@pytest.fixture(scope="module", params=TALKS)
def talk(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Talk]:
    """A talk of some seconds with each role, for each pair of distribution and transport."""
    pair, role = request.param
    folder = tmp_path_factory.mktemp("talk")
    with bench_of(pair, folder) as bench:
        yield converse(bench, role, folder / "wire.mcap")


def converse(bench: Bench, role: str, out: Path) -> Talk:
    """Serve, listen, look, command, and listen again."""
    commands = SENT[role]
    server = bench.serve("lot", "--seed", 3, "--role", role, "--record", "--out", out)
    offered = server.offer["publishes"]
    once = [one for one in offered if one["durability"] == "transient_local"]
    names = {one["topic"] for one in offered}
    first = commands[0][0]
    readers = sum(topic == first for topic, *_ in commands)
    sought = json.dumps(sorted({topic for topic, *_ in commands}))
    looking = bench.client("graph.py", "trundle", json.dumps(sorted(names)), sought, first, readers)
    listening = bench.client("listener.py", asked(offered))
    kept = {one["topic"] for one in once} - RARE
    heard = collect(listening, names - kept - RARE, 5)
    for topic, lines in collect(listening, kept - heard.keys(), 1).items():
        heard[topic] += lines
    talking = [bench.client("talker.py", json.dumps([command])) for command in commands]
    late = collect(bench.client("listener.py", asked(once)), kept, 1)
    sent: dict[tuple[str, str], bytes] = {}
    for (topic, kind, _), lines in zip(commands, talking, strict=True):
        sent[topic, kind] = base64.b64decode(lines.next()["data"])
    graph = looking.next()
    # Our reader finds a writer some time after the writer has found it: on a busy machine, seconds.
    listening.until(lambda line: line.get("topic") == "/odom" and line["value"]["twist"]["twist"]["linear"]["x"] > 0.1)
    collect(listening, {"/odom"}, 300)
    ended = server.end()
    return Talk(bench.distro, role, offered, heard, late, sent, graph, recorded(out), ended, hashes(bench.ros))


def test_what_is_published_is_received_and_recorded_to_the_bit(talk: Talk) -> None:
    assert talk.ended["recording_error"] is None
    for one in talk.offered:
        topic = one["topic"]
        received = [base64.b64decode(line["data"]) for line in talk.heard[topic]]
        # A slow reader may miss some where new messages push out old ones; what it gets comes in order.
        at = places(received, talk.kept[topic, one["type"]])
        assert at == sorted(at), topic
    assert {topic for topic in talk.heard if talk.heard[topic]} >= {one["topic"] for one in talk.offered} - RARE


def test_the_other_side_reads_the_values_that_were_written(talk: Talk) -> None:
    codec, kinds = Codec(talk.distro), {one["topic"]: one["type"] for one in talk.offered}
    for topic, lines in talk.heard.items():
        for line in lines:
            for status in line["value"].get("status", []) if topic == "/diagnostics" else []:
                (status["level"],) = status["level"]  # a byte is bytes in rclpy
            assert line["value"] == plain(codec.decode(kinds[topic], base64.b64decode(line["data"]))), topic


def test_what_is_sent_is_received_and_recorded_to_the_bit(talk: Talk) -> None:
    for topic_and_kind, data in talk.sent.items():
        assert set(talk.kept[topic_and_kind]) == {data}


def test_a_late_joiner_gets_what_was_said_once(talk: Talk) -> None:
    unchanged = {"/tf_static", "/robot_description"} | ({"/map"} if talk.role == "navigator" else set())
    assert {topic: len(talk.late[topic]) for topic in unchanged} == dict.fromkeys(unchanged, 1)
    assert talk.once - RARE <= {topic for topic, lines in talk.late.items() if lines}
    frames = {one["child_frame_id"] for one in talk.late["/tf_static"][0]["value"]["transforms"]}
    assert "base_footprint" in frames
    assert "<robot" in talk.late["/robot_description"][0]["value"]["data"]


def test_others_see_one_node_with_its_topics_types_and_qos(talk: Talk) -> None:
    graph = talk.graph
    assert "trundle" in graph["nodes"]
    assert {one["topic"]: [one["type"]] for one in talk.offered}.items() <= graph["publishers"].items()
    # Through rclpy, the second type of a topic is read by a second node.
    for topic in {topic for topic, _ in talk.sent}:
        assert set(graph["subscribers"][topic]) & {kind for to, kind in talk.sent if to == topic}
    for one in talk.offered:
        if one["topic"] == "/rosout":  # every node writes to it
            continue
        (seen,) = (info for info in graph["written"][one["topic"]] if info["node"] != "asking")
        kind = one["type"]
        assert (seen["type"], seen["hash"]) == (kind, f"RIHS01_{talk.hashes[kind]}")
        assert (seen["reliability"], seen["durability"]) == (one["reliability"], one["durability"])
    read = {(topic, info["type"]): info["hash"] for topic, _ in talk.sent for info in graph["read"][topic]}
    assert read == {(topic, kind): f"RIHS01_{talk.hashes[kind]}" for topic, kind in talk.sent}
