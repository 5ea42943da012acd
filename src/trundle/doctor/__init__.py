"""Checks of a machine, of a robot's drive configuration against its actual motion, and of what its lidars miss."""

from trundle.doctor.drive_check import DriveCheck, DriveFinding, check_drive
from trundle.doctor.lidar_view import LidarView, view_of_lidars
from trundle.doctor.machine import MachineCheck, check_machine

__all__ = [
    "DriveCheck",
    "DriveFinding",
    "LidarView",
    "MachineCheck",
    "check_drive",
    "check_machine",
    "view_of_lidars",
]
