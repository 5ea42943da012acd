"""AssistedTeleop."""

from __future__ import annotations

import time

from ros2.navigator_role.conftest import QUICK_S, wait_for

NAME, ACTION = "/assisted_teleop", "AssistedTeleop"


def start(client, seconds=0.0):
    return client.send(NAME, ACTION, time_allowance=client.seconds(seconds))


def twist(client, v, w=0.0):
    make = client.types.make
    linear, angular = make("geometry_msgs/msg/Vector3", x=v), make("geometry_msgs/msg/Vector3", z=w)
    return make("geometry_msgs/msg/Twist", linear=linear, angular=angular)


def drive(client, v, until):
    """Send commands as a keyboard does, until something is true."""
    end = time.monotonic() + QUICK_S
    publisher = client.transport.publisher("/cmd_vel_teleop", "geometry_msgs/msg/Twist", client.qos)
    while not until():
        assert time.monotonic() < end
        publisher.write(client.types.encode(twist(client, v)))
        time.sleep(0.02)


def pose_of(served):
    session = served.bridge.context.session
    return session.state.pose


def make(serve, client):
    from trundle.messages import Qos

    client.qos = Qos()
    served = serve(speed=5.0)
    wait_for(lambda: served.bridge.context.session is not None)
    return served


def test_commands_drive_and_cancelling_stops(serve, client):
    served = make(serve, client)
    goal = start(client)
    drive(client, 0.5, lambda: pose_of(served).x > 1.8)
    wait_for(lambda: goal.feedback)
    goal.cancel()
    goal.wait()
    assert goal.status == "canceled"
    x = wait_for(lambda: served.bridge.context.session.state.twist.v == 0.0 and pose_of(served).x)
    time.sleep(0.2)
    assert pose_of(served).x == x


def test_the_robot_stops_before_an_obstacle(serve, client):
    served = make(serve, client)
    start(client)
    drive(client, 0.5, lambda: pose_of(served).x > 2.3)
    begun = served.bridge.context.clock.now
    drive(client, 0.5, lambda: served.bridge.context.clock.now > begun + 6.0)
    assert pose_of(served).x < 3.6
    assert served.end().metrics.contacts == ()


def test_the_time_allowance_ends_it_as_nav2_does(serve, client):
    make(serve, client)
    goal = start(client, 0.5)
    result = goal.wait()
    assert goal.status == "aborted"
    assert result.error_code == 731
    assert "0.5 s is over" in result.error_msg


def test_preempt_teleop_ends_it_as_succeeded(serve, client):
    make(serve, client)
    goal = start(client)
    wait_for(lambda: goal.feedback)
    client.publish("/preempt_teleop", client.types.make("std_msgs/msg/Empty"))
    goal.wait()
    assert goal.status == "succeeded"


def test_a_drive_goes_on_after_it(serve, client):
    served = make(serve, client)
    drive_goal = client.go(2.5, 3.0)
    wait_for(lambda: drive_goal.feedback)
    goal = start(client, 0.5)
    goal.wait()
    drive_goal.wait()
    assert drive_goal.status == "succeeded"
    assert served.counts == {}


def test_commands_without_a_goal_are_not_obeyed(serve, client):
    served = make(serve, client)
    before = pose_of(served)
    drive(client, 0.5, lambda: "cmd_vel_teleop: no goal" in served.counts)
    assert pose_of(served) == before


def test_a_command_that_stops_coming_stops_the_robot(serve, client):
    served = make(serve, client)
    start(client)
    drive(client, 0.5, lambda: pose_of(served).x > 1.6)
    wait_for(lambda: served.bridge.context.session.state.twist.v == 0.0)
    assert pose_of(served).x < 2.4
