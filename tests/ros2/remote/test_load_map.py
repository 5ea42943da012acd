"""Another map while a robot is driven: the goal, the localizer and the page go on with it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ros2.navigator_role.conftest import LATCHED, Client, wait_for
from ros2.remote.conftest import Remote, make_room
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid

LOAD = "nav2_msgs/srv/LoadMap"
GRID = "nav_msgs/msg/OccupancyGrid"
Navigate = Callable[..., Remote]


def changed_room(folder: Path, name: str, *, shift: Pose2D = Pose2D(0.0, 0.0), wall: bool = False) -> str:
    """The room with a table more, or with a wall across it."""
    room = make_room()
    data = np.array(room.data)
    data[60:70, 150:160] = 100
    if wall:
        data[:, 100:104] = 100
    path = folder / f"{name}.yaml"
    OccupancyGrid(data, room.resolution, shift).save(path)
    return str(path)


@pytest.fixture
def client(network: Any) -> Client:
    return Client(network, "jazzy")


def load(client: Client, path: str) -> Any:
    return client.call("/map_server/load_map", LOAD, map_url=path)


def test_a_goal_goes_on_on_another_map(navigate: Navigate, client: Client, tmp_path: Path) -> None:
    client.read("/map", GRID, LATCHED)
    remote = navigate(goal=(5.5, 2.5), localizer="amcl", has_services=True)
    remote.wait_until_moving()
    before = remote.bridge.mission
    path = changed_room(tmp_path, "table")
    assert load(client, path).result == 0
    wait_for(lambda: remote.bridge.mission is not before, "for the run on it")
    loaded = OccupancyGrid.load(path)
    wait_for(
        lambda: any(
            np.count_nonzero(one.data == 100) == np.count_nonzero(loaded.data == 100) for one in client.got("/map")
        ),
        "for the map",
    )
    episode = remote.wait_for_end()
    assert remote.bridge.drive is not None
    assert remote.bridge.drive.arrived, episode.message
    assert remote.robot.pose.distance_to(Pose2D(5.5, 2.5)) < 0.35
    assert not remote.robot.contacts
    assert np.array_equal(remote.bridge.mission.navigator.grid.data, loaded.data)


def test_a_goal_that_is_out_of_reach_on_it_ends_with_the_reason(
    navigate: Navigate, client: Client, tmp_path: Path
) -> None:
    remote = navigate(goal=(8.0, 2.5), has_services=True)
    remote.wait_until_moving()
    assert load(client, changed_room(tmp_path, "walled", wall=True)).result == 0
    remote.wait_for_end()
    drive = remote.bridge.drive
    assert drive is not None
    assert not drive.arrived
    assert "path" in drive.message
    assert remote.robot.twist.v == 0.0


@pytest.mark.slow
def test_a_client_s_goal_goes_on(navigate: Navigate, client: Client, tmp_path: Path) -> None:
    remote = navigate(goal=None, has_services=True)
    wait_for(lambda: not remote.reasons, "for the robot")
    goal = client.send("/navigate_to_pose", "NavigateToPose", pose=client.pose(5.0, 2.5))
    remote.wait_until_moving()
    assert load(client, changed_room(tmp_path, "table")).result == 0
    goal.wait()
    times = [one.navigation_time.sec + 1e-9 * one.navigation_time.nanosec for one in goal.feedback]
    assert times == sorted(times)
    assert goal.status == "succeeded"
    assert remote.robot.pose.distance_to(Pose2D(5.0, 2.5)) < 0.35


@pytest.mark.slow
def test_a_robot_that_is_not_on_it_waits_for_its_pose(navigate: Navigate, client: Client, tmp_path: Path) -> None:
    remote = navigate(goal=None, localizer="amcl", has_services=True)
    wait_for(lambda: not remote.reasons, "for the robot")
    assert load(client, changed_room(tmp_path, "elsewhere", shift=Pose2D(50.0, 50.0))).result == 0
    wait_for(lambda: "not located" in remote.reasons)
    assert remote.bridge.localizer.waits_for_pose


@pytest.mark.slow
def test_a_map_of_another_site_does_not_fit_and_the_robot_stands(
    navigate: Navigate, client: Client, tmp_path: Path
) -> None:
    remote = navigate(goal=None, localizer="amcl", has_services=True)
    wait_for(lambda: not remote.reasons, "for the robot")
    other = np.zeros((160, 200), dtype=np.int8)
    other[40:44, :] = other[:, 60:64] = 100
    OccupancyGrid(other, 0.05).save(tmp_path / "other.yaml")
    assert load(client, str(tmp_path / "other.yaml")).result == 0
    wait_for(lambda: "do not fit the map" in remote.bridge.localizer.why, "for the reason")
    assert "the scans do not fit the map" in remote.reasons


def test_files_that_are_no_map_change_nothing(navigate: Navigate, client: Client, tmp_path: Path) -> None:
    remote = navigate(goal=(2.7, 2.2), has_services=True)
    before = remote.bridge.mission
    (tmp_path / "broken.yaml").write_text("image: [")
    full = np.full((160, 200), 100, dtype=np.int8)
    OccupancyGrid(full, 0.05).save(tmp_path / "full.yaml")
    assert load(client, str(tmp_path / "none.yaml")).result == 1
    assert load(client, str(tmp_path / "broken.yaml")).result == 2
    assert load(client, str(tmp_path / "full.yaml")).result == 255
    assert load(client, str(tmp_path)).result in (1, 2)
    remote.wait_for_end()
    assert remote.bridge.mission is before
    assert remote.bridge.drive is not None
    assert remote.bridge.drive.arrived


def test_a_robot_that_makes_its_map_takes_none(navigate: Navigate, client: Client, tmp_path: Path) -> None:
    remote = navigate(goal=None, localizer="slam", has_map=False, has_services=True)
    assert load(client, changed_room(tmp_path, "table")).result == 255
    assert any("makes its map itself" in text for text in remote.said)


def latencies(remote: Remote) -> list[float]:
    """What the navigator and the monitor take for the delay of commands [s]."""
    bridge: Any = remote.bridge
    return [one._delayed.delay_s for one in (bridge.mission.navigator, bridge._role._monitor._monitor)]


def test_the_run_on_it_knows_how_late_commands_are(navigate: Navigate, client: Client, tmp_path: Path) -> None:
    remote = navigate(goal=None, has_services=True, latency={"command_delay_s": 0.15})
    wait_for(lambda: latencies(remote) == [0.15, 0.15], "for the first run")
    assert load(client, changed_room(tmp_path, "table")).result == 0
    driver = remote.bridge.context.driver
    wait_for(lambda: driver.status.run == 2 and driver.status.time > 0.5, "for the run on it")
    assert latencies(remote) == [0.15, 0.15]


@pytest.mark.parametrize("localizer", ["odometry", "amcl"])
def test_a_goal_right_after_the_answer_is_driven_to(
    navigate: Navigate, client: Client, tmp_path: Path, localizer: str
) -> None:
    remote = navigate(goal=None, localizer=localizer, has_services=True)
    wait_for(lambda: not remote.reasons, "for the robot")
    assert load(client, changed_room(tmp_path, "table")).result == 0
    goal = client.send("/navigate_to_pose", "NavigateToPose", pose=client.pose(2.8, 2.1))
    goal.wait()
    assert goal.status == "succeeded", remote.said


@pytest.mark.filterwarnings("ignore:the estimate was corrected by 4")  # where the run has begun before it
def test_a_pose_right_after_the_answer_is_taken(navigate: Navigate, client: Client, tmp_path: Path) -> None:
    remote = navigate(goal=None, has_services=True)
    wait_for(lambda: not remote.reasons, "for the robot")
    assert load(client, changed_room(tmp_path, "table")).result == 0
    told = client.types.make("geometry_msgs/msg/PoseWithCovarianceStamped")
    told.header.frame_id, told.pose.pose.position.x, told.pose.pose.position.y = "map", 6.0, 3.0
    client.publish("/initialpose", told)
    wait_for(lambda: remote.bridge.localizer.shown.distance_to(Pose2D(6.0, 3.0)) < 0.05, f"for it: {remote.said}")


def test_maps_that_are_loaded_at_once_are_driven_on_in_turn(
    navigate: Navigate, client: Client, network: Any, tmp_path: Path
) -> None:
    remote = navigate(goal=(5.5, 2.5), localizer="amcl", has_services=True)
    remote.wait_until_moving()
    make, names = client.types.make, ["first", "second"]
    paths = [changed_room(tmp_path, name, shift=Pose2D(0.1 * at, 0.0)) for at, name in enumerate(names)]
    sent = [client.types.encode(make(f"{LOAD}_Request", map_url=path)) for path in paths]
    calls = [network.call("/map_server/load_map", one) for one in sent]
    wait_for(lambda: all(call.response is not None for call in calls), "for both answers")
    assert remote.bridge.mission.navigator.grid.origin.x == pytest.approx(0.1)
    episode = remote.wait_for_end()
    assert remote.bridge.drive is not None
    assert remote.bridge.drive.arrived, episode.message


def test_goals_of_the_command_line_wait_for_a_run_that_begins_again(navigate: Navigate, tmp_path: Path) -> None:
    remote = navigate(goal=(2.7, 2.2), starts_robot=False)
    wait_for(lambda: remote.reasons, "for the run")
    drive, steering = remote.bridge.drive, remote.bridge.context.driver.steering
    assert drive is not None
    role: Any = remote.bridge._role
    follow = drive.on_step
    loaded = role._prepare(Path(changed_room(tmp_path, "table")))

    def restart(step: Any) -> None:
        if not drive._guard.reasons and steering.run == 1:
            role._restart(loaded)
        follow(step)

    drive.on_step = restart  # type: ignore[method-assign]
    remote.robot.start()
    episode = remote.wait_for_end()
    assert drive.arrived, episode.message
    assert steering.run == 2
