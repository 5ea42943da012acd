"""Checks of a machine, of a robot's drive against its configuration, and of what its lidars and odometry miss."""

from trundle.doctor.drive_check import DriveCheck, DriveFinding, check_drive
from trundle.doctor.machine import MachineCheck, check_machine
from trundle.doctor.sensors import LidarView, OdometryNeed, needed_odometry, view_of_lidars

__all__ = [
    "DriveCheck",
    "DriveFinding",
    "LidarView",
    "MachineCheck",
    "OdometryNeed",
    "check_drive",
    "check_machine",
    "needed_odometry",
    "view_of_lidars",
]
