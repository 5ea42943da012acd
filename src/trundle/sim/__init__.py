"""Simulators, which move the robot by commanded twists."""

from trundle.sim.simulator import (
    Contact,
    MoverState,
    RobotState,
    Simulator,
    Substep,
    add_solid,
    place_robot,
    simulate,
    simulator_names,
    world_of,
)

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
