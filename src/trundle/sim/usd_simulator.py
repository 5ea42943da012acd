"""What the simulators of USD stages share: Isaac Sim's and PhysX'."""

from __future__ import annotations

from trundle.errors import InputError, SimulationError
from trundle.robots import Robot
from trundle.sim.simulator import Simulator
from trundle.worlds import World

SETTLE_S = 0.5
"""Time in which a robot comes to rest that was put above the floor [s]."""

_LARGEST_FALL = 0.1
"""Largest drop while settling [m]; a robot that falls farther has no floor under it."""


class UsdSimulator(Simulator):
    """A simulator whose world and robot are a USD stage, into which the robot is put above the floor.

    Args:
        robot: The robot.
        physics_dt: Length of a physics step [s].
        ground_offset: Initial height [m] of the robot above z = 0, from which it settles.

    Raises:
        InputError: If an option is out of range.
    """

    def __init__(self, robot: Robot, *, physics_dt: float, ground_offset: float) -> None:
        if not 0.0 < physics_dt <= 0.02:
            raise InputError(f"physics_dt {physics_dt} s is out of range; use more than 0 and at most 0.02")
        if not 0.0 <= ground_offset <= 10.0:
            raise InputError(f"ground_offset {ground_offset} m is out of range; use 0 to 10")
        self._robot = robot
        self._world: World | None = None
        self._physics_dt = physics_dt
        self._ground_offset = ground_offset

    @property
    def robot(self) -> Robot:
        """The simulated robot."""
        return self._robot

    @property
    def world(self) -> World | None:
        """The world, with what was added since the reset; None in an environment whose solids are unknown."""
        return self._world

    @property
    def timestep(self) -> float:
        """Length of a physics step [s]."""
        return self._physics_dt

    def _check_stands(self, height: float, duration: float) -> None:
        """Check that the robot stands on something.

        Args:
            height: Height above z = 0 [m] after it has settled.
            duration: How long it settled [s].

        Raises:
            SimulationError: If it fell.
        """
        if -height > _LARGEST_FALL:
            raise SimulationError(
                f"the robot fell {self._ground_offset - height:.2f} m in {duration} s: there is no collider under it. "
                f"Start it above the floor (--ground-offset, now {self._ground_offset:g} m), and check that its floor "
                "has a collider"
            )
