"""Plug-ins with types, as users of a type checker write them; tests/test_typing.py checks this text."""

import numpy as np
import numpy.typing as npt

import trundle
from trundle.control import Controller, create_controller
from trundle.costmap import Costmap
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.navigation import Agent, NavigationStatus
from trundle.observation import Estimate, Observation
from trundle.path import Path
from trundle.robots import Robot
from trundle.testing import check_agent, check_controller, check_localizer, check_planner


class MyPlanner:
    def __init__(self, robot: Robot, margin: float = 0.1) -> None:
        self.margin = margin

    def plan(self, costmap: Costmap, start: Pose2D, goal: Goal) -> npt.NDArray[np.float64]:
        return np.zeros((2, 2))


class MyController:
    def set_path(self, path: Path) -> None: ...

    def compute_velocity(self, pose: Pose2D, twist: Twist2D, costmap: Costmap, dt: float) -> Twist2D:
        return Twist2D()


class MyAgent:
    status = NavigationStatus.IDLE

    def reset(self, *, seed: int = 0) -> None: ...

    def set_goal(self, goal: Goal) -> None: ...

    def update(self, observation: Observation, estimate: Estimate) -> Twist2D:
        return Twist2D()


class MyLocalizer:
    def reset(self, pose: Pose2D) -> None: ...

    def update(self, observation: Observation) -> Pose2D:
        return observation.odometry


def drive(observation: Observation, estimate: Estimate, goal: Goal) -> Twist2D | None:
    return None


mine = trundle.Navigator(None, "jackal", planner=MyPlanner, controller=MyController())
mine = trundle.Navigator(None, "jackal", planner=MyPlanner(mine.robot), controller=MyController)
made: Controller = create_controller(MyController(), mine.robot)
check_planner(MyPlanner)
check_controller(MyController)
check_controller(MyController())
check_agent(MyAgent)
check_agent(drive)
check_localizer(MyLocalizer)
check_localizer(MyLocalizer())
trundle.Suite(worlds="warehouse", seeds="0:10", planners=["auto", MyPlanner], lidar=[True, False])
trundle.Suite(maps=["hall.yaml"], controllers=MyController, agents=[drive, {"name": "mine", "label": "ours"}])
observation, estimate = Observation(0.0, Twist2D(), Pose2D(0.0, 0.0)), Estimate(0.0, Pose2D(0.0, 0.0))
mine.update(observation, estimate)
mine.update(observation=observation, estimate=estimate)
mine.update(Pose2D(0.0, 0.0), Twist2D(), time=0.0, scans=())
mine.update(pose=(0.0, 0.0, 0.0))
agent: Agent = mine
agent.update(observation, estimate)
