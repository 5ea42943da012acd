"""Which of the commands from the network drives the robot."""

import math

import pytest

from trundle.geometry import Twist2D
from trundle.ros2.simulator_role.role import CommandArbiter

FORWARD, LEFT, STAND = Twist2D(0.5, 0.0), Twist2D(0.0, 0.5), Twist2D()


@pytest.fixture
def said() -> list[str]:
    return []


@pytest.fixture
def arbiter(said: list[str]) -> CommandArbiter:
    return CommandArbiter(lambda kind, text: said.append(kind), lambda source: f"publisher {source}")


def test_without_a_command_the_robot_stands(arbiter: CommandArbiter) -> None:
    assert arbiter.command(0.0) == STAND


def test_a_command_holds_for_half_a_second_of_simulated_time(arbiter: CommandArbiter, said: list[str]) -> None:
    arbiter.offer(FORWARD, "a", 1.0)
    assert arbiter.command(1.0) == FORWARD
    assert arbiter.command(1.49) == FORWARD
    assert said == []
    assert arbiter.command(1.5) == STAND
    assert said == ["cmd_vel: timeout"]


def test_a_command_may_hold_until_the_next_one(said: list[str]) -> None:
    arbiter = CommandArbiter(lambda kind, text: said.append(kind), lambda source: source, holds_s=math.inf)
    arbiter.offer(FORWARD, "a", 1.0)
    assert arbiter.command(100.0) == FORWARD
    assert arbiter.offer(LEFT, "b", 100.0)  # the first one has been silent
    assert arbiter.command(99.0) == STAND  # the clock went back
    assert said == []


def test_standing_by_command_does_not_time_out(arbiter: CommandArbiter, said: list[str]) -> None:
    arbiter.offer(STAND, "a", 1.0)
    assert arbiter.command(5.0) == STAND
    assert said == []


def test_who_drives_keeps_the_robot_from_a_second_source(arbiter: CommandArbiter, said: list[str]) -> None:
    assert arbiter.offer(FORWARD, "a", 1.0)
    assert not arbiter.offer(LEFT, "b", 1.1)
    assert arbiter.command(1.1) == FORWARD
    assert said == ["cmd_vel: two sources"]


def test_a_second_source_takes_over_once_the_first_stands_or_is_silent(
    arbiter: CommandArbiter, said: list[str]
) -> None:
    arbiter.offer(FORWARD, "a", 1.0)
    arbiter.offer(STAND, "a", 1.1)
    assert arbiter.offer(LEFT, "b", 1.2)
    assert arbiter.offer(FORWARD, "a", 1.8)
    assert said == []


def test_a_command_of_before_the_clock_went_back_does_not_hold(arbiter: CommandArbiter) -> None:
    arbiter.offer(FORWARD, "a", 100.0)
    assert arbiter.command(0.0) == STAND


def test_clearing_says_whether_the_robot_was_driven(arbiter: CommandArbiter) -> None:
    assert not arbiter.clear()
    arbiter.offer(FORWARD, "a", 0.0)
    assert arbiter.clear()
    assert arbiter.command(0.0) == STAND
