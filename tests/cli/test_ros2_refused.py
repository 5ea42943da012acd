"""What `trundle ros2` refuses, and what `trundle ros2 check` finds."""

import importlib.util
import sys

import pytest

from ros2.fake_transport import FakeNetwork
from support.command_line import Trundle
from trundle.errors import MissingExtraError
from trundle.extras import install_line
from trundle.messages.qos import SENSOR

ROBOT = ("--robot", "turtlebot3_burger", "--backend", "kinematic")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--speed", "0"), "--speed '0'"),
        (("--remap", "scan=lidar"), "FROM:=TO"),
        (("--remap", "1scan:=lidar"), "1scan"),
        (("--namespace", "robot-1"), "robot-1"),
        (("--domain", "233"), "--domain 233"),
        (("--domain", "1.5"), "--domain 1.5"),
        (("--range", "world"), "--range"),
        (("--profile", "turtlebot4"), "unknown profile 'turtlebot4'. Did you mean 'turtlebot3'?"),
        (("--profile", "my.yaml"), "my.yaml"),
        (("--role", "driver"), "--role"),
        (("--transport", "zenoh"), "--transport"),
        (("--distro", "iron"), "--distro"),
        (("-o", "wire.mcap"), "give --record with it"),
        (("--record", "-o", "wire.bag"), ".mcap"),
        (("--goal", "1,1"), "--goal is for --role navigator"),
        (("--role", "navigator", "--goal", "one"), "--goal"),
    ],
)
def test_what_cannot_be_served_is_named(
    trundle: Trundle, network: FakeNetwork, arguments: tuple[str, ...], message: str
) -> None:
    done = trundle("ros2", "serve", "office", *arguments)
    assert done.code == 2
    assert message in done.err
    assert not network.transports


def test_an_unknown_world_is_named_before_the_network_is_joined(trundle: Trundle, network: FakeNetwork) -> None:
    done = trundle("ros2", "serve", "ofice")
    assert done.code == 2
    assert "office" in done.err
    assert not network.transports


def test_without_the_extra_the_install_line_is_printed(
    trundle: Trundle, network: FakeNetwork, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise MissingExtraError("ROS 2", "cyclonedds", 'pip install "trundle[ros2]"')

    monkeypatch.setattr("trundle.ros2.transport.opening.open_transport", refuse)
    done = trundle("ros2", "serve", "office", *ROBOT)
    assert done.code == 2
    assert 'pip install "trundle[ros2]"' in done.err
    checked = trundle("ros2", "check", "--wait", "0.1", "--json")
    assert checked.code == 1
    assert any('pip install "trundle[ros2]"' in one["detail"] for one in checked.json["findings"])


@pytest.mark.parametrize("verb", ["serve", "check"])
def test_without_the_messages_the_install_line_is_printed(
    trundle: Trundle, network: FakeNetwork, monkeypatch: pytest.MonkeyPatch, verb: str
) -> None:
    found = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == "rosbags" else found(name))
    done = trundle("ros2", verb)
    assert done.code == 2
    assert install_line("ros2") in done.err


def test_without_the_libraries_of_recordings_the_install_line_is_printed(
    trundle: Trundle, network: FakeNetwork, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [name for name in sys.modules if name.startswith(("trundle.bags", "trundle.ros2.record"))]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "zstandard", None)
    done = trundle("ros2", "serve", "office", *ROBOT, "--record")
    assert done.code == 2
    assert "zstandard" in done.err
    assert install_line("record") in done.err


def test_check_reports_a_network_without_problems(trundle: Trundle, network: FakeNetwork) -> None:
    network.transport("rviz")
    done = trundle("ros2", "check", "--wait", "0.1")
    assert done.code == 0, done.out
    assert "1: /rviz" in done.out
    assert not network.transports[1:]


def test_check_has_exit_code_1_and_advice_for_a_problem(trundle: Trundle, network: FakeNetwork) -> None:
    network.transport("amcl").subscription("/scan", "sensor_msgs/msg/LaserScan", SENSOR)
    done = trundle("ros2", "check", "--wait", "0.1", "--json")
    assert done.code == 1
    assert not done.json["passed"]
    (problem,) = (one for one in done.json["findings"] if one["status"] == "problem")
    assert (problem["about"], bool(problem["advice"])) == ("/scan", True)
    quiet = trundle("ros2", "check", "--wait", "0.1", "--quiet")
    assert quiet.code == 1
    assert [line.split()[0] for line in quiet.out.splitlines()] == ["problem", "->"]


@pytest.mark.parametrize("wait", ["0", "-1", "nan", "1e9"])
def test_a_check_listens_for_a_sensible_time(trundle: Trundle, network: FakeNetwork, wait: str) -> None:
    done = trundle("ros2", "check", "--wait", wait)
    assert done.code == 2
    assert "--wait" in done.err
