"""The transport with a real ROS on the other side."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ros2.conftest import JAZZY, KILTED, Ros
from support.processes import is_alive
from trundle.errors import InputError
from trundle.messages import Codec, Qos
from trundle.ros2.transport.rclpy.relay import RclpyTransport
from trundle.ros2.types import Types

HERE = Path(__file__).parent
PEERS = HERE / "peers"
LATCHED = Qos(1, durability="transient_local")
RESULT = "test_msgs/action/Fibonacci_Result"
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
PATIENCE_S = 120.0


@pytest.fixture
def transport(relay: RclpyTransport) -> RclpyTransport:
    return relay


@pytest.fixture
def types(transport: RclpyTransport) -> Types:
    return Types(Codec(transport.distro), transport)


def wait_for(transport: RclpyTransport, is_done: Callable[[], object]) -> None:
    until = time.monotonic() + PATIENCE_S
    while not is_done():
        assert time.monotonic() < until, "it did not happen"
        transport.wait(0.02)
        transport.dispatch()


def tell(peer: subprocess.Popen[str], *command: object) -> None:
    assert peer.stdin is not None
    peer.stdin.write(json.dumps(command) + "\n")
    peer.stdin.flush()


def read(peer: subprocess.Popen[str]) -> dict[str, Any]:
    assert peer.stdout is not None
    assert peer.stderr is not None
    line = peer.stdout.readline()
    assert line, peer.stderr.read()
    return json.loads(line)


def test_topics_go_both_ways_to_the_bit(ros: Ros, transport: RclpyTransport, types: Types) -> None:
    scan_type = "sensor_msgs/msg/LaserScan"
    scans = transport.publisher("/scan", scan_type, Qos(5, "best_effort"))
    maps = transport.publisher("/map", "nav_msgs/msg/OccupancyGrid", LATCHED)
    echoes = transport.subscription("/echo", scan_type, Qos())
    plain = transport.subscription("/cmd_vel", "geometry_msgs/msg/Twist", Qos(50))
    stamped = transport.subscription("/cmd_vel", "geometry_msgs/msg/TwistStamped", Qos(50))
    data = np.array([-1, 0, 100, 0, 5, 6], np.int8)
    info = types.make("nav_msgs/msg/MapMetaData", width=3, height=2)
    maps.write(types.encode(types.make("nav_msgs/msg/OccupancyGrid", info=info, data=data)))
    peer = ros.script(PEERS / "topics.py", 40)
    first, second = read(peer), read(peer)
    assert {**first, **second} == {"map": [3, 2, data.tolist()], "sent": True}
    wait_for(transport, lambda: scans.matched == 2 and echoes.matched == 1)
    ranges = [0.5, float("inf"), 1.25]
    scan = types.encode(types.make(scan_type, ranges=ranges, angle_min=-0.1))
    scans.write(scan)
    assert read(peer) == {"scan": ranges}
    got: dict[str, list[Any]] = {"echo": [], "plain": [], "stamped": []}

    def take() -> bool:
        got["echo"] += echoes.take()
        got["plain"] += plain.take()
        got["stamped"] += stamped.take()
        return len(got["echo"]) >= 1 and len(got["plain"]) >= 40 and len(got["stamped"]) >= 40

    wait_for(transport, take)
    assert [sample.data for sample in got["echo"]] == [scan]
    twists = [types.decode("geometry_msgs/msg/Twist", sample.data) for sample in got["plain"]]
    assert [twist.linear.x for twist in twists] == list(range(40))
    others = [types.decode("geometry_msgs/msg/TwistStamped", sample.data) for sample in got["stamped"]]
    assert [other.twist.linear.x for other in others] == list(range(40))
    sources = {sample.source for sample in got["plain"]}
    (publisher,) = (end for end in transport.graph().publishers("/cmd_vel") if end.type_name.endswith("Twist"))
    assert sources == ({publisher.source} if ros.distro == "kilted" else {""})
    assert (publisher.node, publisher.ours) == ("/robots/peer", False)


def test_another_node_of_the_same_name_is_not_ours(ros: Ros, transport: RclpyTransport) -> None:
    other = RclpyTransport(ros.python, transport.settings, "trundle", "")
    try:
        for node in (transport, other):
            node.publisher("/clock", "rosgraph_msgs/msg/Clock", Qos())
        for node in (transport, other):
            wait_for(node, lambda node=node: [one.node for one in node.endpoints("/clock")] == 2 * ["/trundle"])
            assert sorted(one.ours for one in node.endpoints("/clock")) == [False, True]
    finally:
        other.close()


def test_the_graph_and_the_types_are_those_of_ros(ros: Ros, transport: RclpyTransport, types: Types) -> None:
    names = [
        *("Arrays", "BoundedPlainSequences", "Constants", "Defaults", "Empty", "MultiNested", "Nested", "Strings"),
        *("UnboundedSequences", "BoundedSequences"),
    ]
    types_there = [f"test_msgs/msg/{name}" for name in names]
    known = ["nav_msgs/msg/Path", "sensor_msgs/msg/PointCloud2", "tf2_msgs/msg/TFMessage"]
    ros.script(PEERS / "types.py", *types_there, *known)
    mine = transport.publisher("/mine", "std_msgs/msg/String", Qos(3, "best_effort"))
    own = transport.subscription("/mine", "std_msgs/msg/String", Qos(3, "best_effort"))
    also = transport.subscription("/mine", "std_msgs/msg/String", Qos(3))
    messages: dict[str, Any] = {}
    for number, name in enumerate([*types_there, *known]):
        topic = f"/topic_{number}"
        subscription = transport.subscription(topic, name, LATCHED)
        samples = []
        wait_for(transport, lambda s=subscription, into=samples: into.extend(s.take()) or into)
        (publisher,) = transport.graph().publishers(topic)
        assert (publisher.type_name, publisher.node, publisher.ours) == (name, "/types", False)
        assert publisher.type_hash == types.type_hash(name)
        assert publisher.qos.durability == "transient_local"
        (sample,) = samples
        messages[name] = types.decode(name, sample.data)
        again = types.encode(messages[name])
        assert len(sample.data) - 4 < len(again) <= len(sample.data)  # ROS fills up to a multiple of 4
        assert repr(types.decode(name, again)) == repr(messages[name])
    defaults = messages["test_msgs/msg/Defaults"]
    assert (defaults.bool_value, defaults.float64_value, defaults.uint64_value) == (True, 1.125, 50000000)
    assert messages["test_msgs/msg/Strings"].string_value_default5 == 'Hello"world!'
    assert types.constant("test_msgs/msg/Constants", "UINT16_CONST") == 2000
    graph = transport.graph()
    assert {"/trundle", "/types"} <= set(graph.nodes)
    (writer,) = graph.publishers("/mine")
    assert (writer.node, writer.ours, writer.qos.reliability) == ("/trundle", True, "best_effort")
    assert set(transport.endpoints("/mine")) == {one for one in graph.endpoints if one.topic == "/mine"}
    wait_for(transport, lambda: own.matched == 1)
    assert (mine.matched, also.matched) == (0, 0)  # a node does not count what it reads itself
    with pytest.raises(InputError, match="nav_msgs of this ROS has no Nothing"):
        transport.publisher("/nothing", "nav_msgs/msg/Nothing", Qos())
    with pytest.raises(InputError, match=r"this ROS has no nope_msgs .*: apt install ros-"):
        transport.publisher("/nothing", "nope_msgs/msg/Nothing", Qos())
    with pytest.raises(InputError, match="topic name"):
        transport.publisher("/no blanks", "std_msgs/msg/String", Qos())


class Count:
    """Has feedback of every number up to the goal, if that is below 50; 90 is refused. A new goal ends the last."""

    def __init__(self, types: Types) -> None:
        self.types = types
        self.goals: list[Any] = []

    def encode(self, name: str, numbers: list[int]) -> bytes:
        return self.types.encode(self.types.make(f"test_msgs/action/Fibonacci_{name}", sequence=numbers))

    def order(self, data: bytes) -> int:
        return self.types.decode("test_msgs/action/Fibonacci_Goal", data).order

    def accepts(self, data: bytes) -> bool:
        return self.order(data) != 90

    def accepted(self, goal: Any) -> None:
        if self.goals:
            self.goals[-1].abort(self.encode("Result", [7]))
        self.goals.append(goal)
        order = self.order(goal.data)
        if order < 50:
            for number in range(order):
                goal.publish_feedback(self.encode("Feedback", [number]))

    def cancel(self, goal: Any) -> bool:
        return self.order(goal.data) != 60


def serve(transport: RclpyTransport, types: Types) -> Count:
    def answer(request: bytes) -> bytes:
        flag = types.decode("std_srvs/srv/SetBool_Request", request).data
        return types.encode(types.make("std_srvs/srv/SetBool_Response", success=flag, message=f"it is {flag}"))

    count = Count(types)
    transport.service("/set", "std_srvs/srv/SetBool", answer)
    transport.action("/count", "test_msgs/action/Fibonacci", count)
    return count


def ask(transport: RclpyTransport, peer: subprocess.Popen[str], *command: object) -> dict[str, Any]:
    """Have the client do something, and serve it meanwhile."""
    tell(peer, *command)
    assert peer.stdout is not None
    os.set_blocking(peer.stdout.fileno(), False)
    line = ""

    def has_answered() -> bool:
        nonlocal line
        line += peer.stdout.readline()  # pyright: ignore[reportOptionalMemberAccess]
        return line.endswith("\n")

    wait_for(transport, has_answered)
    return json.loads(line)


def send(transport: RclpyTransport, peer: subprocess.Popen[str], count: Count, order: int) -> None:
    """Have the client send a goal, and wait until the server has it: its client may hear of it first."""
    before = len(count.goals)
    assert ask(transport, peer, "send", order) == {"accepted": True}
    wait_for(transport, lambda: len(count.goals) > before)


def test_services_and_every_end_of_a_goal(ros: Ros, transport: RclpyTransport, types: Types) -> None:
    count = serve(transport, types)
    peer = ros.script(PEERS / "client.py")
    assert ask(transport, peer, "ready") == {"ready": [True, True]}
    assert ask(transport, peer, "call", True) == {"call": [True, "it is True"]}
    assert ask(transport, peer, "call", False) == {"call": [False, "it is False"]}
    send(transport, peer, count, 3)
    assert ask(transport, peer, "feedback", 3) == {"feedback": [[0], [1], [2]]}
    count.goals[-1].succeed(count.encode("Result", [0, 1, 2]))
    assert ask(transport, peer, "end", 0) == {"end": [SUCCEEDED, [0, 1, 2]]}
    assert ask(transport, peer, "send", 90) == {"accepted": False}
    # A goal that may not be canceled, ended by the next; and that one, canceled.
    send(transport, peer, count, 60)
    assert ask(transport, peer, "cancel", 1) == {"canceling": 0}
    send(transport, peer, count, 70)
    assert ask(transport, peer, "end", 1) == {"end": [ABORTED, [7]]}
    assert ask(transport, peer, "cancel", 2) == {"canceling": 1}
    assert count.goals[-1].cancel_requested
    count.goals[-1].canceled(count.encode("Result", [8]))
    assert ask(transport, peer, "end", 2) == {"end": [CANCELED, [8]]}
    # Ended as canceled though nobody asked for it: aborted, as in ROS.
    send(transport, peer, count, 71)
    count.goals[-1].canceled(count.encode("Result", [9]))
    assert ask(transport, peer, "end", 3) == {"end": [ABORTED, [9]]}
    offers = {(offer.kind, offer.name): offer for offer in transport.graph().offers}
    assert offers["action server", "/count"].type_name == "test_msgs/action/Fibonacci"
    assert offers["service server", "/set"].ours
    assert not offers["service client", "/set"].ours
    # The server leaves midway.
    send(transport, peer, count, 72)
    pid = transport.pid
    transport.close()
    assert not is_alive(pid)
    assert ask(transport, peer, "end", 4) == {"end": [ABORTED, []]}
    assert ask(transport, peer, "gone") == {"gone": True, "done": True}


@pytest.mark.parametrize("distro", KILTED)
def test_a_killed_child_is_started_again_and_a_terminated_one_tells_its_clients(
    ros: Ros, transport: RclpyTransport, types: Types
) -> None:
    count = serve(transport, types)
    peer = ros.script(PEERS / "client.py")
    assert ask(transport, peer, "ready") == {"ready": [True, True]}
    send(transport, peer, count, 70)
    pid = transport.pid
    os.kill(pid, signal.SIGKILL)
    wait_for(transport, lambda: transport.lost)
    assert "SIGKILL killed it" in transport.lost
    assert not is_alive(pid)
    count.goals.clear()
    wait_for(transport, lambda: not transport.lost)
    assert transport.pid != pid
    assert ask(transport, peer, "call", True) == {"call": [True, "it is True"]}
    send(transport, peer, count, 71)
    os.kill(transport.pid, signal.SIGTERM)
    wait_for(transport, lambda: transport.lost)
    assert "it ended with code 0" in transport.lost
    assert ask(transport, peer, "end", 1) == {"end": [ABORTED, []]}


@pytest.mark.parametrize("distro", JAZZY)
def test_no_child_outlives_a_trundle_that_is_killed_and_clients_hear_of_it(ros: Ros) -> None:
    environ = {**os.environ, **ros.env}
    command = [sys.executable, str(HERE / "owner.py"), ros.python]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environ) as owner:
        assert owner.stdout is not None
        child_pid, owner_pid = map(int, owner.stdout.readline().split())
        peer = ros.script(PEERS / "client.py")
        tell(peer, "ready")
        assert read(peer) == {"ready": [True, True]}
        tell(peer, "send", 70)
        assert read(peer) == {"accepted": True}
        assert owner.stdout.readline() == "accepted\n"
        os.kill(owner_pid, signal.SIGKILL)
    until = time.monotonic() + PATIENCE_S
    while is_alive(child_pid):
        assert time.monotonic() < until
        time.sleep(0.01)
    tell(peer, "end", 0)
    assert read(peer) == {"end": [ABORTED, []]}
    tell(peer, "gone")
    assert read(peer) == {"gone": True, "done": True}
