"""FollowPath and the plans."""

import math

import numpy as np
import pytest

from ros2.navigator_role.conftest import wait_for
from trundle.path import Path
from trundle.ros2.navigator_role.driving import drivable
from trundle.ros2.navigator_role.plans import dense

UP = [(1.5, 1.5), (1.5, 2.5), (1.5, 3.5), (2.5, 4.0)]


def follow(client, poses, **fields):
    return client.send("/follow_path", "FollowPath", path=client.path(poses), **fields)


def plan(client, *goal, start=None, distro="jazzy", **fields):
    use = {} if start is None else {"start": client.pose(*start), "use_start": True}
    return client.send("/compute_path_to_pose", "ComputePathToPose", goal=client.pose(*goal), **use, **fields)


# Following ------------------------------------------------------------------------------------------------------------


def test_a_path_is_followed_with_feedback(serve, client):
    serve()
    goal = follow(client, [client.pose(*place) for place in UP])
    first = goal.wait_for_feedback()
    assert first.distance_to_goal == pytest.approx(3.1, abs=0.2)
    assert goal.wait().error_code == 0
    assert goal.status == "succeeded"
    assert max(one.speed for one in goal.feedback) > 0.3


def test_a_path_in_the_robots_frame_is_followed(serve, client):
    serve()
    poses = [client.pose(x, 0.0, frame="") for x in (0.0, 0.5, 1.0)]
    goal = client.send("/follow_path", "FollowPath", path=client.path(poses, "base_link"))
    goal.wait()
    assert goal.status == "succeeded"


@pytest.mark.parametrize(
    ("poses", "code", "says"),
    [
        ([], 103, "has 0"),
        ([(math.nan, 1.0)], 103, "not finite"),
        ([(6.0, 4.0), (6.5, 4.0)], 103, "within 1.5 m of the robot"),
    ],
)
def test_a_path_that_cannot_be_followed_is_refused(serve, client, poses, code, says):
    serve()
    goal = follow(client, [client.pose(*place) for place in poses])
    result = goal.wait()
    assert (goal.status, result.error_code) == ("aborted", code)
    assert says in result.error_msg


def test_a_path_in_an_unknown_frame_and_an_unknown_controller_are_refused(serve, client):
    serve()
    poses = [client.pose(1.5, 1.5, frame="moon")]
    assert follow(client, poses).wait().error_code == 102
    known = [client.pose(*place) for place in UP]
    assert follow(client, known, controller_id="Mine").wait().error_code == 101
    done = follow(client, known, controller_id="regulated_pure_pursuit")
    done.wait()
    assert done.status == "succeeded"


def test_a_path_that_claims_more_poses_than_it_has_is_refused(serve, client, network):
    served = serve()
    goal = client.types.make("nav2_msgs/action/FollowPath_Goal", path=client.path([]))
    data = bytearray(client.types.encode(goal))
    count = data.index(b"map\0") + 4
    data[count : count + 4] = (10**9).to_bytes(4, "little")
    sent = network.send_goal("/follow_path", bytes(data))
    wait_for(lambda: sent.status != "sent")
    assert sent.status == "rejected"
    assert sum(served.counts.values()) == 1


def test_a_path_through_a_wall_ends_before_it_with_no_valid_control(serve, client):
    serve()
    goal = follow(client, [client.pose(1.5, 1.5), client.pose(6.0, 1.5)])
    result = goal.wait()
    assert (goal.status, result.error_code) == ("aborted", 106)


def test_a_goal_replaces_a_path_and_a_path_a_goal(serve, client):
    serve()
    path = follow(client, [client.pose(*place) for place in UP])
    path.wait_for_feedback(3)
    goal = client.go(6.5, 1.5)
    path.wait()
    goal.wait_for_feedback(3)
    here = goal.feedback[-1].current_pose.pose.position
    again = follow(client, [client.pose(here.x, here.y), client.pose(here.x, here.y + 0.5)])
    goal.wait()
    again.wait()
    assert (path.status, goal.status, again.status) == ("aborted", "aborted", "succeeded")


def test_a_path_without_yaws_is_driven_forward():
    poses, backward = drivable(np.array([(0.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (-1.0, 1.0, 0.0)]))
    assert backward == [False, False]
    assert [yaw for _, _, yaw in poses] == pytest.approx([math.pi, math.pi / 2, 0.0])


def test_legs_in_reverse_stay_so_and_places_that_repeat_are_left_out():
    there = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 0.0, 0.1), (0.2, -0.1, 0.2), (0.2, -0.1, 0.3)]
    poses, backward = drivable(np.array(there))
    assert backward == [False, True]
    assert poses[-1] == [0.2, -0.1, 0.3]
    assert abs(poses[1][2]) < 0.2


