"""Simulators, which move the robot by commanded twists."""

from typing import TYPE_CHECKING

from trundle.lazy import lazy_names
from trundle.sim.simulator import Simulator, add_solid, place_robot, simulate, simulator_names, world_of
from trundle.sim.state import Contact, MoverState, RobotState, Substep

if TYPE_CHECKING:
    from trundle.sim.batch import BatchSimulator, MoverRecording

__getattr__ = lazy_names(__name__, {"BatchSimulator": "trundle.sim.batch", "MoverRecording": "trundle.sim.batch"})

__all__ = [
    "BatchSimulator",
    "Contact",
    "MoverRecording",
    "MoverState",
    "RobotState",
    "Simulator",
    "Substep",
    "add_solid",
    "place_robot",
    "simulate",
    "simulator_names",
    "world_of",
]
