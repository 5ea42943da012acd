from collections.abc import Callable

import pytest

from ros2.fake_transport import FakeNetwork, FakeTransport
from trundle.messages.codec import Codec
from trundle.messages.makers import MessageMaker
from trundle.messages.qos import CLOCK, SENSOR, Qos
from trundle.ros2 import check
from trundle.ros2.transport.domain import read_settings

CLOCK_TYPE = "rosgraph_msgs/msg/Clock"
WAIT_S = 0.2


@pytest.fixture
def network() -> FakeNetwork:
    return FakeNetwork()


@pytest.fixture
def can_use(monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """Why each transport cannot be used; both can, unless a test says otherwise."""
    reasons = {"dds": "", "rclpy": ""}
    monkeypatch.setattr(check, "why_not", lambda kind, **_: reasons[kind])
    return reasons


def ticks(network: FakeNetwork, times: list[float], node: str = "sim") -> Callable[[], None]:
    """Publishes these times when it is called."""
    publisher = network.transport(node).publisher("/clock", CLOCK_TYPE, CLOCK)
    make = MessageMaker(Codec("jazzy"))
    messages = [make.codec.encode(make.clock(time)) for time in times]

    def publish() -> None:
        for message in messages:
            publisher.write(message)

    return publish


def listener(network: FakeNetwork, *others: Callable[[], None], node: str = "check") -> FakeTransport:
    """A node to which others speak once it waits: no earlier, and at once however busy the machine is."""
    transport = network.transport(node)
    wait, waiting = transport.wait, list(others)

    def speak_and_wait(timeout_s: float) -> bool:
        while waiting:
            waiting.pop(0)()
        return wait(timeout_s)

    transport.wait = speak_and_wait
    return transport


def test_the_clock_is_watched(network: FakeNetwork) -> None:
    seen = check.watch_clock(listener(network, ticks(network, [1.0, 1.5, 2.0])), WAIT_S)
    assert (seen.count, seen.first_s, seen.last_s, seen.went_back, seen.sources) == (3, 1.0, 2.0, False, 1)


def test_two_clocks_are_told_apart(network: FakeNetwork) -> None:
    node = listener(network, ticks(network, [1.0]), ticks(network, [9.0], "other"))
    assert check.watch_clock(node, WAIT_S).sources == 2


def test_a_network_is_reported_with_what_to_do(network: FakeNetwork) -> None:
    network.transport("amcl").subscription("/scan", "sensor_msgs/msg/LaserScan", SENSOR)
    robot = network.transport("robot")
    robot.publisher("/front/scan", "sensor_msgs/msg/LaserScan", SENSOR)
    node = listener(network, ticks(network, [1.0, 1.1]), node="trundle_check")
    found = {one.about: one for one in check.check_network(node, wait_s=WAIT_S)}
    assert found["transport"].detail == "rclpy (rmw_in_memory), node /trundle_check"
    assert found["nodes"].detail == "3: /amcl, /robot, /sim"
    assert found["clock"].status == "ok"
    assert found["/scan"].status == "problem"
    assert "front/scan:=/scan" in found["/scan"].advice


def test_a_lost_transport_ends_the_report(network: FakeNetwork) -> None:
    transport = network.transport("check")
    transport.lost = "its process was killed"
    *_, last = check.check_network(transport, wait_s=5.0)
    assert (last.status, last.detail) == ("problem", "its process was killed")


def test_the_setting_says_where_it_is_from(can_use: dict[str, str]) -> None:
    settings = read_settings(domain=None, distro="kilted", environ={"ROS_DOMAIN_ID": "7"})
    found = {one.about: one for one in check.check_setup(settings)}
    assert found["domain"].detail == "7 (from ROS_DOMAIN_ID)"
    assert found["distribution"].detail == "kilted (--distro)"
    assert found["range"].detail == "localhost"
    assert found["environment"].detail == "ROS_DOMAIN_ID=7"
    assert found["rclpy"].status == found["dds"].status == "ok"


def test_what_the_environment_asks_for_and_does_not_get_is_a_note(can_use: dict[str, str]) -> None:
    settings = read_settings(environ={"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"})
    notes = [one.detail for one in check.check_setup(settings) if one.status == "note"]
    assert len(notes) == 1
    assert "--range subnet" in notes[0]


def test_a_transport_that_cannot_be_used_has_its_reason(can_use: dict[str, str]) -> None:
    can_use["rclpy"] = "no Python here imports rclpy"
    found = {one.about: one for one in check.check_setup(read_settings(environ={}))}
    assert (found["rclpy"].status, found["rclpy"].detail) == ("note", "no Python here imports rclpy")


def test_bytes_that_are_no_time_are_counted(network: FakeNetwork) -> None:
    publisher = network.transport("odd").publisher("/clock", CLOCK_TYPE, Qos())
    node = listener(network, lambda: publisher.write(b"\x00\x01\x00\x00"))
    seen = check.watch_clock(node, WAIT_S)
    assert (seen.count, seen.unreadable) == (0, 1)
