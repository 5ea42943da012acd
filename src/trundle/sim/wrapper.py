"""`SimulatorWrapper`: a simulator that changes what another one is told or reports."""

from __future__ import annotations

from collections.abc import Callable

from trundle.geometry import Pose2D, Twist2D
from trundle.geometry.solids import Solid
from trundle.robots import Robot
from trundle.sim.simulator import Simulator, SomeSimulator, as_simulator
from trundle.sim.state import RobotState, Substep
from trundle.worlds import World


class SimulatorWrapper(Simulator):
    """Passes everything on to another simulator; derived classes change some of it.

    Args:
        sim: Moves the robot.
    """

    def __init__(self, sim: SomeSimulator) -> None:
        self._sim = as_simulator(sim)

    @property
    def inner(self) -> Simulator:
        """The other simulator."""
        return self._sim

    @property
    def robot(self) -> Robot:
        """The simulated robot."""
        return self._sim.robot

    @property
    def world(self) -> World | None:
        """The world that it moves through; see `Simulator.world`."""
        return self._sim.world

    @property
    def timestep(self) -> float | None:
        """Length of a physics step [s]; see `Simulator.timestep`."""
        return self._sim.timestep

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame); see `Simulator.reset`."""
        return self._sim.reset(pose, seed=seed)

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period; see `Simulator.step`."""
        return self._sim.step(command, dt)

    def watch_substeps(self, watch: Callable[[Substep], None] | None) -> bool:
        """Let the simulator report every physics step; see `Simulator.watch_substeps`."""
        return self._sim.watch_substeps(watch)

    def add_solid(self, solid: Solid) -> None:
        """Put a solid into the simulator's world; see `Simulator.add_solid`."""
        self._sim.add_solid(solid)

    def place(self, pose: Pose2D) -> RobotState:
        """Put the simulator's robot somewhere else; see `Simulator.place`."""
        return self._sim.place(pose)

    def close(self) -> None:
        """Close the simulator."""
        self._sim.close()
