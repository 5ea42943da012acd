"""Scripts for Nav2, in a real ROS 2, use trundle."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from ros2.conftest import JAZZY, KILTED, Ros
from ros2.lines import QUICK_S, Lines
from ros2.navigator_role.conftest import Served, make_scenario, wait_for
from trundle.messages import Codec
from trundle.ros2.bridge import Bridge
from trundle.ros2.names import Names
from trundle.ros2.transport.rclpy.relay import RclpyTransport
from trundle.ros2.types import Types

HERE = Path(__file__).parent
STAND_IN, SCRIPTS = HERE / "stand_in", HERE / "scripts"
SUCCEEDED, ABORTED = 4, 6


@pytest.fixture
def served(relay: RclpyTransport, room_file: str) -> Iterator[Served]:
    """A bridge on the network of a real ROS."""
    said: list[str] = []
    bridge = Bridge(
        make_scenario(room_file),
        relay,
        Types(Codec(relay.distro), relay),
        Names(),
        role="navigator",
        speed=5.0,
        report=said.append,
    )
    running = Served(bridge, said)
    yield running
    running.close()


def run_script(ros: Ros, script: Path, *args: str) -> list[dict[str, Any]]:
    lines = Lines(ros.script(script, *args, PYTHONPATH=str(STAND_IN)))
    said = lines.rest()
    assert lines.process.wait(QUICK_S) == 0, "".join([*said, *lines.errors])
    return [json.loads(line) for line in said if line.startswith("{")]


@pytest.mark.parametrize("distro", JAZZY)
def test_a_script_for_nav2_runs_unchanged(ros: Ros, served: Served) -> None:
    said = {line.pop("what"): line for line in run_script(ros, SCRIPTS / "commander.py")}
    assert said["path"]["poses"] > 50
    assert said["path"]["ends"] == pytest.approx([1.5, 4.5], abs=0.05)
    assert said["wall path"] == {"none": True}
    assert said["path through"]["poses"] > said["path"]["poses"]
    assert said["go"] == {"accepted": True}
    assert 0.0 < said["feedback"]["left"] < 4.0
    assert said["feedback"]["frame"] == "map"
    assert said["cancelled"]["result"] == "CANCELED"
    assert said["arrived"]["result"] == "SUCCEEDED"
    assert said["arrived"]["at"] == pytest.approx([1.5, 4.5], abs=0.35)
    assert (said["preempted"]["result"], said["preempted"]["first"]) == ("SUCCEEDED", ABORTED)
    assert said["wall"] == {"result": "FAILED", "code": 206}
    for done in ("through", "followed", "spun", "backed up", "driven"):
        assert said[done]["result"] == "SUCCEEDED", done
    assert said["spun"]["turned"] == pytest.approx(1.57, abs=0.15)
    assert said["backed up"]["driven"] == pytest.approx(0.3, abs=0.05)
    assert said["costmaps"] == {"cells": 160 * 120, "size": 160 * 120, "local": 60 * 60}
    assert said["map"] == {"changed": False}
    assert said["teleop"]["result"] == "FAILED"  # as in Nav2, where its time is over
    assert said["dock"]["result"] in ("FAILED", "REJECTED")
    assert said["waypoints"]["result"] == "SUCCEEDED"
    assert said["smooth"]["poses"] > 50
    assert said["shut down"] == {"accepted": False}
    assert {"dock_robot: refused", "load_map: RESULT_MAP_DOES_NOT_EXIST"} <= set(served.counts)


@pytest.mark.parametrize("distro", KILTED)
def test_a_navigator_that_goes_away_stands_and_comes_back(ros: Ros, served: Served) -> None:
    script = ros.script(SCRIPTS / "survivor.py")
    lines = Lines(script)
    assert lines.next() == {"accepted": True}
    wait_for(lambda: served.goals)
    os.kill(served.bridge.wire.transport.pid, signal.SIGKILL)  # pyright: ignore[reportAttributeAccessIssue]
    wait_for(lambda: served.goals == ())
    assert any("lost" in line for line in served.said)
    wait_for(lambda: any("back" in line for line in served.said))
    assert script.stdin is not None
    script.stdin.write("go on\n")
    script.stdin.flush()
    assert lines.next() == {"done": False}
    assert lines.next() == {"status": SUCCEEDED}


@pytest.mark.filterwarnings("ignore:the estimate was corrected by 5.0 m")
@pytest.mark.parametrize("distro", JAZZY)
def test_the_localizer_is_used_as_amcl_is(ros: Ros, relay: RclpyTransport, room_file: str) -> None:
    said: list[str] = []
    bridge = Bridge(
        make_scenario(room_file, localizer="support.doubtful:DoubtfulLocalizer"),
        relay,
        Types(Codec(relay.distro), relay),
        Names(),
        role="navigator",
        speed=2.0,
        report=said.append,
    )
    running = Served(bridge, said)
    try:
        seen = {line.pop("what"): line for line in run_script(ros, SCRIPTS / "localization.py")}
        episode = running.end()
    finally:
        running.close()
    assert seen["published"]["particles"] == 600
    assert seen["published"]["weight"] == pytest.approx(1 / 600)
    assert seen["published"]["covariance"][0] == pytest.approx(0.04)
    assert seen["told"]["x"] == pytest.approx(5.6, abs=0.02)
    assert seen["searched"] == {"done": True}
    assert seen["state"] == {"level": 0}
    given = [type(one.directive).__name__ for one in episode.directives]
    assert [name for name in given if name not in ("Speed", "End")] == ["SetPose", "ReinitializeGlobal"]
