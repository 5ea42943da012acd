"""Simulators: what moves the robot when it is told a twist."""

from trundle.sim.simulator import Contact, RobotState, Scan, Simulator, simulate, simulator_names

__all__ = ["Contact", "RobotState", "Scan", "Simulator", "simulate", "simulator_names"]
