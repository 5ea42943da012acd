"""Checks of a machine, and of a robot's drive configuration against its actual motion."""

from trundle.doctor.drive_check import DriveCheck, DriveFinding, check_drive
from trundle.doctor.machine import MachineCheck, check_machine

__all__ = ["DriveCheck", "DriveFinding", "MachineCheck", "check_drive", "check_machine"]