def test_a_turn_on_the_spot_is_a_path_too():
    assert drivable(np.array([(0.0, 0.0, 0.0)])) == ([[0.0, 0.0, 0.0]], [])
    assert drivable(np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 1.0)])) == ([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [False])


# Plans ----------------------------------------------------------------------------------------------------------------


def test_a_path_is_computed_and_the_robot_stands(serve, client):
    served = serve()
    goal = plan(client, 6.5, 1.5)
    result = goal.wait()
    assert (goal.status, result.error_code, result.path.header.frame_id) == ("succeeded", 0, "map")
    at = np.array([(pose.pose.position.x, pose.pose.position.y) for pose in result.path.poses])
    assert at[0] == pytest.approx([1.5, 1.5], abs=0.05)
    assert at[-1] == pytest.approx([6.5, 1.5], abs=0.05)
    assert np.hypot(*np.diff(at, axis=0).T).max() <= 0.051
    assert result.planning_time.sec + result.planning_time.nanosec > 0
    assert served.goals == ()


@pytest.mark.parametrize(
    ("goal", "start", "code"),
    [
        ((4.0, 1.0), None, 206),
        ((40.0, 1.0), None, 204),
        ((1.5, 4.5), (4.0, 1.0), 205),
        ((1.5, 4.5), (-9.0, 1.0), 203),
    ],
)
def test_a_path_that_does_not_exist_has_nav2s_code(serve, client, goal, start, code):
    serve()
    asked = plan(client, *goal, start=start)
    assert asked.wait().error_code == code
    assert asked.status == "aborted"


def test_a_planner_is_chosen_by_name(serve, client):
    serve()
    assert plan(client, 1.5, 4.5, planner_id="astar").wait().error_code == 0
    assert plan(client, 1.5, 4.5, planner_id="GridBased").wait().error_code == 0
    unknown = plan(client, 1.5, 4.5, planner_id="asta").wait()
    assert unknown.error_code == 201
    assert "Did you mean 'astar'" in unknown.error_msg


@pytest.mark.parametrize("distro", ["jazzy", "kilted"])
def test_a_path_through_poses_is_computed(serve, make_client, distro):
    serve(distro)
    client = make_client(distro)
    poses = [client.pose(1.5, 3.5), client.pose(6.0, 4.5)]
    goals = client.types.make("nav_msgs/msg/Goals", goals=poses) if distro == "kilted" else poses
    result = client.send("/compute_path_through_poses", "ComputePathThroughPoses", goals=goals).wait()
    at = np.array([(pose.pose.position.x, pose.pose.position.y) for pose in result.path.poses])
    assert np.hypot(*(at - (1.5, 3.5)).T).min() < 0.05
    assert result.error_code == 0


def test_no_poses_to_plan_through_are_refused(serve, client):
    serve()
    goal = client.send("/compute_path_through_poses", "ComputePathThroughPoses", goals=[])
    assert goal.wait().error_code == 309


def test_a_path_is_computed_while_the_robot_drives(serve, client):
    serve()
    goal = client.go(6.5, 1.5)
    goal.wait_for_feedback(5)
    assert plan(client, 1.5, 4.5).wait().error_code == 0
    goal.wait()
    assert goal.status == "succeeded"


def test_a_second_plan_replaces_one_that_waits_and_a_plan_can_be_cancelled(serve, client):
    serve()
    asked = [plan(client, 6.5, 1.5, planner_id="hybrid_astar") for _ in range(4)]
    for goal in asked:
        goal.cancel()
        goal.wait()
    assert all(goal.status in ("succeeded", "aborted", "canceled") for goal in asked)
    assert plan(client, 1.5, 4.5).wait().error_code == 0


def test_poses_of_a_plan_are_dense_and_do_not_repeat():
    made = dense(Path([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 0.0, 1.5)]), 0.1)
    assert np.abs(np.diff(made, axis=0)).max(axis=1).min() > 0.0
    assert len(made) == 1 + 10 + 9
    assert dense(Path([(0.0, 0.0, 0.0)]), 0.1).shape == (1, 3)


def test_yaws_of_a_plan_are_within_a_half_turn_also_where_they_count_turns():
    made = dense(Path([(0.0, 0.0, 6.2), (1.0, 0.0, 6.28), (2.0, 0.0, 0.3)]), 0.1)
    assert np.abs(made[:, 2]).max() <= np.pi
    assert made[-1, 2] == pytest.approx(0.3)


def test_paths_are_checked_against_the_costmap(serve, client):
    serve()
    wait_for(lambda: True)
    valid = client.path([client.pose(1.5, 1.5), client.pose(1.5, 3.0)])
    answer = client.call("/is_path_valid", "nav2_msgs/srv/IsPathValid", path=valid)
    assert (answer.success, answer.is_valid, answer.invalid_pose_indices.tolist()) == (True, True, [])
    walled = client.path([client.pose(1.5, 1.5), client.pose(4.0, 1.0)])
    answer = client.call("/is_path_valid", "nav2_msgs/srv/IsPathValid", path=walled)
    assert (answer.is_valid, answer.invalid_pose_indices.tolist()) == (False, [1])
    assert not client.call("/is_path_valid", "nav2_msgs/srv/IsPathValid").is_valid
