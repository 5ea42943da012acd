"""Checks of a machine, of a robot's drive against its configuration, and of what its lidars and odometry miss."""

from trundle.doctor.drive_check import DriveCheck, DriveFinding, check_drive
from trundle.doctor.lidar_view import LidarView, view_of_lidars
from trundle.doctor.machine import MachineCheck, check_machine
from trundle.doctor.odometry_need import OdometryNeed, needed_odometry

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
