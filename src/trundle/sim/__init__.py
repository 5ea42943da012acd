"""Simulators: what moves the robot when it is told a twist."""

from trundle.sim.simulator import Contact, RobotState, Scan, Simulator, simulate, simulator_names, world_of

__all__ = ["Contact", "RobotState", "Scan", "Simulator", "simulate", "simulator_names", "world_of"]
