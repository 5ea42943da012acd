"""A robot that is somewhere else is driven to its goal, whatever it is like."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import pytest

from ros2.fake_transport import FakePublisher
from ros2.navigator_role.conftest import wait_for
from ros2.remote.conftest import STAND, START, Remote
from trundle.geometry import Pose2D
from trundle.mission import Pause, SetGoal

Navigate = Callable[..., Remote]
GOAL = (2.7, 2.2)


def check_arrival(remote: Remote) -> None:
    """It has truly arrived, and touched nothing."""
    remote.wait_for_end()
    drive = remote.bridge.drive
    assert drive is not None
    assert drive.arrived, drive.message
    assert remote.robot.pose.distance_to(Pose2D(*GOAL)) < 0.3
    assert not remote.robot.contacts


@pytest.mark.parametrize("localizer", ["odometry", "amcl", "tf"])
def test_a_robot_is_driven_to_its_goal(navigate: Navigate, localizer: str) -> None:
    by_tf = localizer == "tf"
    remote = navigate(
        localizer=localizer, start=None if by_tf else START, habits={"map_odom": START if by_tf else None}
    )
    check_arrival(remote)
    assert remote.robot.commands[-1][1] == STAND


@pytest.mark.parametrize(
    ("habits", "remark"),
    [
        ({"stamps": False}, "odometry: stamp of 0"),
        ({"ahead_s": 0.18}, "odometry: stamp ahead of /clock"),
        ({"clock_every": 5}, "/clock: slow"),
        ({"speed_share": 0.5}, ""),
        ({"odometry": False}, ""),
        ({"tf": False, "static": False, "frame": "somewhere"}, ""),
        ({"clock": False, "stamps": False}, "odometry: stamp of 0"),
        ({"waits_for_pose": True, "when_commanded": True, "tf": False}, ""),
    ],
    ids=[
        "stamps of 0",
        "stamps ahead",
        "slow clock",
        "half speed",
        "only tf",
        "no tf",
        "wall time",
        "waits for its pose",
    ],
)
@pytest.mark.slow
def test_quirks_of_robots_are_taken_as_they_are(navigate: Navigate, habits: dict[str, object], remark: str) -> None:
    remote = navigate(habits=habits)
    check_arrival(remote)
    assert not remark or remark in remote.kinds


@pytest.mark.slow
def test_a_robot_that_locates_itself_is_told_where_it_starts(navigate: Navigate) -> None:
    habits = {"waits_for_pose": True, "when_commanded": True, "map_odom": START, "speed_share": 0.5}
    remote = navigate(localizer="tf", habits=habits)
    check_arrival(remote)
    (told,) = remote.robot.told
    assert told.pose.pose.position.x == pytest.approx(START.x)


@pytest.mark.slow
def test_a_robot_is_told_where_it_starts_once_it_can_hear_it(navigate: Navigate, monkeypatch: Any) -> None:
    matched, opens = FakePublisher.matched.fget, time.monotonic() + 3.0  # pyright: ignore[reportAttributeAccessIssue]

    def late(publisher: FakePublisher) -> int:
        return 0 if publisher.topic == "/initialpose" and time.monotonic() < opens else matched(publisher)

    monkeypatch.setattr(FakePublisher, "matched", property(late))
    written = FakePublisher.write

    def write(publisher: FakePublisher, data: bytes) -> None:
        if publisher.topic != "/initialpose" or publisher.matched:
            written(publisher, data)

    monkeypatch.setattr(FakePublisher, "write", write)
    remote = navigate(habits={"waits_for_pose": True})
    check_arrival(remote)
    assert len(remote.robot.told) == 1


def test_what_came_before_the_clock_is_not_taken_for_newer(navigate: Navigate) -> None:
    remote = navigate(habits={"clock": False, "stamps": False})
    wait_for(lambda: remote.bridge.inputs.odometry is not None)
    remote.habits.stamps = remote.habits.clock = True
    check_arrival(remote)


def test_nothing_is_commanded_before_the_robot_is_located(navigate: Navigate) -> None:
    remote = navigate(start=None, localizer="amcl")
    wait_for(lambda: remote.bridge.localizer.waits_for_pose and remote.bridge.inputs.odometry is not None)
    wait_for(lambda: "not located" in remote.reasons)
    wait_for(lambda: all(one.count > 10 for one in remote.bridge.inputs.scan_streams.values()))
    assert not remote.robot.commands
    make = remote.robot.make
    remote.robot.send("/initialpose", make.pose_estimate(0.0, START, None))
    check_arrival(remote)


@pytest.mark.slow
def test_a_paused_robot_stands_and_goes_on(navigate: Navigate) -> None:
    remote = navigate()
    remote.wait_until_moving()
    remote.put(Pause(True))
    assert remote.wait_until_standing() < 0.6
    remote.put(Pause(False))
    check_arrival(remote)


def test_a_goal_that_cannot_be_reached_ends_the_drive(navigate: Navigate) -> None:
    remote = navigate(goal=(2.3, 5.5))
    remote.wait_for_end()
    drive = remote.bridge.drive
    assert drive is not None
    assert not drive.arrived
    assert drive.message
    assert all(command == STAND for _, command in remote.robot.commands)


def test_it_waits_for_goals_without_one(navigate: Navigate) -> None:
    remote = navigate(goal=None)
    wait_for(lambda: not remote.reasons and remote.bridge.localizer.is_located)
    remote.put(SetGoal((2.8, 2.0)))
    wait_for(lambda: remote.robot.pose.distance_to(Pose2D(2.8, 2.0)) < 0.3)
