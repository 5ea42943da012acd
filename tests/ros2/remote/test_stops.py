"""A robot that is somewhere else stands where something is wrong, within half a second, and the reason is counted."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import pytest

from ros2.fake_transport import FakeNetwork
from ros2.navigator_role.conftest import wait_for
from ros2.remote.conftest import STAND, START, Remote, jazzy
from ros2.remote.robot import LATCHED
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.messages import MessageMaker, Qos
from trundle.mission import SetGoal, SetPose

Navigate = Callable[..., Remote]
FAR = (8.0, 5.0)
pytestmark = pytest.mark.filterwarnings("ignore::trundle.errors.SensorWarning")


def check_stop(remote: Remote, kind: str) -> None:
    """It stops within half a second, for this reason, and goes on once that has gone."""
    assert remote.wait_until_standing() < 0.6
    wait_for(lambda: kind in remote.reasons, f"for {kind}: {remote.reasons}")
    assert remote.stops(kind) == 1
    assert any("the robot stands" in text for text in remote.said)


@pytest.mark.parametrize(
    ("habit", "value", "kind"),
    [
        ("scans", False, "scans of lidar silent"),
        ("clock", False, "/clock silent"),
        ("odometry", False, "odometry silent"),
    ],
)
def test_silence_stops_the_robot_until_it_is_over(navigate: Navigate, habit: str, value: object, kind: str) -> None:
    remote = navigate(goal=FAR, habits={"tf": False})
    remote.wait_until_moving()
    before = getattr(remote.habits, habit)
    setattr(remote.habits, habit, value)
    lidar = next(iter(remote.robot.robot.lidars))
    check_stop(remote, kind.replace("of lidar", f"of {lidar}"))
    setattr(remote.habits, habit, before)
    remote.wait_until_moving()


def test_a_robot_that_sent_odometry_without_being_asked_does_not_set_off_without(navigate: Navigate) -> None:
    remote = navigate(goal=None, habits={"tf": False})
    wait_for(lambda: remote.bridge.inputs.odometry_stream.count > 100)  # longer than that after a command
    remote.put(SetGoal(Goal.of(FAR)))
    remote.wait_until_moving()
    remote.habits.odometry = False
    remote.wait_until_standing()
    stood = time.monotonic()
    time.sleep(2.5)
    assert not [command for at, command in list(remote.robot.commands) if at > stood and command != STAND]
    assert "odometry silent" in remote.reasons


def test_a_silent_map_to_odom_stops_the_robot(navigate: Navigate) -> None:
    remote = navigate(goal=FAR, localizer="tf", start=None, habits={"map_odom": START})
    remote.wait_until_moving()
    remote.habits.map_odom = None
    check_stop(remote, "map → odom silent")
    remote.habits.map_odom = START
    remote.wait_until_moving()


@pytest.mark.parametrize("apart", [Pose2D(0.0, 0.0), Pose2D(0.1, 0.1)], ids=["told", "near"])
def test_a_second_map_to_odom_stops_the_robot(navigate: Navigate, apart: Pose2D) -> None:
    remote = navigate(goal=FAR)
    remote.wait_until_moving()
    remote.habits.map_odom = START @ apart
    check_stop(remote, "two localizers")


def test_odometry_that_jumps_stops_the_robot_until_it_is_told_where_it_is(navigate: Navigate) -> None:
    remote = navigate(goal=FAR)
    remote.wait_until_moving()
    remote.habits.odometry_shift = Pose2D(3.0, 1.0, 0.5)
    check_stop(remote, "odometry jumped")
    wait_for(lambda: "not located" in remote.reasons)
    remote.put(SetPose(remote.robot.pose))
    remote.wait_until_moving()


@pytest.mark.parametrize("is_static", [False, True])
@pytest.mark.parametrize("jump", ["odometry", "clock"])
def test_after_a_jump_map_to_odom_has_to_change_before_it_is_taken_again(
    navigate: Navigate, jump: str, is_static: bool
) -> None:
    remote = navigate(goal=FAR, localizer="tf", start=None, habits={"map_odom": None if is_static else START})
    send, make = remote.robot.send, remote.robot.make
    if is_static:
        send("/tf_static", make.transforms([make.transform(0.0, "map", "odom", START)]), LATCHED)
    remote.wait_until_moving()
    jumped = Pose2D(3.0, 1.0, 0.5)
    if jump == "odometry":
        remote.habits.odometry_shift = jumped
    else:
        remote.robot.time = 5.0
    check_stop(remote, f"{jump} jumped")
    wait_for(lambda: set(remote.reasons) == {"not located"}, f"for the hold to end: {remote.reasons}")
    assert "map → odom is what it was before" in remote.bridge.guard.reasons["not located"]
    assert not remote.bridge.localizer.is_located
    stood = len(remote.robot.commands)
    time.sleep(1.0)
    assert all(command == STAND for _, command in remote.robot.commands[stood:])
    remote.habits.map_odom = START @ jumped.inverse() if jump == "odometry" else Pose2D(START.x + 0.05, START.y)
    remote.wait_until_moving()
    assert not remote.robot.contacts


def test_odometry_and_map_to_odom_that_jump_together_stop_the_robot_for_a_moment(navigate: Navigate) -> None:
    """The twist of tf's odometry is not that of the jump, of which the navigator would warn."""
    remote = navigate(goal=FAR, localizer="tf", start=None, habits={"map_odom": START, "odometry": False})
    remote.wait_until_moving()
    jumped = Pose2D(3.0, 1.0, 0.5)
    remote.habits.tf_shift, remote.habits.map_odom = jumped, START @ jumped.inverse()
    check_stop(remote, "odometry jumped")
    remote.wait_until_moving()


