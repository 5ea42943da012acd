"""The transport with a child that misbehaves, dies, or is of another distribution."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from trundle.errors import InputError, TransportError
from trundle.messages import Qos
from trundle.ros2.transport.domain import Settings
from trundle.ros2.transport.rclpy import link
from trundle.ros2.transport.rclpy.relay import RclpyTransport, open_rclpy

StandIn = Callable[[str], str]
LATCHED = Qos(1, durability="transient_local")


def is_alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def wait_until_lost(transport: RclpyTransport) -> str:
    for _ in range(200):
        if transport.lost:
            return transport.lost
        transport.wait(0.1)
    raise AssertionError("the transport was not lost")


def open_stand_in(python: str, settings: Settings | None = None, **options: Any) -> RclpyTransport:
    return open_rclpy(settings or Settings(domain=7), python=python, **{"retry_s": (), **options})


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("send(child.REFUSED, 0, b'ImportError: no librcl')", "ImportError: no librcl"),
        ("print('Fatal: cannot do it', flush=True); sys.exit(4)", "it ended with code 4: Fatal: cannot do it"),
        ("os.kill(os.getpid(), 11)", "SIGSEGV killed it"),
        ("send(child.HELLO, 0, b'{')", "what it sent cannot be read"),
    ],
)
def test_a_child_that_cannot_start_is_reported_with_its_reason(
    stand_in: StandIn, text: str, reason: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(link, "_END_S", 60.0)
    python = stand_in(text)
    with pytest.raises(TransportError, match="no Python here imports rclpy") as caught:
        open_stand_in(python)
    assert f"{python}: {reason}" in str(caught.value)


def test_a_program_that_is_not_there_is_reported(tmp_path: Path) -> None:
    with pytest.raises(TransportError, match="cannot be started: No such file"):
        open_stand_in(str(tmp_path / "python3"))


def test_it_speaks_the_distribution_of_the_ros_that_it_found(stand_in: StandIn) -> None:
    transport = open_stand_in(stand_in("hello('kilted')\nfor _ in frames: pass"))
    assert (transport.distro, transport.rmw, transport.notes) == ("kilted", "rmw_x_cpp", ())
    assert (transport.name, transport.has_services, transport.node) == ("rclpy", True, "/trundle")
    transport.close()
    transport = open_stand_in(stand_in("hello('rolling')\nfor _ in frames: pass"))
    assert transport.distro == "lyrical"
    assert "is rolling: treated as lyrical" in transport.notes[0]
    transport.close()


def test_a_distribution_that_was_given_must_be_that_of_the_ros(stand_in: StandIn) -> None:
    given = Settings(distro="humble", given=frozenset({"distro"}))
    with pytest.raises(InputError, match="is kilted, not humble: leave --distro out"):
        open_stand_in(stand_in("hello('kilted')\nfor _ in frames: pass"), given)


def test_domain_and_range_reach_the_child(stand_in: StandIn, tmp_path: Path) -> None:
    seen = tmp_path / "seen.json"
    text = (
        f"open({str(seen)!r}, 'w').write(json.dumps([dict(os.environ), sys.argv[4]]))\nhello()\nfor _ in frames: pass"
    )
    open_rclpy(Settings(domain=42, range="subnet"), node="bot", namespace="/a", python=stand_in(text)).close()
    environ, options = json.loads(seen.read_text())
    assert environ["ROS_DOMAIN_ID"] == "42"
    assert json.loads(options) == {"node": "bot", "namespace": "/a", "range": "subnet"}


def test_what_the_child_refuses_is_an_error_at_the_call(stand_in: StandIn) -> None:
    refuse = 'kind, number, _ = next(frames)\nsend(child.REPLY, number, b\'{"error": "this ROS has no nav2_msgs"}\')\n'
    transport = open_stand_in(stand_in("hello()\n" + 2 * refuse + "for _ in frames: pass"))
    with pytest.raises(InputError, match="this ROS has no nav2_msgs"):
        transport.publisher("/costmap", "nav2_msgs/msg/Costmap", Qos())
    assert transport.definition("nav2_msgs/msg/Costmap") == ""
    transport.close()


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("sock.sendall(child.HEADER.pack(2**31, child.SAMPLE, 1))", "a frame of 2147483648 bytes"),
        ("send(99, 0, b'')", "a frame of kind 99"),
        ("send(child.SAMPLE, 777, b'\\0')", "what it sent cannot be read"),
        ("send(child.SAMPLE, 1, b'')", "what it sent cannot be read"),
        ("send(child.COUNTS, 0, b'[]')", "what it sent cannot be read"),
        ("send(child.REPLY, 1, b'no json')\nsend(99, 0, b'')", "what it sent cannot be read"),
        ("sock.sendall(child.HEADER.pack(9, child.SAMPLE, 1) + b'1234'); sys.exit(3)", "it ended with code 3"),
        ("os.kill(os.getpid(), 9)", "SIGKILL killed it"),
        ("sock.shutdown(socket.SHUT_RDWR); time.sleep(60)", "it closed its socket"),
    ],
)
def test_whatever_a_child_does_the_transport_is_lost_and_says_why(
    stand_in: StandIn, text: str, reason: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Why a child ends is known once it has ended; one that only closes its socket is not waited for.
    monkeypatch.setattr(link, "_END_S", 0.5 if "socket" in reason else 60.0)
    transport = open_stand_in(stand_in("hello()\nanswer()\n" + text + "\nfor _ in frames: pass"))
    subscription = transport.subscription("/cmd_vel", "geometry_msgs/msg/Twist", Qos())
    pid = transport.pid
    lost = wait_until_lost(transport)
    assert "the ROS side of the bridge" in lost
    assert reason in lost
    with pytest.raises(TransportError, match=reason):
        transport.graph()
    assert subscription.take() == []
    transport.dispatch()
    transport.close()
    assert not is_alive(pid)


def test_the_last_of_what_is_latched_is_sent_again_to_a_new_child(stand_in: StandIn, tmp_path: Path) -> None:
    seen = tmp_path / "seen"
    text = f"""
