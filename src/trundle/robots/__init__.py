"""Robots: their drive, limits, footprint, casters and sensors, from YAML; the built-in ones are in `catalogue/`."""

from trundle.robots.drive import DifferentialDrive, WheelSpeeds
from trundle.robots.limits import Limits
from trundle.robots.robot import Body, Caster, Lidar, Robot, robot_names

__all__ = ["Body", "Caster", "DifferentialDrive", "Lidar", "Limits", "Robot", "WheelSpeeds", "robot_names"]
