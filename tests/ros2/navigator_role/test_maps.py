"""Map services, the pose of the localizer, and clearing around a pose."""

from __future__ import annotations

import numpy as np
import pytest

from ros2.navigator_role.conftest import make_room, wait_for
from trundle.errors import InputError
from trundle.maps import OccupancyGrid
from trundle.mission import ClearObstacles, SetPose
from trundle.ros2.navigator_role.services import read_url

LOAD, SAVE = "nav2_msgs/srv/LoadMap", "nav2_msgs/srv/SaveMap"
POSE = "geometry_msgs/msg/PoseWithCovarianceStamped"


def load(client, url):
    return client.call("/map_server/load_map", LOAD, map_url=url)


def given(served):
    session = served.bridge.context.session
    return [] if session is None else [(one.directive, one.by) for one in session.directives]


def test_the_same_map_is_taken(serve, client, room_file):
    served = serve()
    for url in (room_file, f"file://{room_file}"):
        answer = load(client, url)
        assert answer.result == 0
        assert (answer.map.info.width, answer.map.info.height) == (160, 120)
    assert served.counts == {}


def test_a_simulated_world_stays_when_its_map_is_replaced(serve, client, tmp_path):
    world = {"world": {"name": "warehouse", "seed": 3}, "map": None, "start": None, "goal": None}
    served = serve(scenario=world)
    goal = wait_for(lambda: served.bridge.context.session and served.bridge.mission.start)
    before, stood = served.bridge.mission, served.bridge.mission.start
    data = np.array(before.grid.data)
    row, col = before.grid.world_to_cell(goal.x + 2.0, goal.y)
    data[row : row + 3, col : col + 3] = 100
    OccupancyGrid(data, before.grid.resolution, before.grid.origin).save(tmp_path / "other.yaml")
    answer = load(client, str(tmp_path / "other.yaml"))
    assert answer.result == 0, served.said
    wait_for(lambda: served.bridge.mission is not before)
    mission = served.bridge.mission
    assert np.array_equal(mission.navigator.grid.data, data)
    assert mission.world is before.world
    assert mission.start.distance_to(stood) < 0.05
    assert client.call("/map_server/map", "nav_msgs/srv/GetMap").map.info.width == data.shape[1]


def test_another_map_a_missing_one_and_a_broken_one_have_their_codes(serve, client, tmp_path):
    served = serve()
    other = make_room()
    OccupancyGrid(np.zeros_like(other.data), 0.05).save(tmp_path / "other.yaml")
    (tmp_path / "broken.yaml").write_text("image: [")
    assert load(client, str(tmp_path / "other.yaml")).result == 255
    assert load(client, str(tmp_path / "none.yaml")).result == 1
    assert load(client, str(tmp_path / "broken.yaml")).result == 2
    assert load(client, "package://nav2_bringup/maps/a.yaml").result == 2
    assert any("is made from the map, and would stay" in text for text in served.said)


def test_the_map_is_saved_as_nav2s_saver_does(serve, client, tmp_path):
    served = serve()
    fields = {"map_topic": "map", "map_url": str(tmp_path / "saved"), "image_format": "png", "map_mode": "trinary"}
    assert client.call("/map_saver/save_map", SAVE, **fields).result
    assert np.array_equal(OccupancyGrid.load(tmp_path / "saved.yaml").data, make_room().data)
    assert not client.call("/map_saver/save_map", SAVE, **fields).result
    assert any("overwrites nothing" in text for text in served.said)
    assert not client.call("/map_saver/save_map", SAVE, map_url=str(tmp_path / "b"), image_format="tiff").result
    assert not client.call("/map_saver/save_map", SAVE, map_url=str(tmp_path / "c"), map_topic="other").result


def test_urls_of_other_machines_name_no_file():
    assert str(read_url("file:///maps/a%20b.yaml")) == "/maps/a b.yaml"
    for url in ("http://host/map.yaml", "file://host/map.yaml", ""):
        with pytest.raises(InputError):
            read_url(url)


def pose_message(client, x, y, variance):
    pose = client.types.make(POSE)
    pose.header.frame_id = "map"
    pose.pose.pose.position.x, pose.pose.pose.position.y = x, y
    pose.pose.covariance[[0, 7, 35]] = variance
    return pose


def test_set_initial_pose_sets_the_localizers_pose(serve, client):
    served = serve(scenario={"localizer": "odometry"})
    client.call("/set_initial_pose", "nav2_msgs/srv/SetInitialPose", pose=pose_message(client, 2.0, 2.0, 0.25))
    wait_for(lambda: any(isinstance(one, SetPose) for one, _ in given(served)))
    (directive,) = [one for one, by in given(served) if by == "set_initial_pose"]
    assert directive.pose == (2.0, 2.0, 0.0)
    assert directive.covariance[0][0] == 0.25


def test_without_a_localizer_it_says_how_to_get_one(serve, client):
    served = serve()
    client.call("/set_initial_pose", "nav2_msgs/srv/SetInitialPose", pose=pose_message(client, 2.0, 2.0, 0.25))
    wait_for(lambda: "set_initial_pose: no localizer" in served.counts)
    assert any("--localizer amcl" in text for text in served.said)


def test_true_poses_have_a_covariance_that_can_be_inverted(serve, client):
    from ros2.navigator_role.conftest import LATCHED

    client.read("/amcl_pose", POSE, LATCHED)
    serve()
    message = wait_for(lambda: client.got("/amcl_pose"))[-1]
    covariance = np.reshape(message.pose.covariance, (6, 6))[np.ix_((0, 1, 5), (0, 1, 5))]
    assert np.linalg.eigvalsh(covariance).min() > 0.0


@pytest.mark.parametrize(
    "name", ["local_costmap/clear_around_pose_local_costmap", "local_costmap/clear_costmap_around_pose"]
)
def test_clearing_around_a_pose_clears_there(serve, client, name):
    served = serve()
    fields = {"pose": client.pose(6.0, 4.0), "reset_distance": 2.0}
    client.call(f"/{name}", "nav2_msgs/srv/ClearCostmapAroundPose", **fields)
    directive, by = wait_for(lambda: [one for one in given(served) if isinstance(one[0], ClearObstacles)])[0]
    assert (directive.region, directive.size, directive.at) == ("around", 2.0, (6.0, 4.0, 0.0))
    assert by == "ClearCostmapAroundPose"
