"""SmoothPath."""

from __future__ import annotations

import numpy as np
import pytest

NAME, ACTION = "/smooth_path", "SmoothPath"


def length(path):
    points = np.array([(one.pose.position.x, one.pose.position.y) for one in path.poses])
    return float(np.hypot(*np.diff(points, axis=0).T).sum()), points


def smooth(client, points, **options):
    types = client.types
    header = types.make("std_msgs/msg/Header", frame_id="map")
    path = types.make("nav_msgs/msg/Path", header=header, poses=[client.pose(x, y) for x, y in points])
    return client.send(NAME, ACTION, path=path, **options)


CORNER = [(1.5, 1.5), (2.5, 1.5), (2.5, 3.0)]


def test_a_corner_is_rounded_and_the_ends_stay(serve, client):
    serve()
    goal = smooth(client, CORNER, check_for_collisions=True)
    result = goal.wait()
    assert goal.status == "succeeded"
    assert result.was_completed
    shorter, points = length(result.path)
    assert shorter < 2.5
    assert points[0] == pytest.approx((1.5, 1.5), abs=0.01)
    assert points[-1] == pytest.approx((2.5, 3.0), abs=0.01)
    assert result.path.header.frame_id == "map"


def test_nav2s_name_and_trundles_name_are_taken(serve, client):
    serve()
    for name in ("simple_smoother", "constrained"):
        goal = smooth(client, CORNER, smoother_id=name)
        goal.wait()
        assert goal.status == "succeeded"


def test_an_unknown_smoother_has_its_code(serve, client):
    serve()
    result = smooth(client, CORNER, smoother_id="magic").wait()
    assert result.error_code == 501
    assert "magic" in result.error_msg


def test_a_path_through_an_obstacle_fails(serve, client):
    serve()
    goal = smooth(client, [(1.5, 1.5), (4.0, 1.5), (6.0, 1.5)])
    result = goal.wait()
    assert goal.status == "aborted"
    assert result.error_code in (503, 504)


def test_a_path_without_poses_is_refused(serve, client):
    serve()
    result = smooth(client, []).wait()
    assert result.error_code == 505
    assert "2 to" in result.error_msg
