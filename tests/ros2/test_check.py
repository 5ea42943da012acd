import threading

import pytest

from ros2.fake_transport import FakeNetwork
from trundle.messages.codec import Codec
from trundle.messages.makers import MessageMaker
from trundle.messages.qos import CLOCK, SENSOR, Qos
from trundle.ros2 import check
from trundle.ros2.transport.domain import read_settings

CLOCK_TYPE = "rosgraph_msgs/msg/Clock"


@pytest.fixture
def network() -> FakeNetwork:
    return FakeNetwork()


@pytest.fixture
def can_use(monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """Why each transport cannot be used; both can, unless a test says otherwise."""
    reasons = {"dds": "", "rclpy": ""}
    monkeypatch.setattr(check, "why_not", lambda kind, **_: reasons[kind])
    return reasons


def tick(network: FakeNetwork, times: list[float], node: str = "sim") -> None:
    """Publish these times once somebody listens."""
    sim = network.transport(node)
    publisher = sim.publisher("/clock", CLOCK_TYPE, CLOCK)
    make = MessageMaker(Codec("jazzy"))

    def publish() -> None:
        while not publisher.matched:
            threading.Event().wait(0.001)
        for time in times:
            publisher.write(make.codec.encode(make.clock(time)))

    threading.Thread(target=publish, daemon=True).start()


def test_the_clock_is_watched(network: FakeNetwork) -> None:
    tick(network, [1.0, 1.5, 2.0])
    seen = check.watch_clock(network.transport("check"), 0.3)
    assert (seen.count, seen.first_s, seen.last_s, seen.went_back, seen.sources) == (3, 1.0, 2.0, False, 1)


def test_two_clocks_are_told_apart(network: FakeNetwork) -> None:
    tick(network, [1.0])
    tick(network, [9.0], "other")
    assert check.watch_clock(network.transport("check"), 0.3).sources == 2


def test_a_network_is_reported_with_what_to_do(network: FakeNetwork) -> None:
    tick(network, [1.0, 1.1])
    network.transport("amcl").subscription("/scan", "sensor_msgs/msg/LaserScan", SENSOR)
    robot = network.transport("robot")
    robot.publisher("/front/scan", "sensor_msgs/msg/LaserScan", SENSOR)
    found = {one.about: one for one in check.check_network(network.transport("trundle_check"), wait_s=0.2)}
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
    other = network.transport("odd")
    publisher = other.publisher("/clock", CLOCK_TYPE, Qos())
    subscriber = network.transport("check")
    threading.Timer(0.05, lambda: publisher.write(b"\x00\x01\x00\x00")).start()
    seen = check.watch_clock(subscriber, 0.2)
    assert (seen.count, seen.unreadable) == (0, 1)
