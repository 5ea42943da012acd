"""Services: costmaps, the map, the states of nodes, and what is refused."""

import math

import numpy as np
import pytest

from ros2.navigator_role.conftest import wait_for
from trundle.costmap import LETHAL, NO_INFORMATION, Costmap
from trundle.geometry import Pose2D
from trundle.mission import DropBox, ReinitializeGlobal
from trundle.ros2.navigator_role.lifecycle import MANAGERS, NODES
from trundle.ros2.navigator_role.outputs import local_window
from trundle.ros2.navigator_role.role import REFUSED_ACTIONS

GET_STATE, MANAGE = "lifecycle_msgs/srv/GetState", "nav2_msgs/srv/ManageLifecycleNodes"
STARTUP, PAUSE, RESUME, RESET, SHUTDOWN = range(5)


def state_of(client, node="bt_navigator"):
    return client.call(f"/{node}/get_state", GET_STATE).current_state.label


def manage(client, command):
    return client.call("/lifecycle_manager_navigation/manage_nodes", MANAGE, command=command).success


# Nodes ----------------------------------------------------------------------------------------------------------------


def test_all_nodes_are_active_from_the_start(serve, client):
    serve()
    assert {state_of(client, node) for node in NODES} == {"active"}
    for manager in MANAGERS:
        assert client.call(f"/{manager}/is_active", "std_srvs/srv/Trigger").success


def test_a_navigator_that_is_paused_refuses_goals_until_it_goes_on(serve, client):
    served = serve()
    goal = client.go(6.5, 1.5)
    goal.wait_for_feedback(5)
    assert manage(client, PAUSE)
    assert "inactive" in goal.wait().error_msg
    assert state_of(client) == "inactive"
    refused = client.go(1.5, 4.5)
    assert refused.status == "rejected"
    client.publish("/goal_pose", client.pose(1.5, 4.5))
    wait_for(lambda: "goal_pose: refused" in served.counts)
    assert manage(client, RESUME)
    again = client.go(1.5, 4.5)
    again.wait()
    assert (goal.status, again.status) == ("aborted", "succeeded")


def test_a_navigator_that_is_shut_down_stays_so(serve, client):
    serve()
    assert manage(client, SHUTDOWN)
    assert state_of(client) == "finalized"
    assert not manage(client, STARTUP)
    assert not manage(client, 77)
    assert client.go(1.5, 4.5).status == "rejected"


# Costmaps and the map -------------------------------------------------------------------------------------------------


def lethal(client):
    answer = client.call("/global_costmap/get_costmap", "nav2_msgs/srv/GetCostmap")
    return np.count_nonzero(answer.map.data == LETHAL)


@pytest.mark.parametrize("which", ["global", "local"])
@pytest.mark.parametrize(
    ("verb", "action", "size"),
    [
        ("clear_entirely", "ClearEntireCostmap", None),
        ("clear_around", "ClearCostmapAroundRobot", 4.0),
        ("clear_except", "ClearCostmapExceptRegion", 6.0),
    ],
)
def test_costmaps_are_cleared(serve, client, which, verb, action, size):
    served = serve()
    before = lethal(client)
    served.put(DropBox(2.4, 1.5, 0.0, (0.3, 0.3, 0.6)))
    wait_for(lambda: lethal(client) > before)
    fields = {} if size is None else {"reset_distance": size}
    client.call(f"/{which}_costmap/{verb}_{which}_costmap", f"nav2_msgs/srv/{action}", **fields)
    served.end()
    (cleared,) = [
        one.directive for one in served.episode.directives if type(one.directive).__name__ == "ClearObstacles"
    ]
    assert (cleared.region, cleared.size) == (verb.removeprefix("clear_").replace("entirely", "all"), size or 0.0)


def test_a_region_without_a_size_clears_nothing(serve, client):
    served = serve()
    name = "/local_costmap/clear_around_local_costmap"
    client.call(name, "nav2_msgs/srv/ClearCostmapAroundRobot", reset_distance=0.0)
    assert served.counts == {f"{name}: failed": 1}


