"""Robots: their drive, limits, footprint, casters and sensors, from YAML; the built-in ones are in `catalogue/`."""

from trundle.robots.parts import (
    Axle,
    Body,
    Caster,
    CasterFrame,
    DifferentialDrive,
    DriveWheel,
    Lidar,
    Limits,
    WheelSpeeds,
)
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
