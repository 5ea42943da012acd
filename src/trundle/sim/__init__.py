"""Simulators, which move the robot by commanded twists."""

from trundle.sim.simulator import Contact, RobotState, Scan, Simulator, simulate, simulator_names, world_of

__all__ = ["Contact", "RobotState", "Scan", "Simulator", "simulate", "simulator_names", "world_of"]
