"""Nav2's actions, as clients see them."""

import math

import pytest

from ros2.navigator_role.conftest import wait_for
from trundle.mission import Cancel, SetGoal


def test_a_goal_is_driven_to_with_feedback(serve, client):
    served = serve()
    goal = client.go(1.5, 4.5, math.pi / 2)
    first = goal.wait_for_feedback()
    assert first.current_pose.header.frame_id == "map"
    assert first.distance_remaining == pytest.approx(3.0, abs=0.6)
    assert goal.wait().error_code == 0
    assert goal.status == "succeeded"
    feedback = goal.feedback
    times = [one.navigation_time.sec + one.navigation_time.nanosec * 1e-9 for one in feedback]
    assert times == sorted(times)
    assert len(feedback) >= 20 * times[-1] * 0.9
    assert feedback[-1].distance_remaining < 0.5
    assert max(one.estimated_time_remaining.sec for one in feedback) > 1
    assert served.counts == {}


@pytest.mark.parametrize("distro", ["jazzy", "kilted"])
@pytest.mark.parametrize(
    ("place", "code", "says"),
    [((4.0, 1.0), 206, "4.00, 1.00"), ((40.0, 1.0), 204, "outside"), ((4.0, 1.0), 206, "")],
)
def test_a_goal_that_cannot_be_reached_has_nav2s_code(serve, make_client, distro, place, code, says):
    serve(distro)
    goal = make_client(distro).go(*place)
    result = goal.wait()
    assert (goal.status, result.error_code) == ("aborted", code)
    assert says in result.error_msg


def test_a_distribution_without_error_codes_still_gets_the_result(serve, client):
    serve(definitions=client.learn({"nav2_msgs/action/NavigateToPose_Result": "std_msgs/Empty result\n"}))
    goal = client.go(4.0, 1.0)
    goal.wait()
    assert goal.status == "aborted"


def test_a_second_goal_aborts_the_first_and_is_reached(serve, client):
    serve()
    first = client.go(6.5, 1.5)
    first.wait_for_feedback(20)
    second = client.go(1.5, 4.0)
    result = first.wait()
    assert (first.status, result.error_msg) == ("aborted", "another goal has come")
    assert second.wait().error_code == 0
    assert second.status == "succeeded"


def test_a_second_goal_in_a_wall_ends_the_first_and_the_robot_stands(serve, client):
    served = serve()
    first = client.go(6.5, 1.5)
    first.wait_for_feedback(20)
    second = client.go(4.0, 1.0)
    assert second.wait().error_code == 206
    assert first.wait() is not None
    assert (first.status, second.status) == ("aborted", "aborted")
    wait_for(lambda: served.goals == ())


def test_a_cancelled_goal_is_canceled_and_the_robot_stands(serve, client):
    served = serve()
    goal = client.go(6.5, 1.5)
    goal.wait_for_feedback(20)
    goal.cancel()
    goal.wait()
    assert goal.status == "canceled"
    wait_for(lambda: served.goals == ())
    again = client.go(1.5, 4.5)
    again.wait()
    assert again.status == "succeeded"


def test_a_goal_is_aborted_where_another_source_replaces_or_cancels_it(serve, client):
    served = serve()
    goal = client.go(6.5, 1.5)
    goal.wait_for_feedback(5)
    served.put(SetGoal((1.5, 4.5)))
    assert goal.wait().error_msg == "there is another goal"
    again = client.go(6.5, 1.5)
    again.wait_for_feedback(5)
    served.put(Cancel())
    again.wait()
    assert (goal.status, again.status) == ("aborted", "aborted")


def test_a_goal_is_aborted_when_the_bridge_ends(serve, client):
    served = serve()
    goal = client.go(6.5, 1.5)
    goal.wait_for_feedback(5)
    served.close()
    assert goal.status == "aborted"
    assert "the run has ended" in goal.wait().error_msg or "the bridge has ended" in goal.wait().error_msg


@pytest.mark.parametrize(
    ("pose", "code", "kind"),
    [
        ({"frame": "moon"}, 202, None),
        ({"x": math.nan}, 200, "navigate_to_pose: not finite"),
    ],
)
def test_a_bad_pose_is_refused_with_a_code(serve, client, pose, code, kind):
    served = serve()
    message = client.pose(pose.get("x", 1.5), 4.5, frame=pose.get("frame", "map"))
    goal = client.send("/navigate_to_pose", "NavigateToPose", pose=message)
    result = goal.wait()
    assert (goal.status, result.error_code) == ("aborted", code)
    assert list(served.counts) == ([] if kind is None else [kind])


def test_a_quaternion_of_length_zero_is_refused(serve, client):
    served = serve()
    message = client.pose(1.5, 4.5)
    message.pose.orientation.w = 0.0
    goal = client.send("/navigate_to_pose", "NavigateToPose", pose=message)
    assert "length 0" in goal.wait().error_msg
    assert list(served.counts) == ["navigate_to_pose: no rotation"]


def test_a_goal_in_the_frame_of_the_robot_is_driven_to(serve, client):
    serve()
    goal = client.go(0.8, 0.0, frame="base_link")
    goal.wait()
    assert goal.status == "succeeded"
    at = goal.feedback[-1].current_pose.pose.position
    assert math.hypot(at.x - 2.3, at.y - 1.5) < 0.3


@pytest.mark.parametrize(("distro", "code"), [("jazzy", 1), ("kilted", 9001)])
def test_a_behavior_tree_is_refused(serve, make_client, distro, code):
    serve(distro)
    client = make_client(distro)
    goal = client.send("/navigate_to_pose", "NavigateToPose", pose=client.pose(1.5, 4.5), behavior_tree="mine.xml")
    result = goal.wait()
    assert (goal.status, result.error_code) == ("aborted", code)
    assert "trundle has no behavior trees" in result.error_msg


def goals_of(client, distro, poses):
    return client.types.make("nav_msgs/msg/Goals", goals=poses) if distro == "kilted" else poses


@pytest.mark.parametrize("distro", ["jazzy", "kilted"])
def test_poses_are_driven_through(serve, make_client, distro):
    serve(distro)
    client = make_client(distro)
    poses = [client.pose(1.5, 3.5), client.pose(3.0, 4.5), client.pose(6.0, 4.5)]
    goal = client.send("/navigate_through_poses", "NavigateThroughPoses", poses=goals_of(client, distro, poses))
    goal.wait()
    assert goal.status == "succeeded"
    left = [one.number_of_poses_remaining for one in goal.feedback]
    assert sorted(set(left), reverse=True) == [3, 2, 1]
    assert left == sorted(left, reverse=True)


def test_no_poses_to_drive_through_are_refused(serve, client):
    serve()
    goal = client.send("/navigate_through_poses", "NavigateThroughPoses", poses=[])
    assert goal.wait().error_code == 309
    too_many = client.send("/navigate_through_poses", "NavigateThroughPoses", poses=[client.pose(1.5, 4.5)] * 1001)
    assert too_many.wait().error_code == 300
