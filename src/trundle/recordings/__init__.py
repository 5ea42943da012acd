"""Recorded drives as observations: what a robot saw and how it moved, from bags of ROS and from CARMEN logs."""

from trundle.recordings.drive import DriveStep, RecordedDrive, Remarks
from trundle.recordings.opening import open_drive

__all__ = ["DriveStep", "RecordedDrive", "Remarks", "open_drive"]
