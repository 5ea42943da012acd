"""Robots: their drive, limits, footprint, casters and sensors, from YAML; the built-in ones are in `catalogue/`."""

from trundle.robots.drive import Axle, DifferentialDrive, DriveWheel, Limits, WheelSpeeds
from trundle.robots.parts import Body, Caster, CasterFrame, Lidar
from trundle.robots.robot import Robot, is_robot_file, robot_names

__all__ = [
    "Axle",
    "Body",
    "Caster",
    "CasterFrame",
    "DifferentialDrive",
    "DriveWheel",
    "Lidar",
    "Limits",
    "Robot",
    "WheelSpeeds",
    "is_robot_file",
    "robot_names",
]
