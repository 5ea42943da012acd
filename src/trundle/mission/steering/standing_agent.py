"""`StandingAgent`: stands, and checks what is driven by hand against the world."""

from __future__ import annotations

import numpy as np

from trundle.control.collision import FOOTPRINT_PADDING_M, stopping_poses
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.navigation import Agent, AgentInfo, NavigationStatus
from trundle.navigation.agent import CONTROL_PERIOD_S
from trundle.navigation.command_check import AssistedCommand, assist_teleop
from trundle.observation import Estimate, Observation
from trundle.sim import Simulator
from trundle.sim.footprint import FootprintChecker
from trundle.worlds import World

_TURN_STEP_RAD = np.radians(2.0)


class StandingAgent(Agent):
    """An agent that stands, for a robot that is driven by hand without a map.

    A command by hand passes if the robot can stop before it touches a solid of the simulated world; where it touches
    one already, every command passes, so that it can leave. It needs no map, and knows what a robot's sensors may not
    see. Moving obstacles are left to the collision monitor.

    Args:
        sim: The simulator, whose world is known to it or not; without a world every command passes.
        period_s: Length of a control period [s].

    Attributes:
        status: IDLE.
        dt: Length of a control period [s].
        robot: The robot.
    """

    def __init__(self, sim: Simulator, *, period_s: float = CONTROL_PERIOD_S) -> None:
        self._sim = sim
        self._world: World | None = None
        self._checker: FootprintChecker | None = None
        self.robot = sim.robot
        self.dt = period_s
        self.status = NavigationStatus.IDLE

    def info(self) -> AgentInfo:
        """Say which robot stands."""
        return AgentInfo(type(self).__name__, robot=self.robot)

    def reset(self, *, seed: int = 0) -> None:
        """Do nothing: it keeps nothing of a run."""

    def set_goal(self, goal: Goal, /) -> None:
        """Do nothing: it drives nowhere."""

    def update(self, observation: Observation, estimate: Estimate) -> Twist2D:
        """Return the command to stand."""
        return Twist2D()

    def assist_teleop(self, command: Twist2D, observation: Observation, estimate: Estimate) -> AssistedCommand:
        """What of a command by hand may be sent in the next control period."""
        checker = self._check_world()
        if checker is None or checker.find(np.array([estimate.pose.as_tuple()])):
            return AssistedCommand(command)
        return assist_teleop(
            command,
            command,
            lambda slower: self._can_stop(checker, estimate.pose, observation.twist, slower),
            "a solid of the world",
        )

    def _check_world(self) -> FootprintChecker | None:
        """What checks the world as it is now; None where the simulator does not know it."""
        world = self._sim.world
        if world is not self._world:
            body, padded = self.robot.body, self.robot.planar.padded(FOOTPRINT_PADDING_M)
            self._world = world
            self._checker = (
                None if world is None else FootprintChecker.of(world.solids, padded, body.clearance, body.height)
            )
        return self._checker

    def _can_stop(self, checker: FootprintChecker, pose: Pose2D, twist: Twist2D, command: Twist2D) -> bool:
        poses = stopping_poses(pose, twist, command, self.robot.limits, self.dt, turn_step=_TURN_STEP_RAD)
        return not checker.find(poses[1:])