hello()
made = [answer(), answer()]
got = [payload for _, (_, _, payload) in zip(range(1), frames)]
with open({str(seen)!r}, "a") as file:
    file.write(json.dumps([made, got[0].decode()]) + "\\n")
os.kill(os.getpid(), 9)
"""
    transport = open_stand_in(stand_in(text))
    publisher = transport.publisher("/map", "nav_msgs/msg/OccupancyGrid", LATCHED)
    transport.service("/stop", "std_srvs/srv/Trigger", lambda request: request)
    publisher.write(b"map")
    wait_until_lost(transport)
    publisher.write(b"newer map")
    transport.restart()
    wait_until_lost(transport)
    transport.close()
    first, second = (json.loads(line) for line in seen.read_text().splitlines())
    assert first[0] == second[0]
    assert [made["do"] for made in first[0]] == ["publisher", "service"]
    assert (first[1], second[1]) == ("map", "newer map")
    with pytest.raises(TransportError, match="was closed"):
        transport.restart()


def test_a_lost_child_is_started_again_until_it_works(stand_in: StandIn, tmp_path: Path) -> None:
    starts = tmp_path / "starts"
    text = f"""
with open({str(starts)!r}, "a+") as file:
    file.write("x")
    file.seek(0)
    start = len(file.read())
if start == 2:
    sys.exit("not yet")
hello()
answer()
send(child.COUNTS, 0, json.dumps({{"publishers": {{"1": start}}, "subscriptions": {{}}, "dropped": {{}}}}).encode())
if start == 1:
    os.kill(os.getpid(), 9)
for _ in frames: pass
"""
    transport = open_stand_in(stand_in(text), retry_s=(0.2, 0.0))
    publisher = transport.publisher("/clock", "rosgraph_msgs/msg/Clock", Qos())
    lost = wait_until_lost(transport)
    assert "SIGKILL killed it" in lost
    while publisher.matched != 3 or transport.lost:
        assert not transport.lost or transport.lost == lost
        transport.wait(0.05)
    assert len(starts.read_text()) == 3
    transport.close()
    assert not is_alive(transport.pid)


def test_closing_does_not_wait_for_a_child_that_is_being_started_again(stand_in: StandIn, tmp_path: Path) -> None:
    mark = tmp_path / "mark"
    text = f"""
