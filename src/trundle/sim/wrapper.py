"""`SimulatorWrapper`: a simulator that changes what another one is told or reports."""

from __future__ import annotations

from typing import Self

from trundle.geometry import Pose2D, Twist2D
from trundle.robots import Robot
from trundle.sim.simulator import Simulator, world_of
from trundle.sim.state import RobotState
from trundle.worlds import World


class SimulatorWrapper:
    """Passes everything on to another simulator; derived classes change some of it.

    Args:
        sim: Moves the robot.
    """

    def __init__(self, sim: Simulator) -> None:
        self._sim = sim

    @property
    def robot(self) -> Robot:
        """The simulated robot."""
        return self._sim.robot

    @property
    def world(self) -> World | None:
        """The world that it moves through; none where the simulator does not say."""
        return world_of(self._sim)

    @property
    def inner(self) -> Simulator:
        """The other simulator."""
        return self._sim

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame); see `Simulator.reset`."""
        return self._sim.reset(pose, seed=seed)

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period; see `Simulator.step`."""
        return self._sim.step(command, dt)

    def close(self) -> None:
        """Close the simulator."""
        self._sim.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
