"""A controller in plain rclpy drives the robot through the warehouse, as it does in process."""

from __future__ import annotations

import math
from functools import cache
from types import ModuleType

import numpy as np
import pytest

from ros2.proof.conftest import CLIENTS, Bench
from support.modules import load
from trundle.geometry import Goal, Twist2D
from trundle.mission import Scenario, Session
from trundle.navigation import NavigationStatus
from trundle.observation import Estimate, Observation

START = (13.0, 0.0, 3.14)
GOAL = (4.4, -3.2)
"""Of the odom frame, which begins where the robot starts."""

ROBOT = "turtlebot3_waffle"
LIMIT_S = 120.0


class InProcess:
    """The controller as an agent: what it gets from the network, from the observation."""

    status = NavigationStatus.DRIVING
    controller_name = "controller"

    def __init__(self, controller: ModuleType, robot: object, dt: float) -> None:
        self.robot, self.dt = robot, dt
        self._controller, self._command, self._begin = controller, Twist2D(), None
        self.distance = math.inf

    def reset(self, *, seed: int = 0) -> None:
        self._begin = None

    def set_goal(self, goal: Goal, /) -> None:
        raise AssertionError("it has its own")

    def update(self, observation: Observation, estimate: Estimate, /) -> Twist2D:
        if self._begin is None:
            self._begin = observation.odometry
        pose = self._begin.inverse() @ observation.odometry
        for scan in observation.scans:
            away = GOAL[0] - pose.x, GOAL[1] - pose.y
            self.distance = math.hypot(*away)
            turn = float(np.median(np.diff(scan.angles)))
            to_goal = math.atan2(away[1], away[0]) - pose.yaw
            found = self._controller.steer(scan.ranges.tolist(), float(scan.angles[0]), turn, to_goal, self.distance)
            self._command = Twist2D(*found)
        return self._command


@cache
def drive_in_process() -> tuple[float, float, tuple[str, ...]]:
    """Distance driven and left [m], and what was touched, with the controller in this process."""
    controller = load(CLIENTS / "controller.py")
    scenario = Scenario.make(world="warehouse", robot=ROBOT, backend="kinematic", lidar=True, start=START)
    with scenario.build() as mission:
        agent = InProcess(controller, mission.robot, 0.05)
        session = Session(
            mission.sim, agent, mission.start, None, monitor=False, time_limit_s=LIMIT_S, stop_on_contact=False
        )
        with session:
            while agent.distance >= controller.NEAR and session.step() is not None:
                pass
            episode = session.finish()
    return episode.metrics.distance_m, agent.distance, tuple(episode.metrics.contacts)


def test_a_controller_over_the_network_has_the_outcome_that_it_has_in_process(bench: Bench) -> None:
    driven, left, touched = drive_in_process()
    assert (left < 0.2, touched) == (True, ())
    start = ",".join(map(str, START))
    server = bench.serve("warehouse", "--profile", "turtlebot3", f"--start={start}", "--speed", 3)
    lines = bench.client("controller.py", *GOAL)
    reached = lines.until(lambda line: line["reached"], LIMIT_S)
    ended = server.end()
    assert reached["distance"] < 0.2
    assert ended["contacts"] == []
    assert ended["distance_m"] == pytest.approx(driven, rel=0.1)
