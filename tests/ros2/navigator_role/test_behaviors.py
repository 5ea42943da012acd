"""Spin, BackUp, DriveOnHeading and Wait."""

import math

import pytest


def move(client, name, action, x, speed=0.2, seconds=20.0, y=0.0):
    target = client.types.make("geometry_msgs/msg/Point", x=x, y=y)
    return client.send(name, action, target=target, speed=speed, time_allowance=client.seconds(seconds))


def spin(client, angle, seconds=20.0):
    return client.send("/spin", "Spin", target_yaw=angle, time_allowance=client.seconds(seconds))


def place_of(client, goal):
    goal.wait()
    assert goal.status == "succeeded"
    return goal.feedback[-1]


def test_the_robot_turns_and_says_how_far(serve, client):
    serve()
    goal = spin(client, -1.57)
    assert place_of(client, goal).angular_distance_traveled == pytest.approx(1.57, abs=0.15)
    took = goal.wait().total_elapsed_time
    assert 1.0 < took.sec + took.nanosec * 1e-9 < 10.0
    assert len(goal.feedback) <= 10 * (took.sec + 1) + 2


@pytest.mark.parametrize(
    ("name", "action", "x", "speed"),
    [
        ("/backup", "BackUp", 0.4, 0.2),
        ("/backup", "BackUp", -0.4, -0.2),
        ("/drive_on_heading", "DriveOnHeading", 0.4, 0.2),
        ("/drive_on_heading", "DriveOnHeading", -0.4, -0.2),
    ],
)
def test_the_robot_drives_straight(serve, client, name, action, x, speed):
    serve()
    goal = move(client, name, action, x, speed)
    assert place_of(client, goal).distance_traveled == pytest.approx(0.4, abs=0.05)


def test_the_robot_waits(serve, client):
    serve()
    goal = client.send("/wait", "Wait", time=client.seconds(2.0))
    left = [one.time_left.sec + one.time_left.nanosec * 1e-9 for one in (goal.wait(), goal.feedback)[1]]
    assert left == sorted(left, reverse=True)
    assert goal.status == "succeeded"
    assert goal.wait().total_elapsed_time.sec == 2


@pytest.mark.parametrize(
    ("distance", "seconds", "code"),
    [(5.0, 20.0, 714), (0.5, 1.0, 711)],
)
def test_what_ends_a_behavior_early_has_nav2s_code(serve, client, distance, seconds, code):
    serve()
    goal = move(client, "/backup", "BackUp", distance, seconds=seconds)
    result = goal.wait()
    assert (goal.status, result.error_code) == ("aborted", code)
    assert result.error_msg


def test_driving_into_a_wall_is_a_collision_ahead(serve, client):
    serve()
    assert move(client, "/drive_on_heading", "DriveOnHeading", 5.0, seconds=60.0).wait().error_code == 723


@pytest.mark.parametrize(
    ("name", "action", "fields", "code"),
    [
        ("/backup", "BackUp", {"x": 0.4, "y": 0.1}, 713),
        ("/backup", "BackUp", {"x": math.nan}, 713),
        ("/backup", "BackUp", {"x": 0.4, "speed": 0.0}, 713),
        ("/drive_on_heading", "DriveOnHeading", {"x": 0.4, "speed": -0.1}, 724),
        ("/drive_on_heading", "DriveOnHeading", {"x": 0.4, "seconds": -3.0}, 724),
    ],
)
def test_bad_numbers_are_refused(serve, client, name, action, fields, code):
    served = serve()
    goal = move(client, name, action, **fields)
    assert goal.wait().error_code == code
    assert served.counts == {f"{name[1:]}: bad goal": 1}


def test_an_angle_that_is_no_number_is_refused(serve, client):
    serve()
    goal = spin(client, math.inf)
    assert goal.wait().error_code == 700
    assert goal.status == "aborted"


def test_a_behavior_runs_on_the_way_and_is_cancelled_alone(serve, client):
    serve()
    goal = client.go(1.5, 4.5)
    goal.wait_for_feedback(5)
    waits = client.send("/wait", "Wait", time=client.seconds(1000.0))
    waits.wait_for_feedback(3)
    turns = spin(client, 0.5)
    assert waits.wait() is not None
    turns.cancel()
    turns.wait()
    goal.wait()
    assert (waits.status, goal.status) == ("aborted", "succeeded")
    assert turns.status in ("canceled", "succeeded")
