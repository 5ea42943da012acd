"""Simulators, which move the robot by commanded twists."""

from trundle.sim.simulator import Simulator, add_solid, place_robot, simulate, simulator_names, world_of
from trundle.sim.state import Contact, MoverState, RobotState, Substep

__all__ = [
    "Contact",
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
