"""FollowWaypoints: one pose after another, with what is missed."""

from __future__ import annotations

from itertools import pairwise

import pytest

from ros2.navigator_role.conftest import wait_for

NAME, ACTION = "/follow_waypoints", "FollowWaypoints"


def follow(client, *poses, **options):
    return client.send(NAME, ACTION, poses=[client.pose(*pose) for pose in poses], **options)


def test_the_robot_stops_at_each_waypoint(serve, client):
    served = serve()
    goal = follow(client, (2.5, 1.5), (2.5, 3.0))
    result = goal.wait()
    assert goal.status == "succeeded"
    assert list(result.missed_waypoints) == []
    assert {one.current_waypoint for one in goal.feedback} == {0, 1}
    episode = served.end()
    assert episode.trajectory.poses[-1][1] == pytest.approx(3.0, abs=0.3)


@pytest.mark.parametrize("distro", ["jazzy", "kilted"])
def test_a_waypoint_in_an_obstacle_is_left_out_and_named(serve, make_client, distro):
    serve(distro)
    client = make_client(distro)
    goal = follow(client, (4.0, 1.0), (2.5, 1.5))
    result = goal.wait()
    assert goal.status == "succeeded"
    (missed,) = result.missed_waypoints
    assert (missed.waypoint_index if distro == "kilted" else missed.index) == 0
    assert missed.error_code != 0
    assert "obstacle" in missed.error_msg or "touch" in missed.error_msg


def test_loops_and_the_first_index(serve, client):
    serve()
    goal = follow(client, (2.5, 1.5), (2.5, 3.0), number_of_loops=1, goal_index=1)
    goal.wait()
    assert goal.status == "succeeded"
    seen = [one.current_waypoint for one in goal.feedback]
    changes = [seen[0], *(after for before, after in pairwise(seen) if after != before)]
    assert changes == [1, 0, 1]


def test_cancelling_ends_it(serve, client):
    serve()
    goal = follow(client, (6.5, 1.5), (2.5, 3.0))
    wait_for(lambda: goal.feedback)
    goal.cancel()
    goal.wait()
    assert goal.status == "canceled"


def test_a_second_goal_replaces_the_first(serve, client):
    serve()
    first = follow(client, (6.5, 1.5))
    wait_for(lambda: first.feedback)
    second = client.go(2.5, 1.5)
    first.wait()
    second.wait()
    assert (first.status, second.status) == ("aborted", "succeeded")


def test_no_poses_and_foreign_frames_are_refused(serve, client):
    serve()
    nothing = follow(client)
    assert "1 to 1000 waypoints" in nothing.wait().error_msg
    foreign = client.send(NAME, ACTION, poses=[client.pose(2.0, 1.5, frame="moon")])
    assert "'moon'" in foreign.wait().error_msg
    assert (nothing.status, foreign.status) == ("aborted", "aborted")
