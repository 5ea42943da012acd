"""The simulator role with a real ROS on the other side, which drives it and controls its simulation."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from ros2.bridge.conftest import Served, wait_for
from ros2.conftest import JAZZY, Ros
from trundle.messages import Codec
from trundle.messages.codec import STAMPED_COMMANDS
from trundle.mission import Scenario
from trundle.ros2.bridge import Bridge
from trundle.ros2.names import Names
from trundle.ros2.transport.rclpy.relay import RclpyTransport
from trundle.ros2.types import Types

PEER = Path(__file__).parent / "peers" / "drives.py"
SUCCEEDED = 4


@pytest.fixture
def served(relay: RclpyTransport) -> Iterator[Served]:
    said: list[str] = []
    scenario = Scenario.make(world={"name": "lot"}, robot="nova_carter")
    bridge = Bridge(scenario, relay, Types(Codec(relay.distro), relay), Names(), report=said.append)
    running = Served(bridge, said)
    running.start()
    yield running
    running.close()


def test_a_ros_program_drives_and_controls_the_simulation(ros: Ros, served: Served) -> None:
    peer = ros.script(PEER, *(["--stamped"] if ros.distro in STAMPED_COMMANDS else []))
    assert peer.stdout is not None
    line = peer.stdout.readline()
    assert line, peer.communicate()[1]
    found = json.loads(line)
    assert found.pop("moving") == pytest.approx(0.4, abs=0.05)
    assert found.pop("sim_time") < 0.1
    assert found.pop("stepped") == pytest.approx(0.2, abs=1e-6)
    assert found.pop("placed") == pytest.approx([0.0, 0.0], abs=1e-6)
    assert found == {
        "scan": ["lidar_front", 720],
        "cloud": ["lidar_front", 1, 720, 14400],
        "static": ["base_footprint", "lidar_back", "lidar_front"],
        "urdf": True,
        "joints": ["joint_wheel_left", "joint_wheel_right"],
        "pause": 1,
        "step": 1,
        "state": 2,
        "features": 13,
        "entities": "nova_carter",
        "place": 1,
        "action": [SUCCEEDED, 1],
        "feedback": True,
        "reset": 1,
    }
    wait_for(lambda: served.bridge.context.session.state.twist.v > 0.3)
    peer.kill()
    wait_for(lambda: served.bridge.context.session.state.twist.v == pytest.approx(0.0, abs=0.01))
    wait_for(lambda: any("the robot stops" in text for text in served.said))


@pytest.mark.parametrize("distro", JAZZY)
def test_a_relay_that_is_killed_is_reported_and_started_again(served: Served) -> None:
    wait_for(lambda: served.bridge.context.clock.now > 0.0)
    transport = served.bridge.wire.transport
    before = transport.pid
    os.kill(before, signal.SIGKILL)
    wait_for(lambda: any("the other side is lost" in text for text in served.said))
    wait_for(lambda: "the other side is back" in served.said)
    assert transport.pid != before
    assert served.end().message == "the test is over"