if os.path.exists({str(mark)!r}):
    for _ in frames: pass  # never says hello
open({str(mark)!r}, "w").close()
hello()
sys.exit(0)
"""
    transport = open_stand_in(stand_in(text), retry_s=(0.0,))
    first = transport.pid
    while transport.pid == first:
        transport.wait(0.01)
    transport.close()
    assert not is_alive(transport.pid)


def test_requests_are_answered_in_dispatch_and_a_handler_that_fails_is_answered_too(
    stand_in: StandIn, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    seen = tmp_path / "seen"
    text = f"""
hello()
answer(); answer()
send(child.REQUEST, 51, child.NUMBER.pack(1) + b"good")
send(child.REQUEST, 52, child.NUMBER.pack(1) + b"bad")
send(child.GOAL, 53, child.NUMBER.pack(2) + b"goal")
send(child.STARTED, 7, child.NUMBER.pack(2) + bytes(range(16)) + b"goal")
send(child.CANCEL, 54, child.NUMBER.pack(7))
got = [[number, payload.decode("latin-1")] for _, (_, number, payload) in zip(range(6), frames)]
open({str(seen)!r}, "w").write(json.dumps(got))
for _ in frames: pass
"""
    goals = []

    class Spin:
        def accepts(self, data: bytes) -> bool:
            return data == b"goal"

        def accepted(self, goal) -> None:
            goals.append(goal)
            goal.publish_feedback(b"half")

        def cancel(self, goal) -> bool:
            return True

    def handle(request: bytes) -> bytes:
        if request == b"bad":
            raise ValueError("a bug in a handler")
        return request * 2

    transport = open_stand_in(stand_in(text))
    transport.service("/stop", "std_srvs/srv/Trigger", handle)
    transport.action("/spin", "nav2_msgs/action/Spin", Spin())
    while not (goals and goals[0].cancel_requested):
        assert not transport.lost
        transport.wait(1.0)
        transport.dispatch()
    assert (goals[0].id, goals[0].data) == (bytes(range(16)), b"goal")
    goals[0].canceled(b"result")
    goals[0].succeed(b"too late")
    goals[0].publish_feedback(b"too late")
    transport.close()
    assert json.loads(seen.read_text()) == [
        [51, "\1goodgood"],
        [52, "\0"],
        [53, "\1"],
        [7, "half"],
        [54, "\1"],
        [7, "\2result"],
    ]
    assert "a bug in a handler" in caplog.text


def test_a_flood_is_bounded_and_counted(stand_in: StandIn) -> None:
    samples = "for n in range(1000): send(child.SAMPLE, 1, b'\\2ab%d' % n)"
    flood = f"hello()\nanswer()\n{samples}\nanswer('text')\nfor _ in frames: pass"
    transport = open_stand_in(stand_in(flood))
    subscription = transport.subscription("/cmd_vel", "geometry_msgs/msg/Twist", Qos(5))
    transport.definition("std_msgs/msg/String")  # is answered after the flood
    samples = subscription.take()
    assert [sample.source for sample in samples] == ["ab"] * 32
    assert samples[-1].data == b"999"
    assert subscription.dropped == 1000 - 32
    transport.close()


def test_a_child_that_does_not_leave_is_killed(stand_in: StandIn) -> None:
    stubborn = "signal.signal(15, signal.SIG_IGN)\nhello()\nwhile True: time.sleep(1)"
    transport = open_stand_in(stand_in(stubborn))
    pid = transport.pid
    transport.close()
    assert not is_alive(pid)
    transport.close()


def test_closing_ends_where_ctrl_c_has_left_a_lock_held(stand_in: StandIn) -> None:
    transport = open_stand_in(stand_in("hello()\nfor _ in frames: pass"))
    pid, lock = transport.pid, transport._link.outbox._changed
    lock.acquire()
    transport.close()
    assert not is_alive(pid)
    lock.release()
