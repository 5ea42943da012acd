"""A recording of anyone is played into the navigator: it is located, or its map made, and nothing is commanded."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ros2.fake_transport import FakeNetwork
from ros2.nav2_texts import nav2_codec
from ros2.navigator_role.conftest import Client
from ros2.remote.conftest import jazzy
from support.room_drives import Drive, write_bag
from trundle.errors import InputError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission import End, Episode, Scenario
from trundle.recordings import open_drive
from trundle.recordings.odometry import OdometryTrack
from trundle.ros2.names import Names
from trundle.ros2.remote.bag_bridge import BagBridge
from trundle.ros2.remote.bag_robot import read_truth
from trundle.ros2.remote.setting import RemoteOptions
from trundle.ros2.types import Types

pytest.importorskip("rosbags")
pytestmark = pytest.mark.filterwarnings("ignore::trundle.errors.SensorWarning")

ROOM = Drive(seconds=20.0, beams=120)
TRUTH = OdometryTrack(ROOM.begin + ROOM.times, ROOM.poses)
Played = tuple[BagBridge, Episode]


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_bag(tmp_path_factory.mktemp("bags") / "bag", ROOM)


@pytest.fixture
def network() -> FakeNetwork:
    return FakeNetwork()


def play(
    network: FakeNetwork,
    bag: Path,
    *,
    localizer: str = "slam",
    start: Pose2D | None = None,
    grid: Path | None = None,
    change: Callable[[Any], Any] = lambda drive: drive,
    **more: Any,
) -> Played:
    """Play a recording to its end."""
    place = {"world": {"name": "lot"}, "known_map": False} if grid is None else {"map": str(grid)}
    scenario = Scenario.make(**place, lidar=True, localizer=localizer)
    transport = network.transport("trundle", has_services=False)
    drive, options = change(open_drive(bag)), RemoteOptions(start=start)
    more = {"truth": TRUTH, "report": lambda text: None, **more}
    with BagBridge(scenario, drive, transport, Types(jazzy(), transport), Names(), options, **more) as bridge:
        return bridge, bridge.run()


@pytest.fixture(scope="module")
def made(bag: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Played, FakeNetwork, Path]:
    """The room as `slam` maps it."""
    network = FakeNetwork()
    played = play(network, bag)
    grid = tmp_path_factory.mktemp("maps") / "room.yaml"
    own = played[1].own_map
    assert own is not None
    own.grid.save(grid)
    return played, network, grid


def test_a_map_is_made_of_a_recording_and_published_as_it_grows(made: tuple[Played, FakeNetwork, Path]) -> None:
    (bridge, episode), network, grid = made
    summary = bridge.summary.as_dict()
    assert (episode.message, summary["scans"], summary["parts"]) == ("the recording has ended", 100, 1)
    assert bridge.summary.is_whole
    assert summary["error"]["max_m"] < 0.15  # type: ignore[index]
    assert (OccupancyGrid.load(grid).data == 100).sum() > 200
    assert len(network.sent["/map"]) >= 2


def test_it_is_published_as_a_robot_would_with_the_times_of_the_recording(
    made: tuple[Played, FakeNetwork, Path], network: FakeNetwork, bag: Path
) -> None:
    readers = {
        topic: network.transport("rviz").subscription(topic, kind, qos)
        for topic, kind, qos in (
            ("/scan", "sensor_msgs/msg/LaserScan", jazzy_qos("best_effort")),
            ("/tf", "tf2_msgs/msg/TFMessage", jazzy_qos("reliable")),
        )
    }
    play(network, bag, change=lambda drive: cut(drive, 20))
    scans = [jazzy().decode("sensor_msgs/msg/LaserScan", one.data) for one in readers["/scan"].take()]
    assert len(scans) == 20
    assert scans[0].header.stamp.sec == 1000
    assert scans[0].header.frame_id == "laser"
    assert "/cmd_vel" not in network.sent
    assert network.sent["/tf_static"]
    assert network.sent["/amcl_pose"]
    frames = [jazzy().decode("tf2_msgs/msg/TFMessage", one.data).transforms[0] for one in readers["/tf"].take()]
    assert {(one.header.frame_id, one.child_frame_id) for one in frames} >= {("odom", "base_link"), ("map", "odom")}


def jazzy_qos(reliability: Any) -> Any:
    from trundle.messages import Qos

    return Qos(1000, reliability)


def cut(drive: Any, count: int, error: Exception | None = None) -> Any:
    """The same recording, with so many scans; then it ends, or breaks off with an error."""

    def scans() -> Iterator[Any]:
        for number, scan in enumerate(drive.scans_in_order()):
            if number == count:
                if error is not None:
                    raise error
                return
            yield scan

    return replace(drive, scans_in_order=scans)


def test_a_robot_is_located_on_a_map_by_a_recording(
    made: tuple[Played, FakeNetwork, Path], network: FakeNetwork, bag: Path
) -> None:
    first = Pose2D(*ROOM.poses[0])
    truth = OdometryTrack(
        TRUTH.times, np.array([(first.inverse() @ Pose2D(*pose)).as_tuple() for pose in ROOM.poses.tolist()])
    )
    bridge, _ = play(network, bag, localizer="amcl", grid=made[2], start=Pose2D(0.0, 0.0), truth=truth)
    summary = bridge.summary.as_dict()
    assert bridge.summary.is_whole
    assert summary["error"]["p95_m"] < 0.15  # type: ignore[index]
    assert summary["states_s"]["localized"] > 15.0  # type: ignore[index]


def test_without_a_start_it_searches_and_says_whether_it_found(
    made: tuple[Played, FakeNetwork, Path], network: FakeNetwork, bag: Path
) -> None:
    bridge, _ = play(network, bag, localizer="amcl", grid=made[2], change=lambda drive: cut(drive, 5))
    states = bridge.summary.as_dict()["states_s"]
    assert set(states) & {"ambiguous", "lost"}  # type: ignore[call-overload]
    assert not bridge.summary.is_whole


def test_a_recording_that_breaks_off_ends_with_what_there_was(network: FakeNetwork, bag: Path) -> None:
    broken = InputError("the bag is damaged")
    bridge, episode = play(network, bag, change=lambda drive: cut(drive, 30, broken))
    assert episode.message == "the recording breaks off: the bag is damaged"
    assert bridge.summary.as_dict()["scans"] == 29  # the last one waits for whether another lidar measured with it
    assert episode.own_map is not None
    assert not bridge.summary.is_whole


def test_a_lifecycle_manager_does_not_make_a_recording_take_goals(network: FakeNetwork, bag: Path) -> None:
    client, said = Client(network, "jazzy"), list[str]()
    transport = network.transport("trundle")
    scenario = Scenario.make(world={"name": "lot"}, known_map=False, lidar=True, localizer="slam")
    types = Types(nav2_codec("jazzy"), transport)
    bridge = BagBridge(
        scenario, open_drive(bag), transport, types, Names(), RemoteOptions(), speed=1.0, report=said.append
    )
    thread = threading.Thread(target=bridge.run)
    with bridge:
        thread.start()
        assert client.go(1.0, 0.0).status == "rejected"
        for command in (1, 2):
            manage = "nav2_msgs/srv/ManageLifecycleNodes"
            assert client.call("/lifecycle_manager_navigation/manage_nodes", manage, command=command).success
        assert client.go(1.0, 0.0).status == "rejected"
        bridge.context.driver.steering.put(End("the test is over"))
        thread.join(20.0)
    assert any("a goal of navigate_to_pose is refused: a recording is played" in text for text in said)


def test_a_truncated_bag_is_played_up_to_there(network: FakeNetwork, tmp_path: Path) -> None:
    whole = next(write_bag(tmp_path / "bag", Drive(seconds=40.0, beams=2000)).glob("*.mcap")).read_bytes()
    short = tmp_path / "short.mcap"
    short.write_bytes(whole[: len(whole) * 9 // 10])
    bridge, episode = play(network, short, localizer="odometry", start=Pose2D(0.0, 0.0), truth=None)
    summary = bridge.summary.as_dict()
    assert episode.message == "the recording breaks off: it ends within a record"
    assert summary["damage"] == "it ends within a record"
    assert 20 < summary["scans"] < 200  # type: ignore[operator]
    assert not bridge.summary.is_whole


def test_an_exception_in_the_middle_ends_it_and_leaves_the_network(network: FakeNetwork, bag: Path) -> None:
    with pytest.raises(ZeroDivisionError):
        play(network, bag, change=lambda drive: cut(drive, 30, ZeroDivisionError()))
    assert not [one for one in network.transports if one.node == "/trundle"]


def test_odometry_that_begins_again_begins_a_part(network: FakeNetwork, tmp_path: Path) -> None:
    def change(topic: str, message: Any, index: int) -> Any:
        if topic == "/odom" and index >= 200:
            message.pose.pose.position.x += 50.0
        return message

    bridge, episode = play(network, write_bag(tmp_path / "bag", ROOM, change=change), truth=None)
    assert bridge.summary.as_dict()["parts"] == 2
    assert bridge.summary.as_dict()["error"] is None
    assert episode.message == "the recording has ended"


def test_true_poses_are_read_where_a_recording_has_them(bag: Path, tmp_path: Path) -> None:
    own = write_bag(tmp_path / "own", ROOM, rename={"/odom": "/ground_truth/odom"})
    found = read_truth(open_drive(own), "humble")
    assert found is not None
    assert len(found.times) == len(ROOM.times)
    assert read_truth(open_drive(bag), "humble") is None


def test_true_poses_before_the_end_of_a_truncated_recording_count(tmp_path: Path) -> None:
    long = Drive(seconds=40.0, beams=2000)
    own = write_bag(tmp_path / "own", long, rename={"/odom": "/ground_truth/odom"})
    short = tmp_path / "short.mcap"
    whole = next(own.glob("*.mcap")).read_bytes()
    short.write_bytes(whole[: len(whole) * 9 // 10])
    found = read_truth(open_drive(short, odometry="none"), "humble")
    assert found is not None
    assert 100 < len(found.times) < len(long.times)
