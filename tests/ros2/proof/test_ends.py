"""Either side ends or is killed: the robot stands, it is reported, no process remains; both find each other again."""

from __future__ import annotations

import json
import os
import signal
import time
from collections.abc import Callable
from typing import Any

import pytest

from ros2.proof.conftest import QUICK_S, Bench, Lines, Server, asked
from support.processes import are_gone, started_by

GONE_S = 10.0
"""Longer than processes take to go on a loaded machine."""

DRIVE = ["/cmd_vel", "geometry_msgs/msg/Twist", {"linear": {"x": 0.3}}]


def listen(bench: Bench, server: Server, *topics: str) -> Lines:
    """Start a listener to some of the server's topics."""
    return bench.client("listener.py", asked(one for one in server.offer["publishes"] if one["topic"] in topics))


def moves(line: dict[str, Any]) -> bool:
    return line.get("topic") == "/odom" and line["value"]["twist"]["twist"]["linear"]["x"] > 0.1


def stands(line: dict[str, Any]) -> bool:
    return line.get("topic") == "/odom" and line["value"]["twist"]["twist"]["linear"]["x"] == 0.0


def is_time(second: Callable[[int], bool]) -> Callable[[dict[str, Any]], bool]:
    return lambda line: line.get("topic") == "/clock" and second(line["value"]["clock"]["sec"])


@pytest.mark.parametrize(
    "how", [pytest.param(signal.SIGTERM, marks=pytest.mark.ros2), signal.SIGKILL], ids=["SIGTERM", "SIGKILL"]
)
def test_a_robot_whose_driver_goes_stands_and_another_driver_finds_it(bench: Bench, how: int) -> None:
    server = bench.serve("lot")
    hears = listen(bench, server, "/odom")
    driver = bench.client("talker.py", json.dumps([DRIVE]))
    hears.until(moves)
    driver.process.send_signal(how)
    hears.until(stands)
    server.lines.wait_for_error("the robot stops")
    bench.client("talker.py", json.dumps([DRIVE]))
    hears.until(moves)
    server.end()


@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGKILL], ids=["SIGTERM", "SIGKILL"])
def test_a_server_that_goes_leaves_no_process_and_the_next_one_is_heard(bench: Bench, how: int) -> None:
    server = bench.serve("lot")
    hears = listen(bench, server, "/clock", "/tf_static")
    hears.until(is_time(lambda second: second >= 2))
    children = started_by(server.pid)
    server.process.send_signal(how)
    assert server.process.wait(GONE_S) == (0 if how == signal.SIGTERM else -how)
    assert are_gone(children, GONE_S)
    if how == signal.SIGTERM:
        assert server.lines.next()["message"]
    bench.serve("lot")
    hears.until(lambda line: line.get("topic") == "/tf_static")
    hears.until(is_time(lambda second: second >= 0))


def test_the_robot_stands_when_the_ros_side_of_the_bridge_is_killed(bench: Bench) -> None:
    if bench.transport != "rclpy":
        pytest.skip("there is no ROS side over dds")
    server = bench.serve("lot")
    hears = listen(bench, server, "/odom")
    driver = bench.client("talker.py", json.dumps([DRIVE]))
    hears.until(moves)
    (child,) = started_by(server.pid)
    os.kill(child, signal.SIGKILL)
    server.lines.wait_for_error("the other side is lost")
    server.lines.wait_for_error("the robot stops")
    hears.until(moves, within_s=2 * QUICK_S)
    driver.process.kill()
    begin = time.monotonic()
    server.end()
    assert time.monotonic() - begin < QUICK_S
    assert are_gone(started_by(server.pid), GONE_S)
