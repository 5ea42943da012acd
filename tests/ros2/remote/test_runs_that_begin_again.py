"""What comes on topics while a run is about to begin again: the next one takes it, as Nav2 would."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from ros2.navigator_role.conftest import COVARIANT, QUICK_S, Client, wait_for
from ros2.remote.conftest import STAND, Remote
from ros2.remote.test_load_map import LOAD, changed_room
from trundle.geometry import Pose2D
from trundle.mission import Restart

Navigate = Callable[..., Remote]


@pytest.fixture
def client(network: Any) -> Client:
    return Client(network, "jazzy")


def hold(remote: Remote) -> threading.Event:
    """Let the run not begin again before this is set."""
    role: Any = remote.bridge._role
    may_begin, take = threading.Event(), role._take_map

    def take_later() -> Any:
        assert may_begin.wait(QUICK_S)
        return take()

    role._take_map = take_later
    return may_begin


def begin_to_load(
    navigate: Navigate, client: Client, folder: Path, goal: tuple[float, float] | None = None
) -> tuple[Remote, threading.Event, Any]:
    """A robot whose run is about to begin again, but not before the event is set, and the call that asks for it."""
    remote = navigate(goal=None, has_services=True)
    wait_for(lambda: not remote.reasons, "for the robot")
    if goal is not None:
        client.publish("/goal_pose", client.pose(*goal))
        remote.wait_until_moving()
    may_begin = hold(remote)
    request = client.types.make(f"{LOAD}_Request", map_url=changed_room(folder, "table"))
    call = client.network.call("/map_server/load_map", client.types.encode(request))
    wait_for(lambda: remote.bridge.context.driver.steering.is_restarting, "for the restart")
    return remote, may_begin, call


def publish(remote: Remote, client: Client, topic: str, *messages: Any) -> None:
    """Publish messages of one type, and wait until they are taken."""
    (inlet,) = [
        one for one in remote.bridge.wire.inlets if (one.topic, one.type_name) == (topic, messages[0].__msgtype__)
    ]
    before = inlet.received
    for message in messages:
        client.publish(topic, message)
    wait_for(lambda: inlet.received >= before + len(messages), f"for {topic} to be taken")


def place(client: Client, x: float, y: float) -> Any:
    told = client.types.make(COVARIANT)
    told.header.frame_id, told.pose.pose.position.x, told.pose.pose.position.y = "map", x, y
    return told


def test_the_newest_goal_that_comes_while_a_map_is_loaded_is_driven_to(
    navigate: Navigate, client: Client, tmp_path: Path
) -> None:
    remote, may_begin, call = begin_to_load(navigate, client, tmp_path)
    publish(remote, client, "/goal_pose", client.pose(6.0, 5.0), client.pose(2.8, 2.1))
    may_begin.set()
    wait_for(lambda: call.response, "for the answer")
    wait_for(lambda: remote.robot.pose.distance_to(Pose2D(2.8, 2.1)) < 0.3 and not remote.robot.twist.v, "for it")
    assert not any("refused" in text for text in remote.said), remote.said


@pytest.mark.filterwarnings("ignore:the estimate was corrected by 4")  # where the run has begun before it
def test_a_pose_that_comes_while_a_map_is_loaded_is_the_next_run_s(
    navigate: Navigate, client: Client, tmp_path: Path
) -> None:
    remote, may_begin, call = begin_to_load(navigate, client, tmp_path)
    publish(remote, client, "/initialpose", place(client, 6.0, 3.0))
    may_begin.set()
    wait_for(lambda: call.response, "for the answer")
    wait_for(lambda: (remote.bridge.localizer.shown or Pose2D(0.0, 0.0)).distance_to(Pose2D(6.0, 3.0)) < 0.05, "for it")
    assert not any("refused" in text for text in remote.said), remote.said


def test_a_goal_of_the_topic_goes_on_on_another_map(navigate: Navigate, client: Client, tmp_path: Path) -> None:
    remote, may_begin, call = begin_to_load(navigate, client, tmp_path, (4.0, 2.3))
    may_begin.set()
    wait_for(lambda: call.response, "for the answer")
    wait_for(lambda: remote.robot.pose.distance_to(Pose2D(4.0, 2.3)) < 0.3 and not remote.robot.twist.v, "for it")


def test_a_robot_that_drives_is_stopped_while_a_map_is_loaded(
    navigate: Navigate, client: Client, tmp_path: Path
) -> None:
    remote, may_begin, call = begin_to_load(navigate, client, tmp_path, (7.0, 2.3))
    assert remote.wait_until_standing() < 1.0
    assert remote.robot.commands[-1][1] == STAND
    assert not call.response
    may_begin.set()
    wait_for(lambda: call.response, "for the answer")


def lose(remote: Remote) -> None:
    """Lose the other side, and find it again."""
    transport: Any = remote.bridge.wire.transport
    said = len(remote.said)
    for lost, text in (("the child has died", "is lost: the child has died"), ("", "is back")):
        transport.lost = lost
        transport.wake()
        wait_for(lambda text=text: any(text in line for line in remote.said[said:]), text)


def pause(client: Client) -> None:
    """Let a lifecycle manager pause the navigator, and go on."""
    for command in (1, 2):
        manage = "nav2_msgs/srv/ManageLifecycleNodes"
        assert client.call("/lifecycle_manager_navigation/manage_nodes", manage, command=command).success


def check_that_it_stands(remote: Remote) -> None:
    """The next run drives nowhere, though nothing holds the robot."""
    driver = remote.bridge.context.driver
    wait_for(lambda: driver.steering.run == 2 and not remote.reasons, f"for the next run: {remote.reasons}")
    begun, sent = driver.status.time, len(remote.robot.commands)
    wait_for(lambda: driver.status.time > begun + 1.0, "for a second")
    assert all(command == STAND for _, command in remote.robot.commands[sent:])
    report = driver.status.steering
    assert report is not None
    assert not report.goals


@pytest.mark.parametrize("stop", ["lost", "paused"])
def test_a_stop_while_a_run_begins_again_ends_the_goal_that_waits_for_it(
    navigate: Navigate, client: Client, stop: str
) -> None:
    remote = navigate(goal=None, has_services=True)
    wait_for(lambda: not remote.reasons, "for the robot")
    may_begin = hold(remote)
    remote.put(Restart())
    role: Any = remote.bridge._role
    client.publish("/goal_pose", client.pose(6.0, 5.0))
    wait_for(lambda: role._poses._newest, "for the goal")
    lose(remote) if stop == "lost" else pause(client)
    may_begin.set()
    check_that_it_stands(remote)


@pytest.mark.parametrize("by", ["topic", "action", "command line"])
def test_a_loss_while_a_map_is_loaded_ends_the_drive_that_would_go_on(
    navigate: Navigate, client: Client, tmp_path: Path, by: str
) -> None:
    remote = navigate(goal=(7.0, 2.3) if by == "command line" else None, has_services=True)
    wait_for(lambda: not remote.reasons, "for the robot")
    if by == "topic":
        client.publish("/goal_pose", client.pose(7.0, 2.3))
    elif by == "action":
        client.send("/navigate_to_pose", "NavigateToPose", pose=client.pose(7.0, 2.3))
    remote.wait_until_moving()
    may_begin = hold(remote)
    request = client.types.make(f"{LOAD}_Request", map_url=changed_room(tmp_path, "table"))
    client.network.call("/map_server/load_map", client.types.encode(request))
    wait_for(lambda: remote.bridge.context.driver.steering.is_restarting, "for the restart")
    lose(remote)
    may_begin.set()
    if by == "command line":
        remote.wait_for_end()
        assert remote.bridge.drive is not None
        assert remote.bridge.drive.message == "the other side is lost: the child has died"
    else:
        check_that_it_stands(remote)


@pytest.mark.parametrize("localizer", ["odometry", "amcl", "tf"])
def test_a_run_that_begins_again_drives(navigate: Navigate, client: Client, localizer: str) -> None:
    habits = {"map_odom": Pose2D(2.0, 2.0)} if localizer == "tf" else {}
    remote = navigate(goal=None, localizer=localizer, habits=habits, has_services=True)
    driver = remote.bridge.context.driver
    wait_for(lambda: not remote.reasons and driver.status.time > 0.5, "for the robot")
    remote.put(Restart())
    wait_for(lambda: remote.bridge.context.driver.steering.run == 2, "for the next run")
    wait_for(lambda: not remote.reasons, f"for the robot again: {remote.said}")
    client.publish("/goal_pose", client.pose(2.8, 2.1))
    wait_for(lambda: remote.robot.pose.distance_to(Pose2D(2.8, 2.1)) < 0.3 and not remote.robot.twist.v, "for it")
    assert remote.episode is None
