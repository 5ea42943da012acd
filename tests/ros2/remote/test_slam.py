"""A robot that is somewhere else is driven without a map, and makes it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ros2.fake_transport import FakeNetwork
from ros2.nav2_texts import nav2_codec
from ros2.navigator_role.conftest import wait_for
from ros2.remote.conftest import START, Remote, jazzy, make_room
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.messages.qos import LATCHED
from trundle.mission import SetGoal

Navigate = Callable[..., Remote]
pytestmark = pytest.mark.filterwarnings("ignore::trundle.errors.SensorWarning")
GRID, SAVE = "nav_msgs/msg/OccupancyGrid", "nav2_msgs/srv/SaveMap"


def start_without_a_map(navigate: Navigate, **more: Any) -> Remote:
    return navigate(localizer="slam", start=None, has_map=False, **more)


def maps_of(network: FakeNetwork) -> list[Any]:
    return [jazzy().decode(GRID, data) for data in network.sent.get("/map", [])]


def test_it_drives_on_a_map_that_grows_and_is_published(navigate: Navigate, network: FakeNetwork) -> None:
    remote = start_without_a_map(navigate, goal=(1.2, 0.4))
    episode = remote.wait_for_end()
    drive = remote.bridge.drive
    assert drive is not None
    assert drive.arrived, drive.message
    assert not remote.robot.contacts
    assert remote.robot.pose.distance_to(START @ Pose2D(1.2, 0.4)) < 0.3  # its map begins where it stood
    maps = maps_of(network)
    known = [int((np.asarray(one.data) >= 0).sum()) for one in maps]
    assert len(known) >= 2
    assert known[-1] > known[0] > 1000
    assert episode.own_map is not None
    check_walls(episode.own_map.grid)


def check_walls(grid: OccupancyGrid, *, least: int = 100) -> None:
    """What the map has as blocked is blocked in the room, give or take a few cells."""
    rows, cols = np.nonzero(grid.data == 100)
    points = np.column_stack(grid.cell_to_world(rows, cols))
    room = make_room()
    found = START.transform_points(points)
    near = np.zeros(len(found), dtype=bool)
    for step in np.stack(np.meshgrid([-0.1, -0.05, 0.0, 0.05, 0.1], [-0.1, -0.05, 0.0, 0.05, 0.1]), -1).reshape(-1, 2):
        row, col = room.world_to_cell(*(found + step).T)
        row, col = np.clip(row, 0, room.shape[0] - 1), np.clip(col, 0, room.shape[1] - 1)
        near |= room.data[row, col] == 100
    assert len(found) > least
    assert near.mean() > 0.98


def test_the_map_can_be_asked_for_and_saved(navigate: Navigate, network: FakeNetwork, tmp_path: Path) -> None:
    remote = start_without_a_map(navigate, goal=None, has_services=True)
    wait_for(lambda: remote.bridge.localizer.is_located and bool(network.sent.get("/map")), "for a map")
    assert len(network.transport("rviz").subscription("/map", GRID, LATCHED).take()) == 1  # a late reader gets it
    codec = nav2_codec("jazzy")
    call = network.call("/map_server/map", codec.encode(codec.make("nav_msgs/srv/GetMap_Request")))
    wait_for(lambda: call.response is not None, "for the map")
    assert call.response is not None
    assert codec.decode("nav_msgs/srv/GetMap_Response", call.response).map.info.width > 50
    request = codec.make(
        f"{SAVE}_Request",
        map_topic="map",
        map_url=str(tmp_path / "made"),
        image_format="png",
        map_mode="",
        free_thresh=0.25,
        occupied_thresh=0.65,
    )
    call = network.call("/map_saver/save_map", codec.encode(request))
    wait_for(lambda: call.response is not None, "for the file")
    assert call.response is not None
    assert codec.decode(f"{SAVE}_Response", call.response).result
    check_walls(OccupancyGrid.load(tmp_path / "made.yaml"), least=20)


@pytest.mark.slow
def test_a_jump_of_the_odometry_does_not_cost_the_map(navigate: Navigate) -> None:
    remote = start_without_a_map(navigate, goal=None)
    wait_for(lambda: remote.bridge.localizer.is_located, "for a map")
    remote.put(SetGoal((1.5, 0.0)))
    remote.wait_until_moving()
    remote.habits.odometry_shift = Pose2D(3.0, 1.0, 0.5)
    assert remote.wait_until_standing() < 0.6
    wait_for(lambda: remote.bridge.guard.counts["odometry jumped"] == 1)
    wait_for(lambda: remote.bridge.localizer.is_located, "for a place that is recognised")
    wait_for(lambda: math.dist((remote.robot.pose.x, remote.robot.pose.y), (3.5, 2.0)) < 0.3, "to arrive")


@pytest.mark.slow
def test_a_robot_that_is_carried_stands_until_it_recognises_its_map(navigate: Navigate) -> None:
    remote = start_without_a_map(navigate, goal=None)
    wait_for(lambda: remote.bridge.localizer.is_located, "for a map")
    remote.put(SetGoal((2.5, 0.0)))
    wait_for(lambda: remote.robot.pose.x > 3.0, "for a motion")
    remote.robot.carry(Pose2D(7.5, 5.5, 2.5))
    wait_for(lambda: "nobody knows how the robot has moved" in remote.bridge.localizer.why, "for the reason")
    assert remote.wait_until_standing() < 0.6
    time.sleep(1.0)  # it sees another corner of the room, which its map does not join yet
    stood = remote.robot.pose
    assert "not located" in remote.reasons
    remote.robot.carry(Pose2D(2.2, 2.1, 0.1))
    remote.habits.by_hand = Twist2D(0.3, 0.0)  # as with a joystick of its own
    wait_for(lambda: remote.bridge.localizer.is_located, f"for a place that is recognised: {remote.reasons}")
    remote.habits.by_hand = None
    assert stood.distance_to(Pose2D(7.5, 5.5, 2.5)) < 0.05
    wait_for(lambda: math.dist((remote.robot.pose.x, remote.robot.pose.y), (4.5, 2.0)) < 0.35, "to arrive")
