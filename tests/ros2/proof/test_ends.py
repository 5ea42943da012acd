"""Either side ends or is killed: the robot stands, it is reported, no process remains; both find each other again."""

from __future__ import annotations

import json
import os
import signal
import time
from collections.abc import Callable
from typing import Any

import pytest

from ros2.lines import QUICK_S, Lines
from ros2.proof.conftest import PAIRS, Bench, Server, asked
from support.processes import are_gone, started_by

GONE_S = 60.0
"""Longer than processes take to go on a loaded machine."""

SIGNALS = (signal.SIGTERM, signal.SIGKILL)
JAZZY_RCLPY, KILTED_DDS = PAIRS[0].values[0], PAIRS[1].values[0]

DRIVE = ["/cmd_vel", "geometry_msgs/msg/Twist", {"linear": {"x": 0.3}}]


def listen(bench: Bench, server: Server, *topics: str) -> Lines:
    """Start a listener to some of the server's topics."""
    return bench.client("listener.py", asked(one for one in server.offer["publishes"] if one["topic"] in topics))


def moves(line: dict[str, Any]) -> bool:
    return line.get("topic") == "/odom" and line["value"]["twist"]["twist"]["linear"]["x"] > 0.1


def stands(line: dict[str, Any]) -> bool:
    return line.get("topic") == "/odom" and line["value"]["twist"]["twist"]["linear"]["x"] == 0.0


def each_end(usual: dict[Any, list[int]]) -> pytest.MarkDecorator:
    """Each pair of distribution and transport with each signal; every run has the usual ones."""
    cases = [
        pytest.param(
            (pair := case.values[0]),
            how,
            id=f"{case.id}-{how.name}",
            marks=() if how in usual.get(pair, ()) else pytest.mark.ros2,
        )
        for case in PAIRS
        for how in SIGNALS
    ]
    return pytest.mark.parametrize(("bench", "how"), cases, indirect=["bench"])


def is_time(second: Callable[[int], bool]) -> Callable[[dict[str, Any]], bool]:
    return lambda line: line.get("topic") == "/clock" and second(line["value"]["clock"]["sec"])


@each_end(usual={JAZZY_RCLPY: [signal.SIGTERM], KILTED_DDS: [signal.SIGKILL]})
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


@each_end(usual={JAZZY_RCLPY: [signal.SIGTERM, signal.SIGKILL], KILTED_DDS: [signal.SIGKILL]})
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


@pytest.mark.parametrize("bench", [pair for pair in PAIRS if pair.values[0][1] == "rclpy"], indirect=True)
def test_the_robot_stands_when_the_ros_side_of_the_bridge_is_killed(bench: Bench) -> None:
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
    children, begin = started_by(server.pid), time.monotonic()
    server.end()
    assert time.monotonic() - begin < QUICK_S
    assert are_gone(children, GONE_S)