def test_the_costmaps_are_given_with_their_frame(serve, client):
    serve()
    whole = client.call("/global_costmap/get_costmap", "nav2_msgs/srv/GetCostmap").map
    assert (whole.metadata.size_x, whole.metadata.size_y, len(whole.data)) == (160, 120, 19200)
    window = client.call("/local_costmap/get_costmap", "nav2_msgs/srv/GetCostmap").map
    at = window.metadata.origin.position
    assert (window.metadata.size_x, at.x, at.y) == (60, pytest.approx(-1.5, abs=0.06), pytest.approx(-1.5, abs=0.06))
    assert window.header.frame_id == "odom"


def test_the_map_is_given(serve, client):
    serve()
    grid = client.call("/map_server/map", "nav_msgs/srv/GetMap").map
    assert (grid.info.width, grid.info.height, grid.header.frame_id) == (160, 120, "map")


def test_a_window_over_the_edge_of_a_costmap_is_unknown_there(serve):
    costmap: Costmap = serve().bridge.mission.navigator.costmap
    costs, origin = local_window(costmap, Pose2D(0.5, 3.0))
    assert costs.shape == (60, 60)
    assert (origin.x, origin.y) == (pytest.approx(-1.0), pytest.approx(1.5))
    assert (costs[:, :20] == NO_INFORMATION).all()
    assert (costs[:, 20:] == costmap.data[30:90, :40]).all()
    turned, corner = local_window(costmap, Pose2D(0.5, 3.0), Pose2D(0.5, 3.0, math.pi / 2.0))  # y is forward there
    assert (corner.x, corner.y) == (pytest.approx(-1.5), pytest.approx(-1.5))
    assert (turned == np.rot90(costs)).mean() > 0.95
    assert (local_window(costmap, Pose2D(90.0, 90.0))[0] == NO_INFORMATION).all()


# Refusals -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("distro", ["jazzy", "kilted"])
def test_what_trundle_does_not_have_is_refused_at_once(serve, make_client, distro):
    served = serve(distro)
    client = make_client(distro)
    offered = {name for name, _ in served.bridge.wire.actions}
    for refusal in REFUSED_ACTIONS:
        if not client.types.knows(f"{refusal.type_name}_Goal"):
            assert f"/{refusal.name}" not in offered
            continue
        goal = client.send(f"/{refusal.name}", refusal.type_name.rpartition("/")[2])
        result = goal.wait()
        assert (goal.status, result.error_msg) == ("aborted", refusal.why)
        assert result.error_code != 0
        assert served.counts[f"{refusal.name}: refused"] == 1


def test_an_action_whose_result_has_no_text_is_rejected(serve, client):
    served = serve(definitions=client.learn({"nav2_msgs/action/UndockRobot_Result": "uint16 error_code\n"}))
    goal = client.send("/undock_robot", "UndockRobot")
    assert goal.status == "rejected"
    assert served.counts == {"undock_robot: refused": 1}


def test_without_services_topics_alone_are_served(serve):
    served = serve(has_services=False)
    missing = served.bridge.wire.missing
    assert {"/navigate_to_pose", "/bt_navigator/get_state"} <= set(missing)
    assert served.bridge.wire.actions == []


def test_a_ros_without_nav2_is_told_what_to_install(serve):
    served = serve(definitions={})
    assert "nav2_msgs is not installed" in served.counts
    assert any("sudo apt install ros-jazzy-nav2-msgs" in line for line in served.said)


# Localizer ------------------------------------------------------------------------------------------------------------

EMPTY, SEARCH = "std_srvs/srv/Empty", "/reinitialize_global_localization"


def test_the_localizer_searches_when_the_service_is_called(serve, client):
    served = serve(scenario={"localizer": "support.doubtful:DoubtfulLocalizer"})
    client.call(SEARCH, EMPTY)
    episode = served.end()
    (given,) = [one for one in episode.directives if isinstance(one.directive, ReinitializeGlobal)]
    assert (given.by, given.refused) == ("reinitialize_global_localization", "")


def test_a_search_of_the_whole_map_is_refused_with_the_reason_where_none_can_search(serve, client):
    served = serve()
    client.call(SEARCH, EMPTY)
    wait_for(lambda: served.counts == {"reinitialize_global_localization: refused": 1})
    assert "there is no localizer" in served.said[0]