def test_odometry_that_disagrees_with_tf_stops_the_robot(navigate: Navigate) -> None:
    remote = navigate(goal=FAR)
    remote.wait_until_moving()
    remote.habits.tf_shift = Pose2D(0.8, 0.0)
    check_stop(remote, "odometry disagrees")


def test_a_clock_of_1000_hz_is_no_flood(navigate: Navigate, network: FakeNetwork) -> None:
    remote = navigate(goal=FAR)
    remote.wait_until_moving()
    codec = jazzy()
    make = MessageMaker(codec)
    clock = network.transport("gazebo").publisher("/clock", "rosgraph_msgs/msg/Clock", Qos())
    looks, until = [], time.monotonic() + 1.5
    while time.monotonic() < until:
        clock.write(codec.encode(make.clock(remote.robot.time)))
        time.sleep(0.0005)
        looks.append("/clock silent" in remote.reasons)
    assert "/clock: flood" not in remote.kinds
    assert sum(looks) < 0.2 * len(looks)  # none, but where the machine did not run this process for a while


def test_a_clock_that_goes_back_stops_the_robot_until_it_is_told_where_it_is(navigate: Navigate) -> None:
    remote = navigate(goal=FAR)
    remote.wait_until_moving()
    before = remote.bridge.context.driver.status.time
    remote.robot.time = 5.0
    check_stop(remote, "clock jumped")
    wait_for(lambda: "not located" in remote.reasons)
    remote.put(SetPose(remote.robot.pose))
    remote.wait_until_moving()
    assert remote.bridge.context.driver.status.time > before


def test_two_command_sources_stop_the_robot(navigate: Navigate, network: FakeNetwork) -> None:
    remote = navigate(goal=FAR)
    remote.wait_until_moving()
    codec = jazzy()
    make = MessageMaker(codec)
    other = network.transport("teleop").publisher("/cmd_vel", "geometry_msgs/msg/Twist", Qos())
    for _ in range(10):
        other.write(codec.encode(make.twist(Twist2D(0.1, 0.05))))
        time.sleep(0.05)
    wait_for(lambda: "two sources" in remote.bridge.guard.counts)
    assert any("commands the robot on /cmd_vel, too" in text for text in remote.said)
    wait_for(lambda: remote.bridge.commands.sent != STAND)  # it goes on once the other is silent


def test_a_lost_connection_cancels_the_drive(navigate: Navigate, network: FakeNetwork) -> None:
    remote = navigate(goal=FAR)
    remote.wait_until_moving()
    transport: Any = remote.bridge.wire.transport
    transport.lost = "the child has died"
    transport.wake()
    remote.wait_for_end()
    drive = remote.bridge.drive
    assert drive is not None
    assert not drive.arrived
    assert remote.robot.commands[-1][1] == STAND


def test_ctrl_c_stops_the_robot(navigate: Navigate) -> None:
    remote = navigate(goal=FAR)
    remote.wait_until_moving()
    session = remote.bridge.context.session
    assert session is not None
    remote.bridge.inputs.take_scans = _interrupt  # type: ignore[method-assign]
    assert remote.wait_until_standing() < 0.6
    remote.wait_for_end()


def _interrupt() -> Any:
    raise KeyboardInterrupt


def test_a_navigator_that_takes_too_long_stops_the_robot(navigate: Navigate) -> None:
    remote = navigate(goal=FAR)
    remote.wait_until_moving()
    take = remote.bridge.inputs.take_scans

    def slow() -> Any:
        remote.bridge.inputs.take_scans = take  # type: ignore[method-assign]
        time.sleep(1.5)
        return take()

    remote.bridge.inputs.take_scans = slow  # type: ignore[method-assign]
    assert remote.wait_until_standing() < 0.7
    assert "stands: late command" in remote.kinds
    remote.wait_until_moving()


def test_a_drive_is_given_up_where_the_robot_may_never_drive(navigate: Navigate) -> None:
    remote = navigate(goal=FAR, habits={"scans": False})
    drive = remote.bridge.drive
    assert drive is not None
    drive.waits_s = 1.0
    remote.wait_for_end()
    assert not drive.arrived
    assert "nothing has come yet" in drive.message
    assert not [command for _, command in remote.robot.commands if command != STAND]


@pytest.mark.parametrize(
    ("edit", "kind"),
    [
        (lambda scan: setattr(scan, "angle_increment", -scan.angle_increment), "reversed angles"),
        (lambda scan: setattr(scan, "angle_min", float("nan")), "not finite"),
    ],
)
def test_scans_that_are_none_let_the_robot_stand(navigate: Navigate, edit: Callable[[Any], None], kind: str) -> None:
    remote = navigate(goal=FAR)
    remote.wait_until_moving()
    remote.habits.edit_scan = edit
    assert remote.wait_until_standing() < 0.6
    assert any(kind in one for one in remote.kinds)
