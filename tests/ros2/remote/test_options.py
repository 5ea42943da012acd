"""A robot that is somewhere else: what is recorded of it, the frames that it lacks, and lidars that send clouds."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ros2.fake_transport import FakeNetwork
from ros2.navigator_role.conftest import wait_for
from ros2.remote.conftest import Remote, jazzy
from ros2.remote.test_drive import GOAL, check_arrival
from trundle.bags.bag_reader import BagReader
from trundle.messages.qos import LATCHED
from trundle.ros2.record import WireRecord
from trundle.ros2.remote import publishing, scans
from trundle.ros2.types import Types

Navigate = Callable[..., Remote]
TRANSFORMS = "tf2_msgs/msg/TFMessage"
pytestmark = pytest.mark.filterwarnings("ignore::trundle.errors.SensorWarning")


@pytest.mark.slow
def test_what_is_read_and_written_is_recorded(navigate: Navigate, network: FakeNetwork, tmp_path: Path) -> None:
    transport = network.transport("recorder")
    with WireRecord(tmp_path / "wire.mcap", "jazzy", Types(jazzy(), transport)) as record:
        remote = navigate(goal=GOAL, more={"record": record})
        check_arrival(remote)
        remote.bridge.close()
    with BagReader(tmp_path / "wire.mcap") as bag:
        counts = {topic.name: topic.count for topic in bag.topics}
        (tf,) = [topic for topic in bag.topics if topic.name == "/tf"]
        pairs = {
            (one.header.frame_id, one.child_frame_id)
            for _, _, message in bag.messages([tf])
            for one in message.transforms
        }
    assert counts["/map"] == 1
    assert min(counts[name] for name in ("/scan", "/odom", "/cmd_vel", "/clock", "/amcl_pose")) > 0
    assert pairs == {("odom", "base_link"), ("map", "odom")}  # theirs and ours


def static_frames(network: FakeNetwork) -> list[str]:
    reader = network.transport("rviz").subscription("/tf_static", TRANSFORMS, LATCHED)
    found = [jazzy().decode(TRANSFORMS, one.data) for one in reader.take()]
    return [one.child_frame_id for message in found for one in message.transforms]


@pytest.mark.parametrize(
    ("when", "theirs", "said"),
    [
        ("auto", False, "nobody publishes base_link → lidar_scan: trundle does, by the robot's file"),
        ("auto", True, ""),
        ("always", True, "published: base_link → lidar_scan"),
        ("never", False, ""),
    ],
)
def test_frames_of_lidars_are_published_where_they_are_wanted(
    navigate: Navigate, network: FakeNetwork, monkeypatch: pytest.MonkeyPatch, when: str, theirs: bool, said: str
) -> None:
    monkeypatch.setattr(publishing, "FRAMES_AFTER_S", 0.6)
    remote = navigate(goal=None, habits={"static": theirs}, options={"static_frames": when})
    wait_for(lambda: not remote.reasons)
    if said:
        wait_for(lambda: any(said in line for line in remote.said), f"for {said}: {remote.said}")
    else:
        wait_for(lambda: remote.bridge.context.driver.status.time > 1.2)
        assert not any("base_link → " in line for line in remote.said)
    assert len(static_frames(network)) == theirs + bool(said)


def test_a_lidar_that_sends_only_clouds_is_driven_by_them(navigate: Navigate, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scans, "CLOUDS_AFTER_S", 0.5)
    remote = navigate(localizer="amcl", habits={"as_cloud": True})
    check_arrival(remote)
    seen = remote.bridge.inputs.scan_streams["scan"]
    assert seen.count > 3


def test_a_cloud_that_is_none_lets_the_robot_stand_with_one_warning(
    navigate: Navigate, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scans, "CLOUDS_AFTER_S", 0.5)
    remote = navigate(goal=(8.0, 5.0), habits={"as_cloud": True})
    remote.wait_until_moving()
    remote.habits.edit_cloud = break_cloud
    assert remote.wait_until_standing() < 0.6
    assert len([line for line in remote.said if "has no field x" in line]) == 1


def break_cloud(message: Any) -> None:
    message.fields = []
    message.data = np.zeros(0, np.uint8)
    message.width = message.row_step = 0
