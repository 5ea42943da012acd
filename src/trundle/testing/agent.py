"""The check that every agent must pass."""

from __future__ import annotations

import math
from typing import cast

import numpy as np

from trundle.control.latency import Latency
from trundle.errors import InputError
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation import Agent, AgentInfo, AgentReport, AssistedCommand, NavigationStatus
from trundle.navigation.agents import AgentLike, create_agent
from trundle.navigation.state import FINAL
from trundle.observation import Estimate, Observation, Scan
from trundle.path import Path
from trundle.robots import Robot
from trundle.testing.conformance import ConformanceError, accept, expect

_SECONDS = 60.0
_START = Pose2D(0.0, 0.0)
_GOAL = Goal(2.0, 1.0)


def check_agent(agent: AgentLike, *, robot: Robot | None = None) -> None:
    """Check that an agent meets the contract of `trundle.navigation.Agent`.

    It drives in an open space around (0, 0) towards (2, 1). It returns twists, ends with a status that says so,
    or is still busy after a minute, and stands still from then on. A reset makes it as new: the same seed and
    observations give the same commands. Two agents share no state. It does not modify the scans that it gets, takes
    observations with and without them, and takes a second one at the same time after a new goal. Where it says that it
    has arrived, its estimate is at the goal. What it says of itself by `info` and `report`, and what it makes of being
    told the latency, a changed command and a command by hand, is of the kinds that `Agent` names; where it takes
    several goals at once it counts them, and where it plans it returns a path to its goal or None.

    Args:
        agent: An agent in any of the ways of `AgentLike`, or a function that makes one for a robot. A class gets an
            empty map of 10 m around (0, 0) as `map`.
        robot: The robot to drive; Nova Carter by default.

    Raises:
        ConformanceError: If a requirement is not met.
    """
    driven = Robot.load("nova_carter") if robot is None else robot
    grid = OccupancyGrid(np.zeros((200, 200), np.int8), 0.05, Pose2D(-5.0, -5.0))

    def make(robot: Robot) -> Agent:
        return accept(lambda given: create_agent(cast("AgentLike", given), robot, grid), agent)

    one = make(driven)
    first = _drive(one, driven, scans=False)
    again = _drive(make(driven), driven, scans=False)
    expect(first == again, f"two agents must command the same from the same observations; found: {(first, again)}")
    after_reset = _drive(one, driven, scans=False)
    expect(first == after_reset, f"an agent must drive as new after a reset; found: {(first, after_reset)}")
    one, other = make(driven), make(driven)
    one.reset(seed=0)
    _drive(other, driven, scans=False)
    expect(_drive(one, driven, scans=False) == first, "two agents must not share state; found: one changed the other")
    _drive(make(driven), driven, scans=True)
    _check_second_goal(make(driven))
    _check_optional(make(driven))


def _drive(agent: Agent, robot: Robot, *, scans: bool) -> list[Twist2D]:
    """Drive with ideal motion within the robot's limits until the agent is done; return its commands."""
    agent.reset(seed=7)
    agent.set_goal(_GOAL)
    pose, twist, time, commands = _START, Twist2D(), 0.0, list[Twist2D]()
    while time < _SECONDS and agent.status not in FINAL:
        observation = Observation(time, twist, pose, _look_around(robot, time) if scans else ())
        seen = [scan.ranges.copy() for scan in observation.scans]
        commands.append(_command(agent, observation, Estimate(time, pose)))
        unchanged = all(np.array_equal(scan.ranges, old) for scan, old in zip(observation.scans, seen, strict=True))
        expect(unchanged, "an agent must not modify the scans that it gets; found: other ranges")
        dt = float(agent.dt)
        expect(0.0 < dt < math.inf, f"the control period dt of an agent must be a positive number; found: {dt}")
        twist = robot.limits.approach(twist, commands[-1], dt)
        pose, time = twist.integrate(pose, dt), time + dt
    if agent.status is NavigationStatus.ARRIVED:
        near = pose.distance_to(_GOAL.pose)
        expect(near <= 0.5, f"an agent that says it arrived must be at the goal {_GOAL}; found: {pose}")
    if agent.status in FINAL:
        standing = _command(agent, Observation(time, twist, pose), Estimate(time, pose))
        expect(standing == Twist2D(), f"an agent that is done must command zero; found: {standing}")
    return commands


def _check_second_goal(agent: Agent) -> None:
    """Set another goal between two updates of one time, as a session with several goals does."""
    agent.reset(seed=7)
    agent.set_goal(_GOAL)
    observation, estimate = Observation(0.0, Twist2D(), _START), Estimate(0.0, _START)
    _command(agent, observation, estimate)
    agent.set_goal(Goal(1.0, -1.0))
    _command(agent, observation, estimate)


def _check_optional(agent: Agent) -> None:
    """Check the members that have a default, for an agent that overrides them."""
    info = agent.info()
    expect(isinstance(info, AgentInfo), f"an agent's info() must return an AgentInfo; found: {info!r}")
    expect(isinstance(info.controller, str), f"an agent's controller is named by a text; found: {info.controller!r}")
    agent.reset(seed=7)
    agent.set_latency(Latency(scan_age_s=0.1, command_delay_s=0.1))
    try:
        agent.set_goals((_GOAL, Goal(1.0, -1.0)))
    except InputError:  # it takes one goal at a time
        agent.set_goal(_GOAL)
    path = agent.plan(_START)
    if path is not None:
        expect(agent.plans, "an agent that plans must say so by its attribute plans")
        near = path.goal.distance_to(_GOAL.pose)
        expect(near <= 0.5, f"an agent's plan must lead to its goal {_GOAL}; found a path to {path.goal}")
    observation, estimate = Observation(0.0, Twist2D(), _START), Estimate(0.0, _START)
    _command(agent, observation, estimate)
    agent.set_sent_command(Twist2D())
    for rollouts in (False, True):
        report = agent.report(rollouts=rollouts)
        expect(isinstance(report, AgentReport), f"an agent's report() must return an AgentReport; found: {report!r}")
        expect(report.status is agent.status, f"an agent must report its status {agent.status}; found: {report.status}")
        expect(report.goals_reached >= 0, f"an agent counts goals from 0; found: {report.goals_reached}")
    expect(report.path is None or isinstance(report.path, Path), f"an agent's path is a Path; found: {report.path!r}")
    assisted = agent.assist_teleop(Twist2D(0.1, 0.0), observation, estimate)
    expect(isinstance(assisted, AssistedCommand), f"assist_teleop must return an AssistedCommand; found: {assisted!r}")


def _command(agent: Agent, observation: Observation, estimate: Estimate) -> Twist2D:
    try:
        command = agent.update(observation, estimate)
    except InputError as error:
        raise ConformanceError(str(error)) from error
    expect(isinstance(command, Twist2D), f"an agent must command a Twist2D; found: {command!r}")
    expect(
        isinstance(agent.status, NavigationStatus), f"an agent's status is a NavigationStatus; found: {agent.status!r}"
    )
    return command


def _look_around(robot: Robot, time: float) -> tuple[Scan, ...]:
    """Return a scan of an empty space by each of the robot's lidars."""
    return tuple(
        Scan(
            name,
            time,
            Pose2D(lidar.x, lidar.y, lidar.yaw),
            lidar.z,
            np.linspace(-lidar.fov / 2.0, lidar.fov / 2.0, lidar.beams, endpoint=False),
            np.full(lidar.beams, np.inf),
            lidar.range_min,
            lidar.range_max,
        )
        for name, lidar in robot.lidars.items()
    )
